"""The detector: the one object that callers use; it alone knows the methods and the tracking."""

from __future__ import annotations

import copy
import math
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from padstudio.arrays import Image, YuvFrame
from padstudio.errors import ImageError, SpecError
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad
from padstudio.vision.baseline.method import Baseline
from padstudio.vision.dense.method import Dense
from padstudio.vision.dense.tracker import Expectation, Tracker
from padstudio.vision.fusion.detections import fused_detections
from padstudio.vision.search.known_pads import check_apart
from padstudio.vision.second_look import look_again
from padstudio.vision.stage.detection import Detection, Method
from padstudio.vision.stage.memo import Memo
from padstudio.vision.stage.params import DetectorParams
from padstudio.vision.stage.trace import Recorder


class Detector:
    """Reads one pad, or whichever of several are in view, through one camera.

    Parameters
    ----------
    pads : Pad or sequence of Pad
        The paper's method takes one. The order does not matter.
    camera : Camera
        Frames of another size but the same aspect are read with scaled intrinsics.
    method : {"dense", "paper"}
    params : DetectorParams

    Raises
    ------
    SpecError
        If there is no pad, two of them have the same cells in a channel, or the paper's method is
        to read several.
    """

    def __init__(
        self,
        pads: Pad | Sequence[Pad],
        camera: Camera,
        *,
        method: Method = "dense",
        params: DetectorParams | None = None,
    ) -> None:
        self.pads = (pads,) if isinstance(pads, Pad) else tuple(pads)
        check_pads(self.pads, method)
        self.camera = camera
        self.method = method
        self.params = params or DetectorParams()
        self._dense = Dense(self.pads, camera, self.params)
        self._baseline: Baseline | None = None
        if method == "paper":
            self._baseline = Baseline(self.pads[0], camera, self.params)

    def with_params(self, params: DetectorParams) -> Detector:
        """The same detector under other parameters; what it knows of its pads is shared."""
        other = copy.copy(self)
        other.params, other._dense = params, self._dense.with_params(params)
        if self._baseline is not None:
            other._baseline = self._baseline.with_params(params)
        return other

    @property
    def pad(self) -> Pad:
        """The pad; of several the first one given."""
        return self.pads[0]

    def detect(
        self,
        frame: Image | YuvFrame,
        *,
        trace: bool = False,
        reasons: bool = False,
        memo: Memo | None = None,
    ) -> Detection:
        """Find the pad in one still; of several pads that are in view, the first one found.

        The search ends there, where that pose can be used as a whole.

        Parameters
        ----------
        frame : (H, W, 3) uint8, BGR, or YuvFrame
        trace : bool
            Keep every stage's output in the result.
        reasons : bool
            Look again at what is wrong (`padstudio.vision.reasons`): all reasons of a failure, and
            warnings of a pose. Takes several times as long.
        memo : Memo or None
            Of earlier calls with this very frame object, by detectors of the same pads and camera:
            stages that the parameters' change does not reach are not run again.

        Returns
        -------
        Detection
            ``.pose`` is None where ``.failure`` says why.

        Raises
        ------
        ImageError
            If the picture is not (H, W, 3) uint8.
        CameraMismatchError
            If the frame's aspect is not the camera's.
        """
        recorder = Recorder(keep=trace, memo=memo, in_full=reasons)
        return self._still(frame, recorder, one_suffices=True)[0]

    def detect_all(
        self,
        frame: Image | YuvFrame,
        *,
        trace: bool = False,
        reasons: bool = False,
        memo: Memo | None = None,
    ) -> list[Detection]:
        """Find every one of the pads in one still.

        One search serves all pads. Of copies of a pad one is read.

        Parameters
        ----------
        frame : (H, W, 3) uint8, BGR, or YuvFrame
        trace : bool
            Keep every stage's output in the results, of all pads together.
        reasons : bool
            As `detect`.
        memo : Memo or None
            As of `detect`.

        Returns
        -------
        list of Detection
            One for each pad that was found, each with its ``pad_id``: first those whose quality is
            ``full``, and of these the least likely by chance. Where none was found, the failure
            alone. Times are those of the whole search.

        Raises
        ------
        ImageError, CameraMismatchError
            As `detect`.
        """
        recorder = Recorder(keep=trace, memo=memo, in_full=reasons)
        return self._still(frame, recorder, one_suffices=False)

    def _still(
        self, frame: Image | YuvFrame, recorder: Recorder, *, one_suffices: bool
    ) -> list[Detection]:
        _check(frame)
        if recorder.memo is not None:
            recorder.memo.begin()
        bgr = frame.bgr if isinstance(frame, YuvFrame) else frame
        if self._baseline is None:
            found = self._dense.detect(bgr, recorder, one_suffices=one_suffices)
        else:
            single = self._baseline.detect(bgr, recorder)
            found = [replace(single, pad_id=self._dense.known[0].id) if single.ok else single]
        elapsed = recorder.elapsed_ms()
        if recorder.in_full:
            found = look_again(self._dense, bgr, found, by_paper=self._baseline is not None)
        return [_finish(detection, frame, recorder, elapsed) for detection in found]

    def track(
        self,
        frames: Iterable[Image | YuvFrame],
        *,
        times_s: Iterable[float | None] | None = None,
        fuse: bool = True,
        smooth: bool = False,
        trace: bool | Container[int] = False,
    ) -> Iterator[Detection]:
        """Find the pad in a video's frames; the last pose helps the next.

        The cells are compared with the pad in every frame, so a lock that slips is noticed, and
        the frame is then looked at as a still. The paper's method looks at every frame so.

        Poses are fused over time, each by its own covariance
        (`padstudio.vision.fusion.pose_filter`). What a frame alone says stays in ``.single``, and
        a frame without a pose gets none. Of several pads one is followed until it is lost, and
        then whichever is found; as their poses are in frames of their own, each is fused by itself.

        Parameters
        ----------
        frames : iterable of (H, W, 3) uint8, BGR, or YuvFrame
        times_s : iterable of float or None, optional
            When each was taken. Without times, or after one that is None, frames are taken to
            follow each other thirty times a second.
        fuse : bool
            False gives every frame's own pose.
        smooth : bool
            Fuse with later frames, too: for recordings, as detections then come five to ten
            seconds of frames late.
        trace : bool or container of int
            Keep every stage's output in the result; of all frames, or of those at these places.
        """
        found = self._follow(frames, trace)
        if not (fuse or smooth):
            return found
        return fused_detections(found, times_s, smooth=smooth)

    def _follow(
        self, frames: Iterable[Image | YuvFrame], traced: bool | Container[int]
    ) -> Iterator[Detection]:
        """Each frame's own detection."""
        tracker = Tracker()
        for place, frame in enumerate(frames):
            trace = traced if isinstance(traced, bool) else place in traced
            detection = self.next_in_video(frame, self._expectation(tracker), trace=trace)
            tracker.learn(detection)
            yield detection

    def _expectation(self, tracker: Tracker) -> Expectation | None:
        return tracker.expect() if self._baseline is None else None

    def next_in_video(
        self, frame: Image | YuvFrame, expected: Expectation | None, *, trace: bool = False
    ) -> Detection:
        """A frame's own detection, as `track` makes it.

        Parameters
        ----------
        frame : (H, W, 3) uint8, BGR, or YuvFrame
        expected : Expectation or None
            As `expect_after` gives.
        trace : bool
            Keep every stage's output.
        """
        if expected is not None:
            detection = self.look_near(frame, expected, trace=trace)
            if detection.ok:
                return detection
        return self.detect(frame, trace=trace)

    def look_near(
        self,
        frame: Image | YuvFrame,
        expected: Expectation,
        *,
        reach: float = math.inf,
        trace: bool = False,
    ) -> Detection:
        """Find the pad near where it is expected, by the dense method.

        Parameters
        ----------
        frame : (H, W, 3) uint8, BGR, or YuvFrame
        expected : Expectation
        reach : float
            Expectations that may be off by about so much, as of `Expectation.miss`, are first
            brought nearer by correlation, and poses that lie farther off are none.
        trace : bool
            Keep every stage's output.

        Raises
        ------
        ImageError, CameraMismatchError
            As `detect`.
        """
        _check(frame)
        recorder = Recorder(keep=trace)
        found = self._dense.follow(frame, expected, recorder, reach)
        return _finish(found, frame, recorder, recorder.elapsed_ms())

    def expect_after(self, frames: Iterable[Image | YuvFrame]) -> Expectation | None:
        """Follow the pad through frames, and say what the next one should show.

        None where nothing leads up to it.
        """
        tracker = Tracker()
        for frame in frames:
            tracker.learn(self.next_in_video(frame, self._expectation(tracker)))
        return self._expectation(tracker)


def check_pads(pads: Sequence[Pad], method: Method) -> None:
    """Refuse pads that no detector takes together; costs nothing beside making one.

    Raises
    ------
    SpecError
        As `Detector`.
    """
    check_apart(pads)
    if method == "paper" and len(pads) > 1:
        raise SpecError(
            f"the paper's method reads one pad, not {len(pads)}; choose one, or the dense method",
            code="several_pads",
        )


def _check(frame: Image | YuvFrame) -> None:
    shape = frame.shape
    dtype = frame.y.dtype if isinstance(frame, YuvFrame) else frame.dtype
    if len(shape) != 3 or shape[2] != 3 or dtype != np.uint8 or min(shape[:2]) < 16:
        raise ImageError(
            f"a frame must be (H, W, 3) uint8 of at least 16 x 16 pixels, not {shape} {dtype}"
        )


def _finish(
    detection: Detection,
    frame: Image | YuvFrame,
    recorder: Recorder,
    elapsed_ms: Mapping[str, float],
) -> Detection:
    trace = None
    if recorder.keep:
        trace = recorder.trace(frame.bgr if isinstance(frame, YuvFrame) else frame)
    failed_at = {} if detection.ok else recorder.failed_at
    height, width = frame.shape[:2]
    return replace(
        detection,
        failed_at=failed_at,
        frame_px=(width, height),
        elapsed_ms=elapsed_ms,
        trace=trace,
    )
