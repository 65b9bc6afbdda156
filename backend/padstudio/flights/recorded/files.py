"""The files of a recording, wherever they come from: uploads, a zip of them, a folder."""

from __future__ import annotations

import contextlib
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from padstudio.errors import LimitError
from padstudio.flights.recorded.session import (
    RecordedSegment,
    RecordedSession,
    RecordingFormatError,
    read_session,
)
from padstudio.geometry.camera import Camera
from padstudio.media.content import ContentError
from padstudio.media.live_files import SESSION, live_members
from padstudio.media.zip_stills import ZipLimits
from padstudio.pad.spec import Pad
from padstudio.workers.pads import summarize


@dataclass(frozen=True)
class RecordedFile:
    """A file of a recording.

    Attributes
    ----------
    name : str
        In the recording's folder.
    path : Path
    size_bytes : int
    member : str or None
        Its name within the zip that `path` is.
    upload : str or None
        The upload that it is.
    """

    name: str
    path: Path
    size_bytes: int
    member: str | None = None
    upload: str | None = None

    @contextlib.contextmanager
    def open(self) -> Iterator[IO[bytes]]:
        """Its content; raises `ContentError` where a zip's is damaged."""
        if self.member is None:
            with self.path.open("rb") as file:
                yield file
            return
        try:
            with zipfile.ZipFile(self.path) as archive, archive.open(self.member) as file:
                yield file
        except (zipfile.BadZipFile, EOFError, NotImplementedError, RuntimeError) as error:
            raise ContentError(
                f"{self.name} cannot be read from the zip ({error}); pack it again",
                code="damaged_zip",
            ) from error


Files = Mapping[str, RecordedFile]


def files_of_zip(path: Path, limits: ZipLimits) -> Files:
    """Those in a zip of a recording's folder; raises as `live_members`."""
    members = live_members(path, limits)
    with zipfile.ZipFile(path) as archive:
        sizes = {name: archive.getinfo(member).file_size for name, member in members.items()}
    return {n: RecordedFile(n, path, sizes[n], member) for n, member in members.items()}


def files_of_folder(folder: Path) -> Files:
    """Those in a recording's folder."""
    found = [path for path in folder.iterdir() if path.is_file() and not path.is_symlink()]
    return {path.name: RecordedFile(path.name, path, path.stat().st_size) for path in found}


@dataclass(frozen=True)
class LookedInto:
    """What a recording says of itself, ready to be stored.

    Attributes
    ----------
    session : RecordedSession
    pads : list of mapping
        What lists show of each pad.
    camera_px : (width, height)
    """

    session: RecordedSession
    pads: list[dict[str, Any]]
    camera_px: tuple[int, int]


def look_into(file: RecordedFile, most_bytes: int) -> LookedInto:
    """Read a recording's ``session.json``, in a worker process.

    Raises
    ------
    StudioError
        As `padstudio.flights.recorded.session.read_session`; or if it is too large.
    """
    if file.size_bytes > most_bytes:
        raise LimitError(
            f"{SESSION} has {file.size_bytes / 1e6:.0f} MB; the limit is {most_bytes / 1e6:g} MB"
        )
    with file.open() as opened:
        session = read_session(opened.read(most_bytes + 1))
    camera = Camera.loads(session.camera)
    return LookedInto(
        session,
        [dict(summarize(Pad.loads(text))) for text in session.pads],
        (camera.width, camera.height),
    )


def parts_of(
    session: RecordedSession, files: Files
) -> list[tuple[RecordedFile, RecordedFile | None]]:
    """The video of each segment that has frames, and its poses where there are any.

    Raises
    ------
    RecordingFormatError
        If files are missing, or there are others than the recording's.
    """
    parts = []
    for place, segment in enumerate(session.segments):
        is_last = place == len(session.segments) - 1
        video, poses = _filled(files, segment.video), _filled(files, segment.poses)
        if video is None and is_last and not session.is_whole:
            # It broke off before the first frame.
            continue
        _check_there(segment, video, poses, may_lack_poses=not session.is_whole)
        assert video is not None
        parts.append((video, poses))
    if not parts:
        raise RecordingFormatError("the recording holds no frame", code="no_frames")
    known = {name for each in session.segments for name in (each.video, each.poses)} | {SESSION}
    if strange := sorted(n for n, file in files.items() if file.upload and n not in known):
        raise RecordingFormatError(
            f"{strange[0]} is no file of this recording; send its own folder",
            code="live_files_mixed",
        )
    return parts


def _filled(files: Files, name: str) -> RecordedFile | None:
    file = files.get(name)
    return file if file is not None and file.size_bytes else None


def _check_there(
    segment: RecordedSegment,
    video: RecordedFile | None,
    poses: RecordedFile | None,
    *,
    may_lack_poses: bool,
) -> None:
    lacking = segment.video if video is None else segment.poses if poses is None else None
    if lacking is None or (video is not None and may_lack_poses):
        return
    raise RecordingFormatError(
        f"{lacking} is missing: {SESSION} names it; send the whole folder",
        code="live_files_missing",
    )
