"""The files that a poses file names: their frames' sizes and pictures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from padstudio.errors import StudioError
from padstudio.flights.exports.frames.pictures import to_jpeg
from padstudio.flights.tasks.frames import VideoPart
from padstudio.media import images
from padstudio.media.recordings.times import TopicTimes
from padstudio.media.video_index import VideoIndex, VideoInfo, read_index

Record = dict[str, Any]
Size = tuple[int, int]

# Of a record's time and that of a frame of its video, s.
_SAME_TIME_S = 1e-3


@dataclass(frozen=True)
class _Video:
    """A video, and where it begins among all frames."""

    index: VideoIndex
    recording: TopicTimes | None
    first_frame: int
    start_s: float


class SourceFiles:
    """The sources of a poses file, as far as they are there.

    Parameters
    ----------
    folder : Path
        To which sources are relative.
    sources : mapping of str to (width, height) or None
        All of them, in the order of the file, with the size of their frames where it is told.
    topics : mapping of str to str
        Of those that are recordings: that of their frames.
    """

    def __init__(
        self, folder: Path, sources: Mapping[str, Size | None], topics: Mapping[str, str]
    ) -> None:
        self._folder, self._sources, self._topics = folder, sources, topics
        self._open: tuple[str, Iterator[tuple[int, bytes | None]]] | None = None
        self._sizes: dict[str, Size | None] = {}
        #: Records whose picture was asked for and is not there.
        self.missing = 0

    def frame_px(self, record: Record) -> Size | None:
        """The size of a record's frame, by its file; None where that cannot be read."""
        source = record["source"]
        if source not in self._sizes:
            try:
                self._sizes[source] = self._size(source, is_video=record.get("time_s") is not None)
            except (StudioError, OSError):
                self._sizes[source] = None
        return self._sizes[source]

    def picture(self, record: Record) -> bytes | None:
        """A record's frame as a JPEG file, for records in the order of the file; else None."""
        try:
            found = self._picture(record)
        except (StudioError, OSError):
            found = None
        if found is None and record.get("stage") != "read":
            self.missing += 1
        return found

    def _size(self, source: str, *, is_video: bool) -> Size:
        if is_video:
            return self._index(source)[0].info.shown_size
        height, width = images.read(self._folder / source).shape[:2]
        return width, height

    def _picture(self, record: Record) -> bytes | None:
        source = record["source"]
        if record.get("time_s") is None:
            return to_jpeg(images.read(self._folder / source))
        place = self._place(record)
        if place is None:
            return None
        if self._open is None or self._open[0] != source:
            self._open = source, self._frames(source)
        # Videos are decoded once, forward; frames that were left out are passed over.
        return next((data for number, data in self._open[1] if number >= place), None)

    def _place(self, record: Record) -> int | None:
        """Which frame of its video a record is of, by number and time; None where they differ."""
        video = self._videos.get(record["source"])
        if video is None:
            return None
        index = video.index
        times_s = (index.pts - index.pts[0]) * float(index.time_base)
        # Files of older versions count frames and times of each video from 0.
        for first, start_s in ((video.first_frame, video.start_s), (0, 0.0)):
            place = int(record["frame"]) - first
            since_s = record["time_s"] - start_s
            if 0 <= place < len(times_s) and abs(times_s[place] - since_s) < _SAME_TIME_S:
                return place
        return None

    @cached_property
    def _videos(self) -> dict[str, _Video]:
        """All videos that are there; one that is not counts as one frame, as when detecting."""
        found: dict[str, _Video] = {}
        frame, time_s = 0, 0.0
        for source in self._sources:
            try:
                index, recording = self._index(source)
            except (StudioError, OSError):
                frame += 1
                continue
            found[source] = _Video(index, recording, frame, time_s)
            frame += index.info.frames
            time_s += index.info.duration_s
        return found

    def _index(self, source: str) -> tuple[VideoIndex, TopicTimes | None]:
        """A video's frames, or those of a recording's topic, with how these are found again."""
        path = str(self._folder / source)
        if source in self._topics:
            from padstudio.media.recordings import index as recordings

            found = recordings.read_index(path, self._topics[source])
            return found.video, found.times
        return read_index(path), None

    def _frames(self, source: str) -> Iterator[tuple[int, bytes | None]]:
        index = self._videos[source].index
        part = VideoPart(
            url=str(self._folder / source),
            name=source,
            pts=index.pts.astype("<i8").tobytes(),
            start_pts=int(index.pts[0]),
            time_base_s=float(index.time_base),
            start_s=0.0,
            rotation_deg=_rotation(index.info, self._sources[source]),
            is_counted=index.is_counted,
            recording=self._videos[source].recording,
        )
        for number, picture in enumerate(part.read(images.MAX_PIXELS)):
            yield number, None if picture.bgr is None else to_jpeg(picture.bgr)


def _rotation(info: VideoInfo, frame_px: Size | None) -> int:
    """By how much pictures were turned when they were detected, by what size they had then."""
    as_shown = frame_px is None or frame_px == tuple(info.shown_size)
    return info.rotation_deg if as_shown else 0
