"""Looks into a flight's uploads and parts the work into chunks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import CameraMismatchError, SpecError, StudioError
from padstudio.geometry.camera import Camera
from padstudio.media.telemetry import srt
from padstudio.media.telemetry.columns import to_dict
from padstudio.media.telemetry.reading import read
from padstudio.media.video_index import VideoIndex, VideoInfo, read_index
from padstudio.media.zip_stills import list_members

# A chunk's first frame is looked for in the whole picture, which costs as much as several others.
_LEAST_FRAMES = 30
_LEAST_STRIDED_FRAMES = 10
_SHORT_FLIGHT_CHUNKS = 8
# No chunk holds more than this share of the frames that are left, so that workers end together.
_SHARE_OF_REST = 1 / 4
# Frames between two keyframes that are this many times too many are parted all the same: whoever
# works on a later part decodes those before it once more. In so few parts, that costs at the most
# about what detection does, and several workers share both.
_TOO_LONG = 2
_MOST_PARTS = 8


@dataclass(frozen=True)
class SourceFile:
    """An upload of a flight: ``kind`` as of `padstudio.media.content.Content`."""

    upload: str
    kind: str
    name: str
    url: str


@dataclass(frozen=True)
class ChunkPlan:
    """A part of the work: frames of one video, or stills, as in `ChunkRow`."""

    source: int
    first_frame: int
    frames: int
    pts: bytes = b""
    numbers: bytes = b""


@dataclass(frozen=True)
class Plan:
    """What a flight's uploads hold, and the work on it.

    Attributes
    ----------
    sources : list of dict
        JSON-serialisable: upload, kind, name, url, first_frame, frames, start_s; of videos also
        start_pts, time_base_s, rotation_deg and `VideoInfo`; of recordings these and, as
        ``recording``, `padstudio.media.recordings.index.TopicTimes`; of zips the members.
    chunks : list of ChunkPlan
    telemetry : dict or None
        As `padstudio.media.telemetry.reading.read`.
    unread : dict of int to StudioError
        Places among the sources of those that cannot be read, each taken for one frame of no
        duration.
    """

    sources: list[dict[str, Any]]
    chunks: list[ChunkPlan]
    telemetry: dict[str, Any] | None
    unread: dict[int, StudioError] = field(default_factory=dict)


@dataclass(frozen=True)
class PlanTask:
    """The first task of a flight.

    Attributes
    ----------
    files : tuple of SourceFile
    camera : str
        The content of a camera file.
    first_frame, stride : int
    end_frame : int or None
        The first frame that is not worked on; None is the end.
    chunk_frames : int
        Frames that a chunk should hold.
    apply_rotation : bool
        Turn videos as their rotation flag says, unless the camera only fits them as stored.
    max_pixels, max_frames : int
    only : bytes or None
        Numbers of frames, int64 little-endian, rising: no others are worked on.
    keep_going : bool
        Files that cannot be read are told in the plan, and it may be empty; telemetry inside of
        videos is not looked for.
    topic : str or None
        Of recordings, whose frames are read; None where only one has pictures.
    """

    files: tuple[SourceFile, ...]
    camera: str
    first_frame: int
    end_frame: int | None
    stride: int
    chunk_frames: int
    apply_rotation: bool
    max_pixels: int
    max_frames: int
    only: bytes | None = None
    keep_going: bool = False
    topic: str | None = None

    def run(self, stopped: Callable[[], bool]) -> Plan:
        """Read the index of every file.

        Raises
        ------
        StudioError
            If a file cannot be read, does not fit the camera, or no frame is left to work on.
        """
        sources: list[dict[str, Any]] = []
        indices: dict[int, VideoIndex] = {}
        unread: dict[int, StudioError] = {}
        found: dict[str, Any] | None = None
        frame, time_s = 0, 0.0
        for file in self.files:
            try:
                if file.kind == "telemetry":
                    found = read(file.url)
                    continue
                entry, index = self._look(file, stopped)
            except StudioError as error:
                if not self.keep_going:
                    raise StudioError(
                        f"{file.name}: {error.message}", code=error.error_code, detail=error.detail
                    ) from error
                unread[len(sources)] = error
                entry, index = {"frames": 1}, None
            if index is not None:
                indices[len(sources)] = index
                if file.kind == "video" and not self.keep_going:
                    found = found or _embedded(file.url)
            sources.append(asdict(file) | {"first_frame": frame, "start_s": time_s} | entry)
            frame += entry["frames"]
            time_s += index.info.duration_s if index else 0.0
        chunks = list(self._chunks(sources, indices, frame))
        if not chunks and not self.keep_going:
            raise SpecError(
                f"no frame is left to work on: the uploads hold {frame} frames, and frames from "
                f"{self.first_frame} on were asked for",
                code="no_frames",
            )
        return Plan(sources, chunks, found, unread)

    def _look(
        self, file: SourceFile, stopped: Callable[[], bool]
    ) -> tuple[dict[str, Any], VideoIndex | None]:
        if file.kind == "still":
            return {"frames": 1}, None
        if file.kind == "stills":
            members = list_members(file.url)
            return {"frames": len(members), "members": members}, None
        recording: dict[str, Any] = {}
        if file.kind == "recording":
            from padstudio.media.recordings import index as recordings

            found = recordings.read_index(
                file.url,
                self.topic,
                max_pixels=self.max_pixels,
                max_frames=self.max_frames,
                pause=stopped,
            )
            index, recording = found.video, {"recording": asdict(found.times)}
        else:
            index = read_index(
                file.url, max_pixels=self.max_pixels, max_frames=self.max_frames, pause=stopped
            )
        rotation = self._rotation(index.info)
        return {
            "frames": index.info.frames,
            "start_pts": int(index.pts[0]),
            "time_base_s": float(index.time_base),
            "rotation_deg": rotation,
            "is_counted": index.is_counted,
            "video": asdict(index.info),
            **recording,
        }, index

    def _rotation(self, info: VideoInfo) -> int:
        """By how much pictures are turned; the calibration is of what the camera fits.

        Raises
        ------
        CameraMismatchError
            If it fits neither the picture as shown nor as stored.
        """
        camera = Camera.loads(self.camera)
        if not self.apply_rotation or not info.rotation_deg:
            camera.for_frame(info.width, info.height)
            return 0
        try:
            camera.for_frame(*info.shown_size)
        except CameraMismatchError as error:
            try:
                camera.for_frame(info.width, info.height)
            except CameraMismatchError:
                raise error from None
            return 0
        return info.rotation_deg

    def _chunks(
        self, sources: list[dict[str, Any]], indices: Mapping[int, VideoIndex], total: int
    ) -> Iterator[ChunkPlan]:
        # Short flights are parted too, so that all workers have something to do.
        size = min(self.chunk_frames, max(_LEAST_FRAMES, total // _SHORT_FLIGHT_CHUNKS))
        # Frames between those asked for are decoded as well.
        video_size = min(size, max(_LEAST_STRIDED_FRAMES, size // self.stride))
        end = total if self.end_frame is None else min(self.end_frame, total)
        wanted = np.arange(self.first_frame, max(end, self.first_frame), self.stride)
        if self.only is not None:
            wanted = np.intersect1d(wanted, np.frombuffer(self.only, "<i8"))
        stills: list[int] = []
        for place, source in enumerate(sources):
            first = source["first_frame"]
            mine = wanted[(wanted >= first) & (wanted < first + source["frames"])]
            if place not in indices:
                stills += mine.tolist()
                continue
            keyframes, left = indices[place].keyframes, int((wanted >= first).sum())
            for numbers in _by_keyframe(mine - first, keyframes, video_size, left):
                pts = indices[place].pts[numbers].astype("<i8").tobytes()
                yield self._chunk(place, numbers + first, pts)
        # Stills take longer than frames of a video, which are tracked.
        size = max(1, size // 4)
        for at in range(0, len(stills), size):
            yield self._chunk(0, np.array(stills[at : at + size]))

    def _chunk(self, source: int, numbers: NDArray[np.int64], pts: bytes = b"") -> ChunkPlan:
        told = b"" if self.only is None else numbers.astype("<i8").tobytes()
        return ChunkPlan(source, int(numbers[0]), len(numbers), pts, told)


def _embedded(url: str) -> dict[str, Any] | None:
    """Telemetry inside a video."""
    found = srt.read_embedded(url)
    return to_dict(found) if found else None


def _by_keyframe(
    numbers: NDArray[np.int64], keyframes: NDArray[np.int64], chunk_frames: int, left: int
) -> Iterator[NDArray[np.int64]]:
    """Runs of frame numbers that start where decoding can, each about `chunk_frames` long.

    Where keyframes are too far apart for that, they start between them, too. They
    become shorter toward the end (guided self-scheduling, Polychronopoulos and Kuck 1987,
    doi:10.1109/TC.1987.5009495); `left` frames are these and all behind them.
    """
    group = np.searchsorted(keyframes, numbers, side="right")
    start = 0
    for place in np.flatnonzero(np.diff(group)) + 1:
        rest = int(_SHARE_OF_REST * (left - start))
        if place - start >= min(chunk_frames, max(_LEAST_FRAMES, rest)):
            yield from _parted(numbers[start:place], chunk_frames)
            start = int(place)
    if start < len(numbers):
        yield from _parted(numbers[start:], chunk_frames)


def _parted(numbers: NDArray[np.int64], chunk_frames: int) -> list[NDArray[np.int64]]:
    """A run as it is, or parts of one that is much too long."""
    if len(numbers) <= _TOO_LONG * chunk_frames:
        return [numbers]
    return np.array_split(numbers, min(_MOST_PARTS, len(numbers) // chunk_frames))
