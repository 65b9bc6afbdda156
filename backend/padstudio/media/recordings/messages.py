"""What messages with pictures and camera calibrations say, whatever they are serialised as."""

from __future__ import annotations

import base64
import binascii
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal

from padstudio.media.recordings.storage import LAST_NS, Channel

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

PictureKind = Literal["raw", "compressed", "video"]

_PICTURES: dict[str, PictureKind] = {
    "sensor_msgs/msg/Image": "raw",
    "sensor_msgs/msg/CompressedImage": "compressed",
    "foxglove_msgs/msg/RawImage": "raw",
    "foxglove_msgs/msg/CompressedImage": "compressed",
    "foxglove_msgs/msg/CompressedVideo": "video",
    "foxglove.RawImage": "raw",
    "foxglove.CompressedImage": "compressed",
    "foxglove.CompressedVideo": "video",
}
_CALIBRATIONS = (
    "sensor_msgs/msg/CameraInfo",
    "foxglove_msgs/msg/CameraCalibration",
    "foxglove.CameraCalibration",
)
# https://docs.foxglove.dev/docs/sdk/schemas; those of ROS itself come with rosbags.
_FOXGLOVE = {
    "RawImage": "uint32 width\nuint32 height\nstring encoding\nuint32 step\nuint8[] data",
    "CompressedImage": "uint8[] data\nstring format",
    "CompressedVideo": "uint8[] data\nstring format",
    "CameraCalibration": "uint32 width\nuint32 height\nstring distortion_model\nfloat64[] D\n"
    "float64[9] K\nfloat64[9] R\nfloat64[12] P",
}
_STAMP = "builtin_interfaces/Time timestamp\nstring frame_id\n"


class MessageError(ValueError):
    """A message is not of its type."""


@dataclass(frozen=True, eq=False)
class RecordedPicture:
    """A message with a picture.

    Attributes
    ----------
    kind : {"raw", "compressed", "video"}
        ``video`` is one packet of a stream.
    stamp_ns : int
        Of its header, ns; 0 where it was not set.
    format : str
        Encoding of a raw picture, else as the message names it.
    data : bytes-like
    width, height, step : int
        Pixels, and bytes of a row; of raw pictures.
    is_big_endian : bool
    """

    kind: PictureKind
    stamp_ns: int
    format: str
    data: Any
    width: int = 0
    height: int = 0
    step: int = 0
    is_big_endian: bool = False


def type_of(channel: Channel) -> str:
    """A type's name as ROS 2 writes it: ``sensor_msgs/Image`` is ``sensor_msgs/msg/Image``."""
    package, slash, name = channel.type.partition("/")
    return f"{package}/msg/{name}" if slash and "/" not in name else channel.type


def picture_kind(channel: Channel) -> PictureKind | None:
    """What kind of pictures a topic has; None where it has none."""
    return _PICTURES.get(type_of(channel))


def is_calibration(channel: Channel) -> bool:
    """True of a topic that tells a camera's calibration."""
    return type_of(channel) in _CALIBRATIONS


def is_readable(channel: Channel) -> bool:
    """True where messages are serialised as something that is read."""
    return channel.encoding in _DECODERS


def read_picture(channel: Channel, data: bytes) -> RecordedPicture:
    """The picture of a message, not yet decoded.

    Raises
    ------
    MessageError
        If the message is not of its type.
    """
    kind = _PICTURES[type_of(channel)]
    message = read_message(channel, data)
    try:
        if not 0 <= stamp_ns(message) <= LAST_NS:
            raise MessageError(f"a message of {channel.topic} has a stamp beyond all time")
        # Raises where the bytes are none.
        memoryview(message.data)
        if kind == "raw":
            return RecordedPicture(
                kind,
                stamp_ns(message),
                str(message.encoding),
                message.data,
                int(message.width),
                int(message.height),
                int(message.step),
                bool(getattr(message, "is_bigendian", False)),
            )
        return RecordedPicture(kind, stamp_ns(message), str(message.format), message.data)
    except MessageError:
        raise
    except (AttributeError, TypeError, ValueError) as error:
        raise MessageError(f"a message of {channel.topic} lacks a field ({error})") from error


def read_message(channel: Channel, data: bytes) -> Any:
    """An object with a message's fields as attributes; raises as `read_picture`."""
    try:
        return _DECODERS[channel.encoding](channel, data)
    except MessageError:
        raise
    # Each of the decoders has errors of its own for bytes that are not what they should be.
    except Exception as error:
        raise MessageError(f"a message of {channel.topic} cannot be read ({error})") from error


def stamp_ns(message: Any) -> int:
    """The time in a message's header, ns; 0 where there is none."""
    header = getattr(message, "header", None)
    stamp = getattr(message, "timestamp", None) if header is None else header.stamp
    if stamp is None:
        return 0
    seconds = stamp.sec if hasattr(stamp, "sec") else stamp.seconds
    for name in ("nanosec", "nsec", "nanos"):
        if hasattr(stamp, name):
            return int(seconds) * 10**9 + int(getattr(stamp, name))
    return int(seconds) * 10**9


def _cdr(channel: Channel, data: bytes) -> Any:
    return _store(2).deserialize_cdr(data, type_of(channel))


def _ros1(channel: Channel, data: bytes) -> Any:
    return _store(1).deserialize_ros1(data, type_of(channel))


@lru_cache(maxsize=2)
def _store(ros: Literal[1, 2]) -> Typestore:
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
    for name, fields in _FOXGLOVE.items():
        store.register(get_types_from_msg(_STAMP + fields, f"foxglove_msgs/msg/{name}"))
    return store


def _json(channel: Channel, data: bytes) -> Any:
    message = json.loads(data, object_hook=lambda fields: SimpleNamespace(**fields))
    if isinstance(getattr(message, "data", None), str):
        try:
            message.data = base64.b64decode(message.data, validate=True)
        except binascii.Error as error:
            raise MessageError(f"a message of {channel.topic} is no base64") from error
    return message


def _protobuf(channel: Channel, data: bytes) -> Any:
    return _message_class(channel.schema, channel.type).FromString(data)


@lru_cache(maxsize=16)
def _message_class(schema: bytes, name: str) -> Any:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory, timestamp_pb2

    files = {each.name: each for each in descriptor_pb2.FileDescriptorSet.FromString(schema).file}
    stamp = descriptor_pb2.FileDescriptorProto()
    timestamp_pb2.DESCRIPTOR.CopyToProto(stamp)
    files.setdefault(stamp.name, stamp)
    pool = descriptor_pool.DescriptorPool()
    added: set[str] = set()

    def add(file: str) -> None:
        # A file's own come before it.
        if file in added or file not in files:
            return
        added.add(file)
        for needed in files[file].dependency:
            add(needed)
        pool.Add(files[file])

    for file in files:
        add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))


_DECODERS: dict[str, Callable[[Channel, bytes], Any]] = {
    "cdr": _cdr,
    "ros1": _ros1,
    "json": _json,
    "protobuf": _protobuf,
}
