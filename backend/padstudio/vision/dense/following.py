"""Finding a pad near where it is expected; `padstudio.vision.dense.tracker` says where that is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from padstudio.vision.dense.judge import judge
from padstudio.vision.dense.relocate import relocate
from padstudio.vision.dense.starts import refine_best
from padstudio.vision.dense.tracker import Expectation, picture_miss
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Reason, Recorder, StageFailure

# Expectations that may be off by this share of the reach of borders are brought nearer first.
_UNSURE = 0.75
# Layers with cells of this width and number must agree.
_READABLE_PX, _ENOUGH = 5.0, 30


def look_near(
    refiner: Refiner, expected: Expectation, recorder: Recorder, reach: float
) -> Detection:
    """Find the refiner's pad near its expected pose; fails where the picture denies it.

    A near miss must not pass for a lock, so every layer that can be read has to agree. Where the
    frame before did not bear the pad out, or the expectation may be off by about ``reach``, this
    one must as a still has to.

    Parameters
    ----------
    refiner : Refiner
    expected : Expectation
    recorder : Recorder
    reach : float
        Poses that lie farther off than this, as of `Expectation.miss`, are none.
    """
    if expected.miss > _UNSURE * reach:
        there = recorder.run("pose", None, relocate, refiner, expected.pose)
        if there is None:
            return _nowhere("the frame does not show what was expected of it")
        expected = replace(expected, pose=there, miss=reach, is_fresh=False)
    if not expected.is_fresh:
        params = refiner.params
        strict = replace(params.refine, log10_followed=params.log10_false_alarm)
        refiner = replace(refiner, params=replace(params, refine=strict))
    return _fit(refiner, expected, recorder, reach)


def _fit(refiner: Refiner, expected: Expectation, recorder: Recorder, reach: float) -> Detection:
    """The pose that borders near the expected ones lead to."""
    miss_px = expected.miss * refiner.camera.focal_px
    refined = recorder.run("pose", None, refiner.follow, expected.pose, miss_px)
    if refined is None:
        refined = recorder.run("pose", None, refine_best, refiner, [expected.pose], np.inf)
    detection, reads = judge(refiner, refined, recorder)
    for read in reads:
        readable = read.cells.cell_px >= _READABLE_PX and read.evidence.read >= _ENOUGH
        if detection.ok and readable and not read.evidence.suffices(0.0):
            return _nowhere(f"near the last pose {read.wrong_cells} differ from the pad")
    if detection.pose is not None and picture_miss(expected.pose.pose, detection.pose) >= reach:
        return _nowhere("borders led away from where the pad was expected")
    return detection


def _nowhere(detail: str) -> Detection:
    return Detection(None, StageFailure("pose", Reason.POSE_REJECTED, detail))
