"""A live session: takes the newest frame, finds the pad, hands the pose on, and counts.

All of it happens in the thread that calls `LiveSession.run`. A frame that brings trouble costs that
frame, and an output that fails costs its own messages: the session goes on.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import cv2

from padstudio.errors import StudioError
from padstudio.live.counts import SessionCounts
from padstudio.live.latency import WINDOW, LatencyMeter
from padstudio.live.reports.event import EventKind, takes_events
from padstudio.live.reports.frame import LiveFrame
from padstudio.live.reports.report import LiveReport, Output
from padstudio.live.reports.source import FrameSource, StreamState
from padstudio.live.sight import SightChange, SightKeeper, SightOptions
from padstudio.vision.detector import Detector
from padstudio.vision.follower import Follower
from padstudio.vision.stage.detection import Detection

logger = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class SessionOptions:
    """How a session goes.

    Attributes
    ----------
    sight : SightOptions
    look_s : float
        How long to wait for a frame before looking whether the stream is still there.
    end_s : float
        How long to wait for what is still to be decoded, where a source has ended.
    duration_s : float or None
        Ends after so long.
    window : int
        Frames of the sliding window of latencies.
    """

    sight: SightOptions = field(default_factory=SightOptions)
    look_s: float = 0.25
    end_s: float = 1.0
    duration_s: float | None = None
    window: int = WINDOW


class LiveSession:
    """Reads one source's frames.

    Parameters
    ----------
    detector : Detector
    source : FrameSource
        The session does not close it.
    outputs : sequence of Output
        Called in order, in the thread of `run`; those that are also an
        `padstudio.live.reports.event.EventOutput` hear of the stream. Closed when it ends.
    options : SessionOptions

    Attributes
    ----------
    counts : SessionCounts
    latency : LatencyMeter
    last : LiveReport or None
        That of the newest frame; from any thread.
    """

    def __init__(
        self,
        detector: Detector,
        source: FrameSource,
        outputs: Sequence[Output] = (),
        options: SessionOptions | None = None,
    ) -> None:
        self._options = options or SessionOptions()
        self._source, self._outputs = source, tuple(outputs)
        self._follower = Follower(detector)
        self._sight = SightKeeper(self._options.sight)
        self._is_over = threading.Event()
        self._told = StreamState()
        self._number: int | None = None
        self._connection: int | None = None
        self._refused_px: tuple[int, int] | None = None
        self._size_px: tuple[int, int] | None = None
        self._heard_s = time.monotonic()
        self.counts, self.latency = SessionCounts(), LatencyMeter(self._options.window)
        self.last: LiveReport | None = None

    @property
    def sight(self) -> str:
        """What is in view, as of `Sight`; ``no_stream`` before the first frame."""
        return self._sight.sight or "no_stream"

    def stop(self) -> None:
        """End it after the frame at hand; from any thread, or a signal's handler."""
        self._is_over.set()

    def run(self) -> SessionCounts:
        """Read frames until the source ends or is refused, or the session is stopped."""
        threads = cv2.getNumThreads()
        # A companion computer has other work for its other cores.
        cv2.setNumThreads(1)
        begun_s = self._heard_s = time.monotonic()
        lasts_s = self._options.duration_s
        try:
            while not self._is_over.is_set():
                if lasts_s is not None and time.monotonic() - begun_s >= lasts_s:
                    break
                frame = self._source.newest(self._options.look_s)
                state = self._source.state
                self._hear(state)
                has_ended = state.phase in ("ended", "refused")
                if frame is None and has_ended:
                    # The last ones may still be with the decoder.
                    frame = self._source.newest(self._options.end_s)
                if frame is not None:
                    self._look(frame)
                elif has_ended:
                    break
                else:
                    self._wait(state)
        finally:
            cv2.setNumThreads(threads)
            self._each(lambda output: output.close())
        return self.counts

    def _look(self, frame: LiveFrame) -> None:
        self._heard_s = time.monotonic()
        gone = 0 if self._number is None else frame.number - self._number - 1
        self._number = frame.number
        self.counts.dropped += gone
        if frame.connection != self._connection:
            # Times of another connection are on another clock.
            self._connection = frame.connection
            self._follower.forget()
        self._see_size(frame)
        detection = self._detect(frame)
        if detection is None:
            return
        report = LiveReport(frame, detection, time.monotonic(), gone)
        self.counts.frames += 1
        self.counts.poses += detection.ok
        self.counts.full += detection.quality == "full"
        self._each(lambda output: output.take(report))
        self.latency.add(report, time.monotonic())
        self.last = report
        failure = detection.failure
        if failure is not None:
            self.counts.reasons[str(failure.reason)] += 1
        self._say(self._sight.saw(detection.ok, failure.detail if failure else ""))

    def _detect(self, frame: LiveFrame) -> Detection | None:
        """What a frame shows; None where it could not be looked at."""
        try:
            return self._follower.take(frame.picture, frame.pts_s)
        except StudioError as error:
            self._refuse(frame, error)
        except Exception as error:
            self.counts.defects += 1
            self._follower.forget()
            logger.exception("frame %d brought a defect to light", frame.number, exc_info=error)
            self._say(self._sight.saw(False, f"a defect of the program: {error!r}"))
        return None

    def _see_size(self, frame: LiveFrame) -> None:
        height, width = frame.picture.shape[:2]
        before, self._size_px = self._size_px, (width, height)
        if before is not None and before != self._size_px:
            self._follower.forget()
            was = f"{before[0]} x {before[1]}"
            self._event("size", f"frames are {width} x {height} now, not {was}", "")

    def _refuse(self, frame: LiveFrame, error: StudioError) -> None:
        """A frame that the camera file is not of; said once a size."""
        self.counts.refused += 1
        self.counts.reasons[error.error_code] += 1
        if self._refused_px != self._size_px:
            self._refused_px = self._size_px
            self._event("frames_refused", error.message, error.error_code)
        self._say(self._sight.saw(False, error.message))

    def _hear(self, state: StreamState) -> None:
        """Say how the stream fares, where that has changed."""
        before, self._told = self._told, state
        if (state.phase, state.code, state.connections) == (
            before.phase,
            before.code,
            before.connections,
        ):
            return
        self._event(state.phase, state.detail, state.code)

    def _wait(self, state: StreamState) -> None:
        silent_s = time.monotonic() - self._heard_s
        if silent_s < self._options.sight.silent_s and state.phase != "lost":
            return
        why = state.detail or f"no frame for {silent_s:.1f} s"
        self._say(self._sight.heard_nothing(why))

    def _say(self, change: SightChange | None) -> None:
        if change is not None:
            self._each(lambda output: output.sight_changed(change.sight, change.detail))

    def _event(self, kind: EventKind, detail: str, code: str) -> None:
        def tell(output: Output) -> None:
            if takes_events(output):
                output.stream_changed(kind, detail, code)

        self._each(tell)

    def _each(self, call: Callable[[Output], None]) -> None:
        """Every output gets its call, whatever the others do."""
        for output in self._outputs:
            name = type(output).__name__
            try:
                call(output)
            except Exception as error:
                if not self.counts.output_errors[name]:
                    logger.exception("%s failed; the session goes on", name, exc_info=error)
                self.counts.output_errors[name] += 1
