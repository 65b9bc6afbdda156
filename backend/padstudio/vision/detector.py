"""The detector: the one object that callers use; it alone knows the methods and the tracking."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from padstudio.arrays import Image, YuvFrame
from padstudio.errors import ImageError, SpecError
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad
from padstudio.vision.baseline.method import Baseline
from padstudio.vision.dense.method import Dense
from padstudio.vision.dense.tracker import Tracker
from padstudio.vision.fusion.detections import fused_detections
from padstudio.vision.stage.detection import Detection, Method
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
        self.camera = camera
        self.method = method
        self.params = params or DetectorParams()
        self._dense = Dense(self.pads, camera, self.params)
        self._baseline: Baseline | None = None
        if method == "paper":
            _one(self.pads, "the paper's method reads")
            self._baseline = Baseline(self.pads[0], camera, self.params)

    @property
    def pad(self) -> Pad:
        """The pad; of several the first one given."""
        return self.pads[0]

    def detect(self, frame: Image | YuvFrame, *, trace: bool = False) -> Detection:
        """Find the pad in one still; of several pads that are in view, the one read best.

        Parameters
        ----------
        frame : (H, W, 3) uint8, BGR, or YuvFrame
        trace : bool
            Keep every stage's output in the result.

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
        return self.detect_all(frame, trace=trace)[0]

    def detect_all(self, frame: Image | YuvFrame, *, trace: bool = False) -> list[Detection]:
        """Find every one of the pads in one still.

        One search serves all pads. Of copies of a pad one is read.

        Parameters
        ----------
        frame : (H, W, 3) uint8, BGR, or YuvFrame
        trace : bool
            Keep every stage's output in the results, of all pads together.

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
        _check(frame)
        recorder = Recorder(keep=trace)
        bgr = frame.bgr if isinstance(frame, YuvFrame) else frame
        if self._baseline is None:
            found = self._dense.detect(bgr, recorder)
        else:
            single = self._baseline.detect(bgr, recorder)
            found = [replace(single, pad_id=self._dense.known[0].id) if single.ok else single]
        return [_finish(detection, frame, recorder) for detection in found]

    def track(
        self,
        frames: Iterable[Image | YuvFrame],
        *,
        times_s: Iterable[float | None] | None = None,
        fuse: bool = True,
        smooth: bool = False,
        trace: bool = False,
    ) -> Iterator[Detection]:
        """Find the pad in a video's frames; the last pose helps the next.

        The cells are compared with the pad in every frame, so a lock that slips is noticed, and
        the frame is then looked at as a still. The paper's method looks at every frame so.

        Poses are fused over time, each by its own covariance
        (`padstudio.vision.fusion.pose_filter`). What a frame alone says stays in ``.single``, and
        a frame without a pose gets none. Poses of several pads are in frames of their own, so that
        only one pad is followed.

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
        trace : bool
            Keep every stage's output in the result.

        Raises
        ------
        SpecError
            If the detector knows several pads.
        """
        _one(self.pads, "a video is followed by")
        found = self._follow(frames, trace)
        if not (fuse or smooth):
            return found
        return fused_detections(found, times_s, smooth=smooth)

    def _follow(self, frames: Iterable[Image | YuvFrame], trace: bool) -> Iterator[Detection]:
        """Each frame's own detection."""
        tracker = Tracker()
        for frame in frames:
            expected = tracker.expect() if self._baseline is None else None
            detection = None
            if expected is not None:
                _check(frame)
                recorder = Recorder(keep=trace)
                followed = self._dense.follow(frame, expected, recorder)
                detection = _finish(followed, frame, recorder)
            if detection is None or not detection.ok:
                detection = self.detect(frame, trace=trace)
            tracker.learn(detection)
            yield detection


def _one(pads: Sequence[Pad], what: str) -> None:
    if len(pads) > 1:
        raise SpecError(
            f"{what} one pad, not {len(pads)}; make a detector for each", code="several_pads"
        )


def _check(frame: Image | YuvFrame) -> None:
    shape = frame.shape
    dtype = frame.y.dtype if isinstance(frame, YuvFrame) else frame.dtype
    if len(shape) != 3 or shape[2] != 3 or dtype != np.uint8 or min(shape[:2]) < 16:
        raise ImageError(
            f"a frame must be (H, W, 3) uint8 of at least 16 x 16 pixels, not {shape} {dtype}"
        )


def _finish(detection: Detection, frame: Image | YuvFrame, recorder: Recorder) -> Detection:
    trace = None
    if recorder.keep:
        trace = recorder.trace(frame.bgr if isinstance(frame, YuvFrame) else frame)
    return replace(detection, elapsed_ms=recorder.elapsed_ms(), trace=trace)
