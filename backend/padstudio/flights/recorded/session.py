"""Reads the file that says what a live session's recording holds; it may be anybody's."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from typing import Any

from padstudio.errors import StudioError
from padstudio.flights.tasks.detectors import params_from
from padstudio.geometry.camera import Camera
from padstudio.live.recording.folder import FORMAT, VERSION
from padstudio.media.live_files import SESSION
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Pad
from padstudio.vision.detector import check_pads
from padstudio.vision.stage.detection import Method

#: Videos of one recording.
MOST_SEGMENTS = 4_000
_MOST_PADS = 20
_MOST_TEXT, _MOST_VERSION = 2000, 60
_VIDEO = re.compile(r"^\d{4,6}\.mp4$")
# The year 5000.
_LATEST_UNIX_S = 1e11


class RecordingFormatError(StudioError):
    """A recording of a live session is ill-formed; the message names the file and the place."""

    code = "invalid_live_recording"
    status = 422


@dataclass(frozen=True)
class RecordedSegment:
    """Names of a segment's files."""

    video: str
    poses: str


@dataclass(frozen=True)
class RecordedSession:
    """What a recording says of itself.

    Attributes
    ----------
    program : str
        The version that recorded it.
    source : str
        The stream's address.
    unix_s : float
        When it began.
    is_ended : bool
        It does not go on.
    is_whole : bool
        It was ended on purpose; else the last segment may break off.
    method : {"dense", "paper"}
    params : dict
    pads : tuple of str
        The contents of pad files.
    pad_ids : tuple of str
        As of `padstudio.pad.identity.pad_id`.
    camera : str
        The content of a camera file.
    segments : tuple of RecordedSegment
    """

    program: str
    source: str
    unix_s: float
    is_ended: bool
    is_whole: bool
    method: Method
    params: dict[str, Any]
    pads: tuple[str, ...]
    pad_ids: tuple[str, ...]
    camera: str
    segments: tuple[RecordedSegment, ...]


def read_session(data: bytes) -> RecordedSession:
    """Read ``session.json``.

    Parameters
    ----------
    data : bytes

    Raises
    ------
    RecordingFormatError
        If it is none, of another version, or holds what such files do not.
    StudioError
        If its pads, camera or parameters cannot be used.
    """
    try:
        found = json.loads(data, parse_constant=no_number)
    except (ValueError, RecursionError) as error:
        raise RecordingFormatError(f"{SESSION} is no JSON; copy the recording again") from error
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        raise RecordingFormatError(f"{SESSION} is of no live session's recording")
    if found.get("version") != VERSION:
        raise RecordingFormatError(
            f"the recording is of version {str(found.get('version'))[:20]}, this program reads "
            f"{VERSION}; open it with the one that made it",
            code="live_recording_version",
        )
    try:
        return _session(found)
    except StudioError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise RecordingFormatError(
            f"{SESSION} is damaged ({error!r}); copy the recording again"
        ) from error


def _session(found: dict[str, Any]) -> RecordedSession:
    method, params = found["method"], found["params"]
    if method not in ("dense", "paper") or not isinstance(params, dict):
        raise ValueError("no method or no parameters")
    params_from(params)
    if not 1 <= len(found["pads"]) <= _MOST_PADS:
        raise ValueError("no pads, or too many")
    pads = [Pad.from_dict(pad) for pad in found["pads"]]
    check_pads(pads, method)
    camera = Camera.loads(plain_text(found["camera"], len(found["camera"])))
    unix_s = found["started"]["unix_s"]
    if isinstance(unix_s, bool) or not math.isfinite(unix_s) or not 0 <= unix_s <= _LATEST_UNIX_S:
        raise ValueError("a time that is none")
    ended = found["ended"]
    return RecordedSession(
        program=plain_text(found["program"], _MOST_VERSION),
        source=plain_text(found["source"], _MOST_TEXT),
        unix_s=float(unix_s),
        is_ended=ended is not None,
        is_whole=ended is not None and ended["code"] == "",
        method=method,
        params=params,
        pads=tuple(pad.dumps() for pad in pads),
        pad_ids=tuple(map(pad_id, pads)),
        camera=camera.to_ros_yaml(),
        segments=_segments(found["segments"]),
    )


def _segments(found: list[dict[str, Any]]) -> tuple[RecordedSegment, ...]:
    if len(found) > MOST_SEGMENTS:
        raise RecordingFormatError(
            f"the recording has {len(found)} segments; the limit is {MOST_SEGMENTS}"
        )
    segments = []
    for each in found:
        video, poses = each["video"], each["poses"]
        if not _VIDEO.match(video) or poses != video.replace(".mp4", ".jsonl"):
            raise ValueError("a segment's files are named otherwise than segments' are")
        segments.append(RecordedSegment(video, poses))
    names = [segment.video for segment in segments]
    if len(set(names)) < len(names) or names != sorted(names):
        raise ValueError("segments are named twice or are not in order")
    return tuple(segments)


def plain_text(value: Any, most: int) -> str:
    """A text that can be stored anywhere; raises `ValueError` where a value is none."""
    if not isinstance(value, str) or len(value) > most or "\0" in value:
        raise ValueError("a text that is none or too long")
    # Halves of characters have no bytes.
    value.encode()
    return value


def no_number(name: str) -> float:
    """Refuse what JSON has no numbers for."""
    raise ValueError(f"{name} is no number of JSON")
