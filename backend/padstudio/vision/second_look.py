"""A second look at a frame, for who asks for reasons in full: what is to be doubted of a pose, and
whether another camera would explain a failure. It takes several times as long as a detection.
"""

from __future__ import annotations

from dataclasses import replace

from padstudio.arrays import Image
from padstudio.geometry.camera import Camera
from padstudio.vision.dense.method import Dense
from padstudio.vision.frame.diagnosis import examine
from padstudio.vision.reasons.clues import Clues
from padstudio.vision.reasons.doubts import doubts_of, seen_with
from padstudio.vision.reasons.other_cameras import other_cameras, wrong_camera
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Finding, Reason, Recorder, StageFailure

# What another camera may be behind: lines and lattices that are not found, poses that do not fit.
_UNEXPLAINED = frozenset(
    {
        Reason.NO_LATTICE,
        Reason.TOO_FEW_LINES,
        Reason.POSE_REJECTED,
        Reason.UNKNOWN_CODE,
        Reason.TOO_FEW_CELLS,
        Reason.NO_OUTLINE,
    }
)


def look_again(
    dense: Dense, bgr: Image, found: list[Detection], *, by_paper: bool
) -> list[Detection]:
    """Detections with what a second look says of them.

    Parameters
    ----------
    dense : Dense
        Of the same pads and camera.
    bgr : (H, W, 3) uint8
    found : list of Detection
        With reasons in full, as far as the dense method gave them.
    by_paper : bool
        They were found by the paper's method.
    """
    failure = found[0].failure
    if failure is None:
        return [replace(item, warnings=_doubts(dense, bgr, item)) for item in found]
    explained = (_by_dense if by_paper else _explained)(dense, bgr, failure)
    return [replace(found[0], failure=explained)]


def _by_dense(dense: Dense, bgr: Image, failure: StageFailure) -> StageFailure:
    """The paper's failure with the reasons that the dense method finds, or that it reads it."""
    other = dense.detect(bgr, Recorder(keep=False, in_full=True))[0].failure
    if other is None:
        return replace(failure, advice="use the method dense, which reads this frame")
    other = _explained(dense, bgr, other)
    return replace(other, stage=failure.stage, detail=f"{other.detail}; {failure.detail}")


def _explained(dense: Dense, bgr: Image, failure: StageFailure) -> StageFailure:
    """The failure, or that another camera reads the frame."""
    if failure.reason not in _UNEXPLAINED:
        return failure
    camera = dense.camera.for_frame(bgr.shape[1], bgr.shape[0])
    for other in other_cameras(camera):
        if _read(dense, other.camera, bgr).ok:
            finding = wrong_camera(f"the frame is read {other.words}")
            was = Finding(failure.reason, failure.detail, failure.advice)
            return StageFailure(
                failure.stage, finding.reason, f"{finding.detail}; {failure.detail}",
                finding.advice, (was, *failure.also),
            )  # fmt: skip
    return failure


def _doubts(dense: Dense, bgr: Image, detection: Detection) -> tuple[Finding, ...]:
    pad = next(known.pad for known in dense.known if known.id == detection.pad_id)
    frame = examine(bgr, pad, dense.camera, dense.params.prepare, Recorder(keep=False))
    refiner = Refiner(frame.pyramid, frame.camera, pad, dense.params, 1)
    return tuple(doubts_of(seen_with(refiner, detection), Clues(frame)))


def _read(dense: Dense, camera: Camera, bgr: Image) -> Detection:
    pads = [known.pad for known in dense.known]
    return Dense(pads, camera, dense.params).detect(bgr, Recorder(keep=False))[0]
