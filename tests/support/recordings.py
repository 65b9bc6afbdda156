"""Makes small recordings of robots of every kind; a frame's number stands in its picture."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
import videos
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory, timestamp_pb2
from mcap.writer import CompressionType, IndexType, Writer
from numpy.typing import NDArray
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from padstudio.geometry.camera import Camera

Image = NDArray[np.uint8]
TOPIC, INFO = "/cam/image_raw", "/cam/camera_info"
#: Unix time of the first frame, ns; the recorder takes it later.
START_NS, LATE_NS, STEP_NS = 1_750_000_000_123_456_789, 7_000_000, 40_000_000
ROS1, ROS2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)
VIDEO = "foxglove_msgs/msg/CompressedVideo"
_VIDEO_FIELDS = "builtin_interfaces/Time timestamp\nstring frame_id\nuint8[] data\nstring format\n"
for _store in (ROS1, ROS2):
    _store.register(get_types_from_msg(_VIDEO_FIELDS, VIDEO))


@dataclass
class Shot:
    """A message: its stamp and when it was recorded, ns, and what it holds."""

    number: int
    stamp_ns: int
    log_ns: int


def shots(frames: int) -> list[Shot]:
    """Frames 25 a second, each recorded 7 ms late."""
    stamps = [START_NS + number * STEP_NS for number in range(frames)]
    return [Shot(number, stamp, stamp + LATE_NS) for number, stamp in enumerate(stamps)]


@dataclass
class Scene:
    """What a recording is to hold.

    Attributes
    ----------
    frames : list of Shot
    kind : {"raw", "compressed", "video"}
    encoding : str
        Of raw pictures.
    paint : callable
        From a number to a picture, BGR.
    camera : Camera or None
        Told on `INFO`.
    topics : sequence of str
        Each has all the pictures.
    """

    frames: list[Shot] = field(default_factory=lambda: shots(12))
    kind: str = "raw"
    encoding: str = "bgr8"
    paint: Callable[[int], Image] = videos.picture
    camera: Camera | None = None
    topics: Sequence[str] = (TOPIC,)


def encode(bgr: Image, encoding: str) -> Image:
    """Rows of a raw picture, (H, bytes) uint8, without padding."""
    if encoding == "mono8":
        return cv2.cvtColor(bgr, cv2.COLOR_BGR2GRAY)
    if encoding == "rgb16":
        wide = bgr[:, :, ::-1].astype("<u2") * 257
        return np.ascontiguousarray(wide).view(np.uint8).reshape(len(bgr), -1)
    codes = {"rgb8": cv2.COLOR_BGR2RGB, "rgba8": cv2.COLOR_BGR2RGBA, "bgra8": cv2.COLOR_BGR2BGRA}
    codes |= {"yuv422": cv2.COLOR_BGR2YUV_UYVY, "yuv422_yuy2": cv2.COLOR_BGR2YUV_YUY2}
    out = cv2.cvtColor(bgr, codes[encoding]) if encoding in codes else bgr
    return np.ascontiguousarray(out).reshape(len(bgr), -1)


def bayer(bgr: Image, order: str) -> Image:
    """A mosaic of a picture, (H, W) uint8, its upper left four pixels in this order."""
    out = np.empty(bgr.shape[:2], np.uint8)
    for place, colour in enumerate(order):
        rows, columns = slice(place // 2, None, 2), slice(place % 2, None, 2)
        out[rows, columns] = bgr[rows, columns, "bgr".index(colour)]
    return out


def packets(frames: int, keyframe_every: int = 5) -> list[bytes]:
    """H.264 packets of numbered pictures, one a frame, as `foxglove.CompressedVideo` wants them."""
    context = av.CodecContext.create("libx264", "w")
    context.width, context.height, context.pix_fmt = videos.WIDTH, videos.HEIGHT, "yuv420p"
    context.time_base = context.framerate = Fraction(1, 25)
    context.gop_size, context.max_b_frames = keyframe_every, 0
    context.options = {"preset": "ultrafast", "tune": "zerolatency", "crf": "18"}
    found = []
    for number in range(frames):
        frame = av.VideoFrame.from_ndarray(videos.picture(number), format="bgr24")
        frame.pts = number
        found += [bytes(packet) for packet in context.encode(frame)]
    found += [bytes(packet) for packet in context.encode(None)]
    assert len(found) == frames
    return found


def ros_messages(scene: Scene, store: Any, is_ros1: bool) -> list[tuple[int, str, str, Any]]:
    """Times of recording, topics, types and messages, in order."""
    types, out = store.types, []

    def header(shot: Shot) -> Any:
        stamp = types["builtin_interfaces/msg/Time"](*divmod(shot.stamp_ns, 10**9))
        first = (shot.number,) if is_ros1 else ()
        return types["std_msgs/msg/Header"](*first, stamp, "cam")

    streamed = packets(len(scene.frames)) if scene.kind == "video" else []
    for shot in scene.frames:
        if scene.camera is not None:
            name = "sensor_msgs/msg/CameraInfo"
            message = types[name](*camera_info(scene.camera, header(shot), types))
            out.append((shot.log_ns, INFO, name, message))
        bgr = scene.paint(shot.number)
        for topic in scene.topics:
            if scene.kind == "video":
                stamp = header(shot).stamp
                data = np.frombuffer(streamed[shot.number], np.uint8)
                name, fields = VIDEO, (stamp, "cam", data, "h264")
            elif scene.kind == "compressed":
                name = "sensor_msgs/msg/CompressedImage"
                png = cv2.imencode(".png", bgr)[1]
                fields = (header(shot), "bgr8; png compressed bgr8", png)
            else:
                name = "sensor_msgs/msg/Image"
                rows = encode(bgr, scene.encoding)
                height, width = bgr.shape[:2]
                fields = (header(shot), height, width, scene.encoding, 0, rows.shape[1])
                fields += (rows.ravel(),)
            out.append((shot.log_ns, topic, name, types[name](*fields)))
    return out


def camera_info(camera: Camera, header: Any, types: Any) -> tuple[Any, ...]:
    """Fields of a ``CameraInfo``."""
    matrix = camera.matrix
    d = np.r_[camera.distortion, np.zeros(5)][: max(5, len(camera.distortion))]
    projection = np.c_[matrix, np.zeros(3)].ravel()
    region = types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
    sides = (camera.height, camera.width)
    return (header, *sides, "plumb_bob", d, matrix.ravel(), np.eye(3).ravel(), projection) + (
        (0, 0, region)
    )


def write_bag1(path: Path, scene: Scene, compression: str = "none") -> Path:
    """A ROS 1 bag, chunks of two pictures or so."""
    writer = Writer1(path)
    if compression != "none":
        writer.set_compression(Writer1.CompressionFormat[compression.upper()])
    writer.chunk_threshold = 2 * videos.WIDTH * videos.HEIGHT * 3
    with writer:
        known: dict[str, Any] = {}
        for log_ns, topic, name, message in ros_messages(scene, ROS1, is_ros1=True):
            if topic not in known:
                known[topic] = writer.add_connection(topic, name, typestore=ROS1)
            writer.write(known[topic], log_ns, ROS1.serialize_ros1(message, name))
    return path


def write_bag2(folder: Path, scene: Scene, storage: str = "sqlite3") -> Path:
    """A ROS 2 bag's folder."""
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    with Writer2(folder, version=8, storage_plugin=plugin) as writer:
        known: dict[str, Any] = {}
        for log_ns, topic, name, message in ros_messages(scene, ROS2, is_ros1=False):
            if topic not in known:
                known[topic] = writer.add_connection(topic, name, typestore=ROS2)
            writer.write(known[topic], log_ns, ROS2.serialize_cdr(message, name))
    return folder


def write_mcap(path: Path, scene: Scene, encoding: str = "protobuf", **options: Any) -> Path:
    """An MCAP file with Foxglove's own messages, in chunks of two pictures or so.

    Parameters
    ----------
    encoding : {"protobuf", "json"}
    options
        Of `mcap.writer.Writer`.
    """
    options = {"chunk_size": 2 * videos.WIDTH * videos.HEIGHT * 3} | options
    name = {"raw": "RawImage", "compressed": "CompressedImage", "video": "CompressedVideo"}
    fields = _FIELDS[scene.kind]
    streamed = packets(len(scene.frames)) if scene.kind == "video" else []
    make, schema = _maker(f"foxglove.{name[scene.kind]}", fields, encoding)
    with path.open("wb") as file:
        writer = Writer(file, **options)
        writer.start(profile="", library="test")
        kind = "protobuf" if encoding == "protobuf" else "jsonschema"
        number = writer.register_schema(f"foxglove.{name[scene.kind]}", kind, schema)
        channels = [writer.register_channel(t, encoding, number) for t in scene.topics]
        for shot in scene.frames:
            bgr = scene.paint(shot.number)
            if scene.kind == "video":
                values = {"data": streamed[shot.number], "format": "h264"}
            elif scene.kind == "compressed":
                values = {"data": cv2.imencode(".png", bgr)[1].tobytes(), "format": "png"}
            else:
                rows = encode(bgr, scene.encoding)
                height, width = bgr.shape[:2]
                values = {"width": width, "height": height, "encoding": scene.encoding}
                values |= {"step": rows.shape[1], "data": rows.tobytes()}
            data = make(shot.stamp_ns, values)
            for channel in channels:
                writer.add_message(channel, shot.log_ns, data, shot.log_ns)
        writer.finish()
    return path


UNINDEXED: dict[str, Any] = {
    "index_types": IndexType.NONE,
    "use_statistics": False,
    "use_summary_offsets": False,
    "repeat_channels": False,
    "repeat_schemas": False,
}
PACKED = {"zstd": CompressionType.ZSTD, "lz4": CompressionType.LZ4, "none": CompressionType.NONE}
_BYTES, _TEXT, _NUMBER = 12, 9, 7
_FIELDS: dict[str, dict[str, int]] = {
    "raw": {
        "width": _NUMBER,
        "height": _NUMBER,
        "encoding": _TEXT,
        "step": _NUMBER,
        "data": _BYTES,
    },
    "compressed": {"data": _BYTES, "format": _TEXT},
    "video": {"data": _BYTES, "format": _TEXT},
}


def _maker(
    name: str, fields: dict[str, int], encoding: str
) -> tuple[Callable[[int, dict[str, Any]], bytes], bytes]:
    """What serialises a message of a stamp and values, and the schema of its type."""
    if encoding == "json":

        def to_json(stamp_ns: int, values: dict[str, Any]) -> bytes:
            stamp = {"sec": stamp_ns // 10**9, "nsec": stamp_ns % 10**9}
            told = values | {"data": base64.b64encode(values["data"]).decode()}
            return json.dumps({"timestamp": stamp, "frame_id": "cam", **told}).encode()

        return to_json, json.dumps({"title": name, "type": "object"}).encode()
    package, _, own = name.partition(".")
    file = descriptor_pb2.FileDescriptorProto(name=f"{own}.proto", package=package, syntax="proto3")
    file.dependency.append("google/protobuf/timestamp.proto")
    message = file.message_type.add(name=own)
    message.field.add(
        name="timestamp", number=1, type=11, label=1, type_name=".google.protobuf.Timestamp"
    )
    for number, (field_name, kind) in enumerate(fields.items(), 2):
        message.field.add(name=field_name, number=number, type=kind, label=1)
    stamp_file = descriptor_pb2.FileDescriptorProto()
    timestamp_pb2.DESCRIPTOR.CopyToProto(stamp_file)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(stamp_file)
    pool.Add(file)
    made = message_factory.GetMessageClass(pool.FindMessageTypeByName(name))

    def to_protobuf(stamp_ns: int, values: dict[str, Any]) -> bytes:
        out = made(**values)
        out.timestamp.seconds, out.timestamp.nanos = divmod(stamp_ns, 10**9)
        return bytes(out.SerializeToString())

    both = descriptor_pb2.FileDescriptorSet(file=[file, stamp_file])
    return to_protobuf, both.SerializeToString()
