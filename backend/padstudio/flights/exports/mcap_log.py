"""MCAP for Foxglove: calibration, pose, annotations and, where there are any, images.

References
----------
https://mcap.dev/spec and https://docs.foxglove.dev/docs/sdk/schemas
"""

from __future__ import annotations

import base64
import itertools
import json
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.flights.exports.byte_stream import ByteStream
from padstudio.flights.exports.frames.cameras import FrameCameras
from padstudio.flights.exports.frames.records import timed
from padstudio.flights.exports.mcap_schemas import SCHEMAS
from padstudio.flights.exports.options import (
    ExportOptions,
    Record,
    full_pose_of,
    pose_of,
    time_ns_of,
)
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.media import content

Message = dict[str, Any]

TOPICS = {
    "/camera/image": "foxglove.CompressedImage",
    "/camera/calibration": "foxglove.CameraCalibration",
    "/camera/pose": "foxglove.PoseInFrame",
    "/camera/bearing": "padstudio.RangeBearing",
    "/tf": "foxglove.FrameTransform",
    "/camera/annotations": "foxglove.ImageAnnotations",
}
_CONVENTION = {
    "pad": "origin at the pad's centre, X right and Y up the page, Z toward the camera; metres",
    "camera": "x right in the picture, y down, z forward; metres",
    "pose": "of the camera in the pad frame; only where a frame gave one of quality full",
    "bearing": "unit vector to the pad's centre in the camera frame; wherever a frame gave a pose",
}
# Foxglove's number of `PointsAnnotation.LINE_LIST`.
_LINE_LIST = 4
_GREEN = {"r": 0.2, "g": 0.9, "b": 0.3, "a": 1.0}
_AMBER = {"r": 1.0, "g": 0.7, "b": 0.1, "a": 1.0}
_RED = {"r": 0.95, "g": 0.25, "b": 0.2, "a": 1.0}
_CLEAR = {"r": 0.0, "g": 0.0, "b": 0.0, "a": 0.0}
_SHADE = {"r": 0.0, "g": 0.0, "b": 0.0, "a": 0.6}
# Each side of the outline is drawn in so many pieces, as lenses bend it.
_PIECES = 16


def write_mcap(records: Iterable[Record], options: ExportOptions) -> Iterator[bytes]:
    """An MCAP file with JSON messages in Foxglove's schemas.

    Raises
    ------
    SpecError
        If no camera is given.
    """
    return _write(records, options.need_cameras("an MCAP file"), options)


def _write(
    records: Iterable[Record], cameras: FrameCameras, options: ExportOptions
) -> Iterator[bytes]:
    from mcap.writer import Writer

    stream = ByteStream()
    writer = Writer(stream)  # type: ignore[arg-type]
    writer.start(profile="", library="padstudio")
    writer.add_metadata("padstudio.convention", _CONVENTION)
    channels = {
        topic: writer.register_channel(
            topic,
            "json",
            writer.register_schema(name, "jsonschema", json.dumps(SCHEMAS[name]).encode()),
        )
        for topic, name in TOPICS.items()
    }
    found = cameras.beside(timed(records), lambda item: item[0])
    for sequence, ((record, time_s), camera) in enumerate(found):
        time_ns = time_ns_of(record, time_s, options)
        for topic, message in _messages(record, time_ns, camera, options):
            data = json.dumps(message).encode()
            writer.add_message(channels[topic], time_ns, data, time_ns, sequence)
        yield stream.take()
    writer.finish()  # type: ignore[no-untyped-call]
    yield stream.take()


def _messages(
    record: Record, time_ns: int, camera: Camera, options: ExportOptions
) -> Iterator[tuple[str, Message]]:
    stamp = {"sec": time_ns // 10**9, "nsec": time_ns % 10**9}
    # Before the image, as a viewer shows it through the calibration that it has by then.
    yield "/camera/calibration", _calibration(camera, stamp)
    picture = options.picture(record) if options.picture else None
    if picture is not None:
        kind = content.identify(picture[: content.HEAD_BYTES]).media_type.partition("/")[2]
        data = base64.b64encode(picture).decode()
        yield (
            "/camera/image",
            {"timestamp": stamp, "frame_id": "camera", "data": data, "format": kind},
        )
    if record["status"] == "ok":
        yield "/camera/bearing", _range_bearing(record, stamp)
    pose = full_pose_of(record)
    if pose is not None:
        place, turn = _vector(pose.position_mm / 1000), _quaternion(pose)
        yield (
            "/tf",
            {
                "timestamp": stamp,
                "parent_frame_id": "pad",
                "child_frame_id": "camera",
                "translation": place,
                "rotation": turn,
            },
        )
        yield (
            "/camera/pose",
            {
                "timestamp": stamp,
                "frame_id": "pad",
                "pose": {"position": place, "orientation": turn},
            },
        )
    yield "/camera/annotations", _annotations(record, camera, options, stamp)


def _range_bearing(record: Record, stamp: Message) -> Message:
    sigma_mm, sigma_deg = record.get("range_sigma_mm"), record.get("bearing_sigma_deg")
    return {
        "timestamp": stamp,
        "frame_id": "camera",
        "range": record["range_mm"] / 1000,
        "bearing": dict(zip("xyz", record["bearing"], strict=True)),
        "quality": record.get("quality") or "unknown",
        **({} if sigma_mm is None else {"range_sigma": sigma_mm / 1000}),
        **({} if sigma_deg is None else {"bearing_sigma_deg": sigma_deg}),
    }


def _calibration(camera: Camera, stamp: Message) -> Message:
    k, matrix = camera.distortion, camera.matrix
    radial = "rational_polynomial" if len(k) > 5 else "plumb_bob"
    fewest = 4 if camera.model == "fisheye" else 5
    return {
        "timestamp": stamp,
        "frame_id": "camera",
        "width": camera.width,
        "height": camera.height,
        "distortion_model": "kannala_brandt" if camera.model == "fisheye" else radial,
        "D": [*k.tolist(), *[0.0] * max(0, fewest - len(k))],
        "K": matrix.ravel().tolist(),
        "R": np.eye(3).ravel().tolist(),
        "P": np.c_[matrix, np.zeros(3)].ravel().tolist(),
    }


def _annotations(record: Record, camera: Camera, options: ExportOptions, stamp: Message) -> Message:
    pose = pose_of(record)
    if pose is None:
        text, colour = f"failed at {record['stage']}: {record['reason']}", _RED
    elif record.get("quality") == "bearing":
        text = f"{record['layer']}, range {record['range_mm']:.0f} mm, bearing only"
        colour = _AMBER
    else:
        text, colour = f"{record['layer']}, height {pose.position_mm[2]:.0f} mm", _GREEN
    size = camera.height / 40
    label = {
        "timestamp": stamp,
        "position": {"x": size / 2, "y": 1.5 * size},
        "text": text,
        "font_size": size,
        "text_color": colour,
        "background_color": _SHADE,
    }
    lines = []
    if pose is not None and options.pad_size_mm is not None:
        ends = outline(pose, camera, options.pad_size_mm)
        line = {
            "timestamp": stamp,
            "type": _LINE_LIST,
            # From pixel centres to the corner of the top-left pixel.
            "points": [{"x": x + 0.5, "y": y + 0.5} for x, y in ends.tolist()],
            "outline_color": colour,
            "outline_colors": [],
            "fill_color": _CLEAR,
            "thickness": max(1.0, camera.height / 400),
        }
        lines = [line] if len(ends) else []
    return {"circles": [], "points": lines, "texts": [label]}


def outline(pose: Pose, camera: Camera, size_mm: tuple[float, float]) -> Array:
    """The pad's outline as far as it is in view.

    Returns
    -------
    (2N, 2) float64
        Ends of N segments, pixels.
    """
    corners = np.array([[-1, 1], [1, 1], [1, -1], [-1, -1], [-1, 1]]) / 2 * size_mm
    share = np.arange(_PIECES)[:, None] / _PIECES
    sides = [(1 - share) * a + share * b for a, b in itertools.pairwise(corners)]
    flat = np.vstack([*sides, corners[:1]])
    points = pose.to_camera(np.c_[flat, np.zeros(len(flat))])
    rim = np.array([[0, 0], [camera.width, 0], [camera.width, camera.height], [0, camera.height]])
    # Far beyond the picture a lens's formula is not that of the lens.
    reach = 1.1 * np.abs(camera.normalize(rim - 0.5)).max(axis=0)
    ahead = points[:, 2] > 0
    slope = points[:, :2] / np.where(ahead, points[:, 2], 1.0)[:, None]
    seen = ahead & (np.abs(slope) <= reach).all(axis=1)
    both = np.flatnonzero(seen[:-1] & seen[1:])
    ends = np.column_stack([both, both + 1]).ravel()
    return camera.project(points[ends])


def _vector(values: Array) -> Message:
    return dict(zip("xyz", values.tolist(), strict=True))


def _quaternion(pose: Pose) -> Message:
    return dict(zip("xyzw", pose.quaternion_xyzw.tolist(), strict=True))
