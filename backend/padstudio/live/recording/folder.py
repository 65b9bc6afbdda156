"""What a recording's folder holds: names of its files, and the one that says what each is."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit, urlunsplit

from padstudio.errors import ConflictError, StorageError
from padstudio.media.live_files import SESSION

FORMAT, VERSION = "padstudio.live", 1
#: The camera's file.
CAMERA = "camera.yaml"
_SECRET = re.compile(r"(?i)([?&](?:pass\w*|pwd|token|key|auth|secret)=)[^&#]*")


def pad_name(place: int) -> str:
    """The file of a pad, of those that were looked for."""
    return "pad.json" if place == 0 else f"pad-{place + 1}.json"


def video_name(number: int) -> str:
    """The file of a segment's frames; segments count from 1."""
    return f"{number:04d}.mp4"


def poses_name(number: int) -> str:
    """The file of a segment's poses."""
    return f"{number:04d}.jsonl"


def without_secrets(address: str) -> str:
    """A source's address without its password, and without values that look like one."""
    parts = urlsplit(address)
    user, at, host = parts.netloc.rpartition("@")
    shown = parts._replace(netloc=user.partition(":")[0] + at + host)
    return _SECRET.sub(r"\1…", urlunsplit(shown) if parts.scheme else address)


@dataclass(frozen=True)
class SessionAbout:
    """What a recording is of.

    Attributes
    ----------
    pads : tuple of dict
        The JSON objects of pad files.
    camera : str
        The content of a camera file.
    source : str
        Its address; kept without a password.
    method : str
    params : mapping
        The detector's parameters that are not the defaults, by group and name.
    program : str
        The version of the program.
    """

    pads: tuple[dict[str, Any], ...]
    camera: str
    source: str = ""
    method: str = "dense"
    params: Mapping[str, Any] = field(default_factory=dict)
    program: str = ""


@dataclass
class SegmentEntry:
    """A segment in the session's file.

    Attributes
    ----------
    video, poses : str
        Names of its files.
    connection : int
    codec : str
    size_px : (width, height)
    time_base : (numerator, denominator)
        Unit of its timestamps, s.
    first_pts : int
        The stream's timestamp at the file's 0.
    first_frame : int
        Number of its first frame among all.
    start_s : float
        Time of its first frame in a flight of all segments, s.
    unix_s : float
        When its first packet arrived.
    frames, duration_s : int, float or None
        None until it has ended.
    """

    video: str
    poses: str
    connection: int
    codec: str
    size_px: tuple[int, int]
    time_base: tuple[int, int]
    first_pts: int
    first_frame: int
    start_s: float
    unix_s: float
    frames: int | None = None
    duration_s: float | None = None


@dataclass
class SessionFile:
    """What ``session.json`` says; changes with the recording.

    Attributes
    ----------
    about : SessionAbout
    unix_s, monotonic_s : float
        The same moment, the recording's begin, on both clocks.
    connections : list of dict
        ``connection``, ``unix_s``, ``codec``, ``size_px``.
    segments : list of SegmentEntry
    packets_dropped, reports_dropped : int
        What the disk was too slow for.
    ended_unix_s : float or None
        None while it goes on, and after a break.
    ended_by : str
        Code of what ended it; empty where it was told to.
    """

    about: SessionAbout
    unix_s: float
    monotonic_s: float
    connections: list[dict[str, Any]] = field(default_factory=list)
    segments: list[SegmentEntry] = field(default_factory=list)
    packets_dropped: int = 0
    reports_dropped: int = 0
    ended_unix_s: float | None = None
    ended_by: str = ""

    def unix_of(self, monotonic_s: float) -> float:
        """Unix time of a moment of `time.monotonic`."""
        return self.unix_s + (monotonic_s - self.monotonic_s)

    def to_text(self) -> str:
        """The file's content."""
        about = self.about
        return json.dumps(
            {
                "format": FORMAT,
                "version": VERSION,
                "program": about.program,
                "source": about.source,
                "method": about.method,
                "params": dict(about.params),
                "started": {"unix_s": self.unix_s, "monotonic_s": self.monotonic_s},
                "ended": None
                if self.ended_unix_s is None
                else {"unix_s": self.ended_unix_s, "code": self.ended_by},
                "dropped": {"packets": self.packets_dropped, "reports": self.reports_dropped},
                "connections": self.connections,
                "segments": [asdict(segment) for segment in self.segments],
                "pads": list(about.pads),
                "camera": about.camera,
            },
            ensure_ascii=False,
            indent=1,
        )


def begin_folder(folder: Path, about: SessionAbout) -> None:
    """Make a recording's folder, with its pads and camera.

    Raises
    ------
    ConflictError
        If there is something in it already.
    StorageError
        If it cannot be made or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise ConflictError(
                f"the folder {folder} is not empty; name a new one for the recording",
                code="folder_not_empty",
            )
        for place, pad in enumerate(about.pads):
            text = json.dumps(pad, ensure_ascii=False)
            (folder / pad_name(place)).write_text(text, encoding="utf-8")
        (folder / CAMERA).write_text(about.camera, encoding="utf-8")
    except OSError as error:
        raise StorageError(
            f"cannot write into the folder {folder}: {error.strerror}; choose another",
            code="cannot_record",
        ) from error


def write_session(folder: Path, session: SessionFile) -> None:
    """Put the session's file in the place of the one before, whole at any moment."""
    target = folder / SESSION
    fresh = target.with_suffix(".new")
    with fresh.open("w", encoding="utf-8") as file:
        file.write(session.to_text())
        file.flush()
        os.fsync(file.fileno())
    fresh.replace(target)
