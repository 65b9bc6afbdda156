"""The session within its process: reads frames, keeps the last ones, says how it fares."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import cv2

from padstudio.arrays import Image, YuvFrame
from padstudio.errors import BusyError, ConflictError, StudioError, TimeLimitError
from padstudio.geometry.camera import Camera
from padstudio.live.recording.recorder import session_about
from padstudio.live.reports.report import LiveReport, Sight
from padstudio.live.reports.source import FrameSource
from padstudio.live.session import LiveSession
from padstudio.live.watched.figures import Figures
from padstudio.live.watched.order import BROWSER, LiveOrder, Told
from padstudio.live.watched.pushed import PushedFrames
from padstudio.live.watched.recording import RecordingSwitch
from padstudio.live.watched.shelf import FrameShelf, KeptFrame
from padstudio.media import images
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Pad
from padstudio.vision.detector import Detector
from padstudio.vision.overlays.marks import Marks
from padstudio.vision.overlays.pose_marks import pose_marks
from padstudio.vision.print_check import check_print
from padstudio.vision.stage.detection import Detection

# How often a session says how it is, and what is in view, s.
_STATE_EVERY_S, _POSE_EVERY_S = 0.5, 0.1
# Between two looks at whether the session is to end.
_LOOK_S = 0.25
# Between two checks of the print, s, and times as long as one takes.
_CHECK_EVERY_S, _CHECK_SHARE = 2.0, 8.0
# A frame takes a tenth of this where the machine is not busy.
_LONGEST_S = 20.0
# Pictures that are kept of a stream, at the most so often; q 95 leaves nothing that a cell shows.
_PICTURE_EVERY_S, _JPEG = 0.1, [cv2.IMWRITE_JPEG_QUALITY, 95]
_JPEG_START = b"\xff\xd8"
_MEDIA_TYPES = {_JPEG_START: "image/jpeg", b"\x89P": "image/png", b"RI": "image/webp"}


class WatchedSession:
    """One session; its methods are called from a few threads.

    Parameters
    ----------
    order : LiveOrder
    source : FrameSource
    recording : RecordingSwitch
    tell : callable
        Takes what is said of its own accord.

    Raises
    ------
    StudioError
        If a pad or the camera cannot be read, or they do not go together.
    """

    def __init__(
        self,
        order: LiveOrder,
        source: FrameSource,
        recording: RecordingSwitch,
        tell: Callable[[Told], None],
    ) -> None:
        self._order, self._source, self._recording, self._tell = order, source, recording, tell
        self._detector = Detector(
            [Pad.loads(text) for text in order.pads], Camera.loads(order.camera)
        )
        # Another thread's: detectors keep what they found last.
        self._checker = Detector(self._detector.pads, self._detector.camera)
        self._pads = {pad_id(pad): pad for pad in self._detector.pads}
        self._began_s = time.monotonic()
        self._shelf, self._figures = FrameShelf(), Figures()
        self._reports = threading.Condition()
        self._last: LiveReport | None = None
        self._print: list[dict[str, Any]] = []
        self._sight: Sight = "no_stream"
        self._sight_detail = ""
        self._session = LiveSession(self._detector, source, [_Ear(self)])
        self._is_pushing = threading.Lock()
        self._is_over = threading.Event()

    # What goes on by itself

    def read(self) -> None:
        """Read frames until the session is closed or its source has ended."""
        self._session.run()

    def keep(self) -> None:
        """Keep pictures of a stream's frames, until the session is closed."""
        shown = -1
        while not self._is_over.is_set():
            report = self._newer_than(shown, _LOOK_S)
            if report is None:
                continue
            shown = report.frame.number
            began_s = time.monotonic()
            self._shelf.add(self._kept(report, *_encoded(report.frame.picture)))
            self._is_over.wait(_PICTURE_EVERY_S - (time.monotonic() - began_s))

    def check(self) -> None:
        """Check the print in a frame that is read, now and then, until the session is closed."""
        shown = -1
        while not self._is_over.is_set():
            report = self._newer_than(shown, _LOOK_S)
            if report is None:
                continue
            shown = report.frame.number
            if not report.detection.ok:
                continue
            picture = report.frame.picture
            began_s = time.monotonic()
            bgr = picture.bgr if isinstance(picture, YuvFrame) else picture
            items = [asdict(item) for item in check_print(bgr, self._checker)]
            with self._reports:
                self._print = items or self._print
            # It takes a small share of the machine, however slow that is.
            took_s = time.monotonic() - began_s
            self._is_over.wait(max(_CHECK_EVERY_S, _CHECK_SHARE * took_s))

    def say(self) -> None:
        """Say how the session is and what it sees, until it is closed."""
        said_s, shown = 0.0, -1
        while not self._is_over.is_set():
            if time.monotonic() - said_s >= _STATE_EVERY_S:
                said_s = time.monotonic()
                self._tell(Told("state", self.state()))
            report = self._newer_than(shown, _POSE_EVERY_S)
            if report is not None:
                shown = report.frame.number
                self._tell(Told("pose", {"number": shown, "record": self._record(report)}))
                self._is_over.wait(_POSE_EVERY_S)

    def close(self) -> None:
        """End it; from any thread."""
        self._session.stop()
        self._is_over.set()
        self._shelf.close()
        with self._reports:
            self._reports.notify_all()

    def take(self, report: LiveReport) -> None:
        """A frame was read."""
        self._recording.take(report)
        with self._reports:
            self._figures.add(report)
            self._last = report
            self._reports.notify_all()

    def sight_changed(self, sight: Sight, detail: str) -> None:
        """The pad or the stream was lost or found."""
        with self._reports:
            self._sight, self._sight_detail = sight, detail

    # What is asked

    def state(self) -> dict[str, Any]:
        """All that a page shows but poses; JSON-serialisable."""
        stream = self._source.state
        with self._reports:
            figures = self._figures.to_dict(time.monotonic())
            sight, detail, last = self._sight, self._sight_detail, self._last
            items = self._print
        return {
            "stream": {
                "phase": stream.phase,
                "detail": stream.detail,
                "code": stream.code,
                "frames": stream.frames,
                "dropped": stream.dropped,
                "damaged": stream.damaged,
                "connections": stream.connections,
                "size_px": list(stream.size_px) if stream.size_px else None,
                "codec": stream.codec,
            },
            "sight": sight,
            "sight_detail": detail,
            "newest": None if last is None else last.frame.number,
            "figures": figures,
            "recording": self._recording.state(),
            "print_check": items,
        }

    def push(self, data: bytes) -> dict[str, Any]:
        """Read a picture, and say what came of it.

        Raises
        ------
        ConflictError
            If the session's frames come from elsewhere.
        BusyError
            If another one is being read.
        ImageError, LimitError, CameraMismatchError
            If it cannot be read, or is not of the camera's aspect.
        """
        source = self._source
        if not isinstance(source, PushedFrames):
            raise ConflictError("this session reads a stream; its frames are not sent to it")
        if not self._is_pushing.acquire(blocking=False):
            raise BusyError("a frame of this session is being read; send the next one after it")
        try:
            arrived_s = time.monotonic()
            picture = images.decode(data, self._order.max_pixels)
            self._detector.camera.for_frame(picture.shape[1], picture.shape[0])
            pts_s = arrived_s - self._began_s
            if self._recording.is_on:
                is_jpeg = data.startswith(_JPEG_START)
                jpeg = data if is_jpeg else _encoded(picture)[0]
                self._recording.frame_bytes(jpeg, pts_s, arrived_s)
            number = source.push(picture, arrived_s, pts_s)
            report = self._report_of(number)
        finally:
            self._is_pushing.release()
        media_type = _MEDIA_TYPES.get(data[:2], "application/octet-stream")
        kept = self._kept(report, data, media_type)
        self._shelf.add(kept)
        return kept.to_dict()

    def record(self, recording_id: str) -> dict[str, Any] | None:
        """Begin a recording; how it is. Raises as `RecordingSwitch.start`."""
        detector, source = self._detector, self._order.source
        about = session_about(detector.pads, detector.camera, source)
        self._recording.start(self._order.recordings / recording_id, about)
        return self._recording.state()

    def stop_recording(self) -> dict[str, Any] | None:
        """End the recording; how it ended, None where there was none."""
        self._recording.stop()
        return self._recording.state()

    def newest(self, after: int, timeout_s: float) -> dict[str, Any] | None:
        """The newest kept frame, waiting for one after a number; None where none has come yet."""
        found = self._shelf.newest(after, timeout_s)
        return None if found is None else found.to_dict()

    def frame(self, number: int) -> dict[str, Any]:
        """A kept frame."""
        return self._shelf.get(number).to_dict()

    def frames(self) -> list[dict[str, Any]]:
        """All kept frames."""
        return self._shelf.list()

    def picture(self, number: int) -> tuple[bytes, str]:
        """A kept frame's picture and its media type."""
        kept = self._shelf.get(number)
        return kept.picture, kept.media_type

    def _report_of(self, number: int) -> LiveReport:
        found = self._newer_than(number - 1, _LONGEST_S)
        if found is None:
            raise TimeLimitError("the frame was not read in time; the machine is too busy")
        return found

    def _newer_than(self, number: int, timeout_s: float) -> LiveReport | None:
        with self._reports:
            self._reports.wait_for(
                lambda: self._is_newer(number) or self._is_over.is_set(), timeout_s
            )
            return self._last if self._is_newer(number) else None

    def _is_newer(self, number: int) -> bool:
        return self._last is not None and self._last.frame.number > number

    def _kept(self, report: LiveReport, picture: bytes, media_type: str) -> KeptFrame:
        return KeptFrame(
            report.frame.number,
            report.frame.taken_s - self._began_s,
            self._record(report),
            self._marks(report.detection),
            picture,
            media_type,
        )

    def _record(self, report: LiveReport) -> dict[str, Any]:
        source = "camera" if self._order.source == BROWSER else "stream"
        return report.detection.to_record(
            source, frame=report.frame.number, time_s=report.frame.pts_s
        )

    def _marks(self, detection: Detection) -> dict[str, Any]:
        pad = self._pads.get(detection.pad_id or "")
        if pad is None or detection.frame_px is None:
            return Marks().to_dict()
        return pose_marks(
            detection, pad, self._detector.camera.for_frame(*detection.frame_px)
        ).to_dict()


class _Ear:
    """The output that tells a session; it goes on when its source has ended."""

    def __init__(self, session: WatchedSession) -> None:
        self.take, self.sight_changed = session.take, session.sight_changed

    def close(self) -> None:
        """No more will come; what came can still be looked at."""


def _encoded(picture: Image | YuvFrame) -> tuple[bytes, str]:
    bgr = picture.bgr if isinstance(picture, YuvFrame) else picture
    done, data = cv2.imencode(".jpg", bgr, _JPEG)
    if not done:
        raise StudioError("a frame could not be encoded as JPEG")
    return data.tobytes(), "image/jpeg"
