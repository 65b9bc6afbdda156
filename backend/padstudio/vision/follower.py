"""Follows a pad through frames as they come: some are dropped, and at times none come.

Unlike `Detector.track`, which takes frames for evenly spaced, it predicts by time. What it gives
rests on the frame at hand: where that does not bear the pad out, there is no pose, however well
one was expected.
"""

from __future__ import annotations

from dataclasses import replace

from padstudio.arrays import Image, YuvFrame
from padstudio.pad.identity import pad_id
from padstudio.vision.dense.tracker import STEP_S, Expectation, Tracker
from padstudio.vision.detector import Detector
from padstudio.vision.fusion.detections import measured, with_fused
from padstudio.vision.fusion.pose_filter import PoseFilter
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Reason, StageFailure

# Borders of cells are found from poses that are off by less than this, in cells of the coarsest
# layer. Beyond, parts of a pad may be taken for their neighbours.
_REACH = 0.4
#: A pad that was not seen for longer is looked for all over the frame.
LONGEST_GAP_S = 1.0


class Follower:
    """Takes frames in the order of time; gives each one's pose, fused with those before it.

    Parameters
    ----------
    detector : Detector
        Paper is taken for flat, as in all frames that are followed.
    """

    def __init__(self, detector: Detector) -> None:
        flat = replace(detector.params.refine, bend=False)
        self._detector = detector.with_params(replace(detector.params, refine=flat))
        self._coarsest_mm: dict[str | None, float] = {
            pad_id(pad): max(layer.cell_mm for layer in pad.layers) for pad in detector.pads
        }
        self.forget()

    def forget(self) -> None:
        """Begin anew: the times of further frames are on another clock."""
        self._tracker = Tracker(LONGEST_GAP_S / STEP_S)
        self._filter = PoseFilter()
        self._pad_id: str | None = None

    def take(self, frame: Image | YuvFrame, time_s: float) -> Detection:
        """What a frame shows.

        Parameters
        ----------
        frame : (H, W, 3) uint8, BGR, or YuvFrame
        time_s : float
            When it was taken; must rise from frame to frame.

        Returns
        -------
        Detection
            Its pose is ``filtered``. A frame in which the pad was followed, to a pose that
            contradicts those before it, has none.

        Raises
        ------
        ImageError, CameraMismatchError
            As `padstudio.vision.detector.Detector.detect`.
        """
        own, is_followed = self._own(frame, self._tracker.expect(time_s / STEP_S))
        found = self._fused(own, time_s, is_followed)
        # Fused poses are surer of where the camera stands aside, from which the fit of the next
        # frame begins.
        self._tracker.learn(found, time_s / STEP_S)
        return found

    def _own(self, frame: Image | YuvFrame, expected: Expectation | None) -> tuple[Detection, bool]:
        """What the frame alone shows, and whether it was found near its expected place."""
        # The paper's method looks at every frame as at a still.
        if expected is not None and self._detector.method == "dense":
            reach = _REACH * self._coarsest_mm[expected.pad_id] / expected.pose.pose.range_mm
            own = self._detector.look_near(frame, expected, reach=reach)
            if own.ok:
                return own, True
        return self._detector.detect(frame), False

    def _fused(self, own: Detection, time_s: float, is_followed: bool) -> Detection:
        measurement = measured(own, time_s)
        if measurement is None or not measurement.is_usable:
            return own
        if own.pad_id != self._pad_id:
            # Poses of another pad are in its own frame.
            self._filter, self._pad_id = PoseFilter(), own.pad_id
        fused = self._filter.step(measurement)
        if fused.is_outlier and not is_followed:
            # Looked for all over the frame, it was borne out more strictly than what came before.
            self._filter = PoseFilter()
            fused = self._filter.step(measurement)
        if fused.is_outlier:
            detail = "the pose of this frame contradicts those before it"
            failure = StageFailure("pose", Reason.POSE_REJECTED, detail)
            return Detection(None, failure, frame_px=own.frame_px, elapsed_ms=own.elapsed_ms)
        return with_fused(own, fused, "filtered")
