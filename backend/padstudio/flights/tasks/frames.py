"""The work on a flight as pure tasks: what to read and how goes in, results come out.

A task runs on any machine that reaches the files it names; it knows nothing of the database or of
where it runs.
"""

from __future__ import annotations

import contextlib
import logging
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np

from padstudio.arrays import Image, YuvFrame
from padstudio.errors import ImageError, StudioError, TaskStoppedError
from padstudio.flights.tasks.detectors import Recipe, detector_for
from padstudio.flights.tasks.proxies import ProxyTarget, ProxyWriter
from padstudio.media import images
from padstudio.media.read_ahead import ReadAhead
from padstudio.media.recordings.times import TopicTimes
from padstudio.media.remote import read_bytes
from padstudio.media.video_frames import Keep, VideoPicture, read_frames
from padstudio.vision.detector import Detector
from padstudio.vision.stage.detection import Detection

Record = dict[str, Any]
logger = logging.getLogger(__name__)


# Frames that wait to be detected; a frame of 4 megapixels takes 6 MB in planes.
_AHEAD = 3
#: Of one frame in `VideoPart.pts`.
BYTES_OF_TIMESTAMP = 8


@dataclass(frozen=True)
class VideoPart:
    """Frames of one video.

    Attributes
    ----------
    url, name : str
        Where it lies, and what people call it.
    pts : bytes
        Presentation timestamps of the frames, int64 little-endian, ascending.
    start_pts : int
        That of the video's first frame.
    time_base_s : float
        Unit of the timestamps.
    start_s : float
        Time of the video's first frame in the flight.
    rotation_deg : int
        Turn the pictures clockwise: 0, 90, 180 or 270.
    is_counted : bool
        As of `padstudio.media.video_index.VideoIndex`.
    recording : TopicTimes or None
        Where they are a topic's of a recording: their timestamps are ns of Unix time.
    """

    url: str
    name: str
    pts: bytes
    start_pts: int
    time_base_s: float
    start_s: float
    rotation_deg: int = 0
    is_counted: bool = False
    recording: TopicTimes | None = None

    @property
    def is_stream(self) -> bool:
        """True where a frame rests on those before it, false where each lies by itself."""
        return self.recording is None or self.recording.is_stream

    @property
    def timestamps(self) -> list[int]:
        """The presentation timestamps."""
        return [int(value) for value in np.frombuffer(self.pts, "<i8")]

    def time_of(self, pts: int) -> float:
        """Time of a frame in the flight, s."""
        return self.start_s + (pts - self.start_pts) * self.time_base_s

    def between(self, first: int, end: int) -> VideoPart:
        """The frames at these places."""
        return replace(self, pts=self.pts[first * BYTES_OF_TIMESTAMP : end * BYTES_OF_TIMESTAMP])

    def last(self, count: int) -> VideoPart:
        """The last frames."""
        return replace(self, pts=self.pts[-count * BYTES_OF_TIMESTAMP :])

    def about(self, pts: int) -> Record:
        """What the record of a frame says of where it is from, beside its number."""
        told: Record = {"source": self.name, "time_s": self.time_of(pts)}
        if self.recording is not None:
            told |= {"topic": self.recording.topic, "stamp_ns": pts}
        return told

    def read(self, max_pixels: int, keep: Keep | None = None) -> Generator[VideoPicture]:
        """As `padstudio.media.video_frames.read_frames`."""
        if self.recording is not None:
            from padstudio.media.recordings import frames as recordings

            return recordings.read_frames(
                self.url, self.timestamps, self.recording, max_pixels=max_pixels, keep=keep
            )
        return read_frames(
            self.url,
            self.timestamps,
            rotation_deg=self.rotation_deg,
            is_counted=self.is_counted,
            max_pixels=max_pixels,
            keep=keep,
        )


@dataclass(frozen=True)
class StillPart:
    """One still.

    Attributes
    ----------
    url, name : str
        Where the file lies, and what people call the still.
    member : str or None
        Its name within the zip that the file is.
    """

    url: str
    name: str
    member: str | None = None


@dataclass(frozen=True)
class FramesTask:
    """Frames of a flight, to be detected.

    Attributes
    ----------
    recipe : Recipe
        Pad, camera and how to detect.
    numbers : sequence of int
        The frames' numbers in the flight.
    part : VideoPart or tuple of StillPart
    max_pixels : int
    proxies : ProxyTarget or None
        Where small pictures of the frames are kept on the way.
    """

    recipe: Recipe
    numbers: Sequence[int]
    part: VideoPart | tuple[StillPart, ...]
    max_pixels: int
    proxies: ProxyTarget | None = None

    def run(self, stopped: Callable[[], bool]) -> list[Record]:
        """Lines of a poses file, with ``covariance`` where there is a pose.

        Parameters
        ----------
        stopped : callable
            Asked between frames; the task ends where it says so.

        Raises
        ------
        TaskStoppedError
        StudioError
            If the file as a whole cannot be read.
        """
        threads = cv2.getNumThreads()
        # A worker is one process for one core.
        cv2.setNumThreads(1)
        try:
            return list(self._records(stopped))
        finally:
            cv2.setNumThreads(threads)

    def _records(self, stopped: Callable[[], bool]) -> Iterator[Record]:
        def look() -> None:
            if stopped():
                raise TaskStoppedError

        detector = detector_for(self.recipe)
        with ProxyWriter(self.proxies) as proxies:
            found = (
                self._video(detector, self.part, proxies, look)
                if isinstance(self.part, VideoPart)
                else self._stills(detector, self.part, proxies)
            )
            yield from self._numbered(found, look)

    def _numbered(self, found: Generator[Record], look: Callable[[], None]) -> Iterator[Record]:
        with contextlib.closing(found) as records:
            for number, record in zip(self.numbers, records, strict=False):
                look()
                yield record | {"frame": number}

    def _video(
        self, detector: Detector, part: VideoPart, proxies: ProxyWriter, look: Callable[[], None]
    ) -> Generator[Record]:
        """Decode in one thread and detect in another, this one, which alone calls `look`."""
        decoded = ReadAhead(part.read(self.max_pixels), _AHEAD, look)
        with contextlib.closing(decoded) as pictures:
            kept = proxies.beside(pictures, iter(self.numbers), part.time_of)
            for picture, found in _track(detector, kept):
                record = found if isinstance(found, dict) else with_covariance(found, part.name)
                record |= part.about(picture.pts)
                if picture.is_damaged:
                    record["damaged"] = True
                yield record

    def _stills(
        self, detector: Detector, parts: tuple[StillPart, ...], proxies: ProxyWriter
    ) -> Generator[Record]:
        for number, part in zip(self.numbers, parts, strict=True):
            try:
                image = read_still(part, self.max_pixels)
                proxies.add(number, None, image)
                _load_loops(detector, image)
                record = with_covariance(detector.detect(image), part.name)
            except StudioError as error:
                record = unread_record(error)
            except Exception as error:
                record = defect_record(error)
            yield record | {"source": part.name}


def _load_loops(detector: Detector, frame: Image | YuvFrame) -> None:
    """Read a process' first frame once more, before: its compiled loops are loaded on the way.

    Loading takes several times as long as reading, and would stand in the frame's time.
    """
    if detector.method in _loaded:
        return
    _loaded.add(detector.method)
    # What is wrong with the frame comes to light when it counts.
    with contextlib.suppress(Exception):
        detector.detect(frame)


_loaded: set[str] = set()


def read_still(part: StillPart, max_pixels: int) -> Image:
    """Decode a still of a flight; raises as `padstudio.media.images.decode`."""
    return images.decode(still_bytes(part), max_pixels)


def still_bytes(part: StillPart) -> bytes:
    """The file of a still of a flight.

    Raises
    ------
    ImageError
        If it is too large, or damaged where it lies in a zip.
    """
    if part.member is None:
        data = read_bytes(part.url, images.MAX_BYTES)
        if len(data) > images.MAX_BYTES:
            raise ImageError(f"{part.name} is larger than {images.MAX_BYTES // 1_000_000} MB")
        return data
    from padstudio.media.zip_stills import read_member

    return read_member(part.url, part.member)


def _track(
    detector: Detector, pictures: Iterator[VideoPicture]
) -> Iterator[tuple[VideoPicture, Detection | Record]]:
    """Each picture with its detection, or with the record that says why there is none."""
    waiting: deque[VideoPicture] = deque()

    def frames() -> Iterable[Image | YuvFrame]:
        for picture in pictures:
            frame = picture.frame
            waiting.append(VideoPicture(picture.pts, None, picture.is_damaged))
            if frame is not None:
                readable.append(picture.pts)
                _load_loops(detector, frame)
                yield frame

    readable: deque[int] = deque()
    while True:
        try:
            for detection in detector.track(frames(), fuse=False):
                yield from _lost_before(waiting, readable[0])
                readable.popleft()
                yield waiting.popleft(), detection
        except TaskStoppedError:
            raise
        except StudioError as error:
            failed: Record = unread_record(error)
        except Exception as error:
            failed = defect_record(error)
        else:
            yield from _lost_before(waiting, None)
            return
        if not readable:
            # Reading itself failed, not the detection of a frame.
            raise StudioError(failed["detail"], code=failed["reason"])
        yield from _lost_before(waiting, readable.popleft())
        yield waiting.popleft(), failed


def _lost_before(
    waiting: deque[VideoPicture], pts: int | None
) -> Iterator[tuple[VideoPicture, Record]]:
    while waiting and waiting[0].pts != pts:
        yield waiting.popleft(), _LOST.copy()


_LOST: Record = {
    "status": "failed",
    "stage": "read",
    "reason": "frame_lost",
    "detail": "the decoder gave no picture for this frame: its data are missing or damaged",
    "advice": "copy the file from the camera again",
    "elapsed_ms": {},
}


def with_covariance(detection: Detection, source: str) -> Record:
    """A line of a poses file, with ``covariance`` (upper triangle by rows) of a pose."""
    record = detection.to_record(source)
    if detection.uncertainty is not None:
        upper = np.triu_indices(6)
        record["covariance"] = detection.uncertainty.covariance[upper].tolist()
    return record


def unread_record(error: StudioError) -> Record:
    """What stands in the record of a frame that cannot be read, beside its source and number."""
    return _LOST | {"reason": error.error_code, "detail": error.message, "advice": ""}


def defect_record(error: Exception) -> Record:
    """As `unread_record`, where a frame brought a defect to light; the log has it whole."""
    logger.exception("a frame brought a defect to light", exc_info=error)
    detail = f"a defect of the program: {error!r}"
    return _LOST | {"reason": "internal_error", "detail": detail, "advice": ""}
