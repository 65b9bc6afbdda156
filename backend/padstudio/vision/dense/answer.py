"""What the caller gets of a refined pose: a detection that tells how sure it is, or why none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from padstudio.geometry.curvature import with_curvature
from padstudio.geometry.planar_pnp import ambiguity
from padstudio.pad.spec import Layer
from padstudio.vision.cells.evidence import Evidence
from padstudio.vision.cells.layer_read import LayerRead, judge_together
from padstudio.vision.dense.whole_pad import WholeSign
from padstudio.vision.pose.covariance import with_picture_shift
from padstudio.vision.pose.least_squares import Fit
from padstudio.vision.refine.refiner import most_residual_px
from padstudio.vision.refine.results import RefinedPose
from padstudio.vision.stage.detection import Detection, Uncertainty
from padstudio.vision.stage.params import RefineParams
from padstudio.vision.stage.trace import Reason, StageFailure


def unfit(refined: RefinedPose | None, params: RefineParams) -> StageFailure | None:
    """Why no pose may be given, or None where borders lie where the pose puts them."""
    if refined is None:
        detail = "no layer's borders stand where the first pose puts them"
        return StageFailure("pose", Reason.POSE_REJECTED, detail)
    residual, cell = refined.fit.rms_px, refined.cell_px
    if residual > most_residual_px(cell, params):
        detail = f"borders lie {residual:.1f} px off, with cells of {cell:.1f} px"
        return StageFailure("pose", Reason.POSE_REJECTED, detail)
    return None


def of_whole_sign(found: WholeSign, focal_px: float) -> Detection:
    """The detection of a sign that was matched as a whole."""
    fit, evidence = found.fit, found.read.evidence
    return Detection(
        pose=fit.pose.pose,
        layer="outline",
        cells_read=evidence.read,
        cells_wrong=evidence.wrong,
        log10_false_alarm=evidence.log10_false_alarm,
        reprojection_px=fit.rms_px,
        uncertainty=uncertainty_of(fit, focal_px),
    )


def uncertainty_of(fit: Fit, focal_px: float) -> Uncertainty:
    """How sure a fitted pose is, seen by a camera of some focal length."""
    covariance = with_picture_shift(fit.covariance, focal_px)
    pose = fit.pose.pose
    return Uncertainty.of(pose, with_curvature(covariance, pose))


def of_refined(refined: RefinedPose, choice: Choice) -> Detection:
    """The detection of a refined pose and the layer it rests on."""
    fit, evidence = refined.fit, choice.evidence
    return Detection(
        pose=fit.pose.pose,
        layer=choice.read.layer.channel,
        cells_read=evidence.read,
        cells_wrong=evidence.wrong,
        log10_false_alarm=evidence.log10_false_alarm,
        reprojection_px=fit.rms_px,
        uncertainty=uncertainty_of(fit, refined.camera.focal_px),
        ambiguity=_ambiguity(refined),
        shift_mm=fit.pose.shift_mm,
        turn_rad=fit.pose.rotvec,
        shaking=fit.shaking,
        flatness_mm=refined.flatness_mm,
    )


def _ambiguity(refined: RefinedPose) -> float:
    points = refined.borders.points_mm
    x, y = points[:, 0], points[:, 1]
    ends = (x.min(), x.max()), (y.min(), y.max())
    corners = np.array([[x, y, 0.0] for x in ends[0] for y in ends[1]])
    sigma_px = refined.fit.rms_px / np.sqrt(max(len(points), 1))
    sigma = float(sigma_px) / refined.camera.focal_px
    return ambiguity(refined.fit.pose.pose, corners, sigma)


@dataclass(frozen=True, eq=False)
class Choice:
    """The layer that the result rests on.

    Attributes
    ----------
    read : LayerRead
        The chosen layer's cells.
    evidence : Evidence
        Of that layer's cells, or of all layers' together.
    reads : tuple of LayerRead
        All layers that lie in view.
    """

    read: LayerRead
    evidence: Evidence
    reads: tuple[LayerRead, ...]


def choose(
    reads: list[LayerRead], fitted: Layer, log10_false_alarm: float
) -> Choice | StageFailure:
    """The fitted layer where its cells suffice, else the one with the best evidence.

    Where none suffices alone, the cells of all layers count together.

    Parameters
    ----------
    reads : list of LayerRead
        Layers read with the final pose.
    fitted : Layer
        The finest layer whose borders the pose rests on.
    log10_false_alarm : float
        The bound that evidence must keep.
    """
    if not reads:
        return StageFailure("choose", Reason.TOO_FEW_CELLS, "no cell of the pad lies in view")
    good = [read for read in reads if read.evidence.suffices(log10_false_alarm)]
    best = min(good or reads, key=lambda read: read.evidence.log10_false_alarm)
    if not good:
        together = judge_together(reads)
        if together.suffices(log10_false_alarm):
            return Choice(best, together, tuple(reads))
        return StageFailure(
            "choose",
            Reason.UNKNOWN_CODE,
            f"with the refined pose {best.wrong_cells} differ from the pad "
            f"({best.evidence.compared_with(log10_false_alarm)})",
        )
    chosen = next((read for read in good if read.layer is fitted), best)
    return Choice(chosen, chosen.evidence, tuple(reads))
