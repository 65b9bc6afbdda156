"""Which topics of a recording hold pictures, which one is meant, and the camera beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import yaml

from padstudio.errors import CameraFormatError, SpecError, shown
from padstudio.geometry.camera import Camera
from padstudio.geometry.camera_files.parts.lenses import NOT_SAID
from padstudio.media.recordings.folders import open_recording
from padstudio.media.recordings.messages import (
    MessageError,
    is_calibration,
    is_readable,
    picture_kind,
    read_message,
)
from padstudio.media.recordings.storage import Channel, RecordingError, Storage

# Last parts of the names of topics that hold another topic's pictures, packed.
_TRANSPORTS = ("compressed", "compressedDepth", "theora", "ffmpeg", "h264", "zstd")
_CALIBRATION_NAMES = ("camera_info", "calibration")
# Part of the names of topics whose pictures are undistorted (ros-perception, ``image_proc``).
_RECTIFIED = "rect"


@dataclass(frozen=True)
class Look:
    """What a recording holds, for who orders a flight of it.

    Attributes
    ----------
    topic : str
        The one that frames are taken from.
    topics : tuple of str
        All with pictures.
    camera : str or None
        The content of a camera file, by the calibration recorded beside the topic; None where
        there is none.
    """

    topic: str
    topics: tuple[str, ...]
    camera: str | None


def look(source: str, topic: str | None = None) -> Look:
    """Look into a recording, before any of its pictures is read.

    Parameters
    ----------
    source : str
        As of `padstudio.media.recordings.folders.open_recording`, which also says what it raises.
    topic : str or None

    Raises
    ------
    RecordingError
        If the topic is not there, or is to be chosen; the message lists what there is.
    CameraFormatError
        If the recorded calibration is of no known lens model.
    """
    storage = open_recording(source)
    chosen = picture_channels(storage, topic)[0]
    topics = tuple(sorted({channel.topic for channel in _with_pictures(storage)}))
    return Look(chosen.topic, topics, recorded_camera(storage, chosen.topic))


def camera_of(looks: Sequence[Look]) -> str:
    """The content of the camera file that recordings agree on.

    Raises
    ------
    SpecError
        If one has no calibration beside its topic, or they differ.
    """
    for each in looks:
        if each.camera is None:
            raise SpecError(
                f"the recording has no calibration beside {each.topic} (camera_info); give the "
                "camera",
                code="camera_required",
            )
    cameras = {each.camera for each in looks if each.camera is not None}
    if len(cameras) != 1:
        raise SpecError(
            "the recordings have different calibrations; give the camera"
            if cameras
            else "no camera is given, and nothing brings one along: give the camera",
            code="camera_required",
        )
    return cameras.pop()


def picture_channels(storage: Storage, topic: str | None) -> list[Channel]:
    """The channels of the topic that frames are taken from; all are of one type.

    Parameters
    ----------
    storage : Storage
    topic : str or None
        None where there is only one.

    Raises
    ------
    RecordingError
        As of `look`.
    """
    found = _with_pictures(storage)
    topics = sorted({channel.topic for channel in found})
    detail = {"topics": topics}
    if not found:
        there = ", ".join(sorted({f"{c.topic} ({c.type or '?'})" for c in storage.channels}))
        raise RecordingError(
            "the recording holds no topic with pictures that can be read (sensor_msgs Image or "
            "CompressedImage, foxglove RawImage, CompressedImage or CompressedVideo); there are "
            f"{_shortened(there)}",
            code="no_pictures",
        )
    if topic is None and len(topics) > 1:
        raise RecordingError(
            f"the recording holds {len(topics)} topics with pictures: {', '.join(topics)}; choose "
            "one with --topic, or as topic of the flight",
            code="several_topics",
            detail=detail,
        )
    topic = topics[0] if topic is None else topic
    chosen = [channel for channel in found if channel.topic == topic]
    if not chosen:
        raise RecordingError(
            f"the recording holds no pictures on {shown(topic)}; topics with pictures are "
            f"{', '.join(topics)}",
            code="unknown_topic",
            detail=detail,
        )
    if len({(channel.type, channel.encoding) for channel in chosen}) > 1:
        raise RecordingError(f"{topic} has messages of several types, which are not read together")
    return chosen


def calibration_channels(storage: Storage, topic: str) -> list[Channel]:
    """Channels that tell the calibration of the camera whose pictures a topic has.

    They stand beside it: ``/cam/camera_info`` beside ``/cam/image_raw`` and
    ``/cam/image_raw/compressed``.
    """
    namespace, _, last = topic.rpartition("/")
    if last in _TRANSPORTS:
        namespace = namespace.rpartition("/")[0]
    names = [f"{namespace}/{name}" for name in _CALIBRATION_NAMES]
    return [
        channel
        for channel in storage.channels
        if channel.topic in names and is_calibration(channel) and is_readable(channel)
    ]


def recorded_camera(storage: Storage, topic: str) -> str | None:
    """The content of a camera file, by the first calibration beside a topic; None without one.

    Raises
    ------
    CameraFormatError
        If it is of no known lens model, or not set.
    """
    channels = {channel.id: channel for channel in calibration_channels(storage, topic)}
    for message in storage.messages(channels) if channels else ():
        try:
            fields = read_message(channels[message.channel], message.data)
            text = _as_yaml(fields, topic)
        except (MessageError, AttributeError, TypeError, ValueError):
            continue
        name = channels[message.channel].topic
        try:
            return Camera.loads(text, f"{name}.yaml").to_ros_yaml()
        except CameraFormatError as error:
            # What may be said beside a camera file cannot be said of this one.
            why = (
                f"{name}.yaml: it holds no distortion coefficients"
                if error.error_code == NOT_SAID
                else error.message
            )
            raise CameraFormatError(
                f"the calibration that the recording has on {name} cannot be used: {why}; give a "
                "camera file",
                detail=error.detail,
            ) from error
    return None


def lens_of(fields: Any) -> tuple[Any, ...]:
    """What of a calibration's message makes up the lens, to be compared."""
    return (
        int(fields.width),
        int(fields.height),
        str(fields.distortion_model),
        *(tuple(_values(fields, key)) for key in "dkp"),
        *(int(getattr(fields, name, 0) or 0) for name in ("binning_x", "binning_y")),
        *_region(fields).values(),
    )


def _with_pictures(storage: Storage) -> list[Channel]:
    return [c for c in storage.channels if picture_kind(c) is not None and is_readable(c)]


def _values(fields: Any, key: str) -> list[float]:
    found = getattr(fields, key, None)
    values = getattr(fields, key.upper(), ()) if found is None else found
    return [float(value) for value in np.asarray(values, float).ravel()]


def _region(fields: Any) -> dict[str, Any]:
    region = getattr(fields, "roi", None)
    if region is None:
        return {}
    sides = ("x_offset", "y_offset", "height", "width")
    return {name: int(getattr(region, name)) for name in sides} | {
        "do_rectify": bool(region.do_rectify)
    }


def _as_yaml(fields: Any, topic: str) -> str:
    """A calibration's message as ``ros2 topic echo`` writes it, which is a kind of camera file."""
    matrix, projection = _values(fields, "k"), _values(fields, "p")
    model, distortion = str(fields.distortion_model), _values(fields, "d")
    # So Foxglove calls what ROS calls equidistant.
    model = "equidistant" if model == "kannala_brandt" else model
    if _RECTIFIED in _image_name(topic) and len(projection) == 12:
        # Undistorted pictures are of the pinhole camera that the projection tells.
        matrix = [projection[4 * row + column] for row in range(3) for column in range(3)]
        model, distortion = "plumb_bob", [0.0] * 5
    told: dict[str, Any] = {
        "camera_name": topic.rpartition("/")[0].strip("/") or topic.strip("/"),
        "height": int(fields.height),
        "width": int(fields.width),
        "distortion_model": model,
        "d": distortion,
        "k": matrix,
    }
    for name in ("binning_x", "binning_y"):
        if hasattr(fields, name):
            told[name] = int(getattr(fields, name))
    if region := _region(fields):
        told["roi"] = region
    return yaml.safe_dump(told, sort_keys=False)


def _image_name(topic: str) -> str:
    parts = topic.split("/")
    return parts[-2] if len(parts) > 1 and parts[-1] in _TRANSPORTS else parts[-1]


def _shortened(text: str) -> str:
    return text if len(text) <= 1000 else f"{text[:1000]} …"
