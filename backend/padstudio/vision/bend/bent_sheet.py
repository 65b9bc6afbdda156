"""Is the sheet bent? A test that costs next to nothing, and the pose where it says so.

Neighbouring borders of a bent sheet are off by alike heights, those of a flat one by noise. So the
mean product of neighbours' residuals, each counted positive where it lies as if higher, tells
whether heights are worth a fit (as of von Neumann's ratio); the odds of the fit then decide. What
is smooth along the sheet may also be a shaking camera or a print of many sheets: a sheet counts as
bent only where its heights take away what neighbours have in common.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Layer
from padstudio.vision.bend.bent_fit import (
    SHORT,
    USUAL,
    BentFit,
    Equations,
    Lengths,
    amplitude_of,
    bent_covariance,
    first_bent,
    fit_bent,
    linearized,
)
from padstudio.vision.bend.loose_parts import fit_parts
from padstudio.vision.bend.neighbours import Common, common_px, parts_show
from padstudio.vision.pose import edge_points_kernel
from padstudio.vision.pose.edge_points import EdgePoints, find_edge_points
from padstudio.vision.pose.edge_points_kernel import Borders
from padstudio.vision.pose.least_squares import Fit, bounds_of
from padstudio.vision.pose.pose_posterior import Explained
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.refine.results import RefinedPose

# Neighbours that agree by so many standard deviations make heights worth a fit; flat sheets do so
# in one frame of eight, and are then told by the odds.
_WORTH = 2.5
# Of what neighbours have in common short bends leave less than this share: those of paper left
# 0.12, those fitted to sheets 0.24 and more.
_CLEARLY = 0.16
# What lens and compression leave over smoothly is no bend, pixels.
_LEAST_COMMON_PX = 0.015
# So many borders tell a bend; fewer than the least leave no room for heights.
_TELLING, _LEAST = 1200, 150
# Natural logarithm of the odds that heights need. Sixty flat sheets had no more than 1.6.
_LEAST_ODDS = 10.0
# Borders are measured anew so often where the sheet puts them.
_ROUNDS = 2


@dataclass(frozen=True, eq=False)
class _Telling:
    """Borders that would show a bend.

    Attributes
    ----------
    layer : Layer
    cell_px : float
        Median width of its cells, frame pixels.
    borders : Borders
        Those in view.
    edge_points : EdgePoints
        Those that were found where the flat pose puts them.
    """

    layer: Layer
    cell_px: float
    borders: Borders
    edge_points: EdgePoints


def as_it_lies(refiner: Refiner, refined: RefinedPose) -> RefinedPose:
    """The pose of a print that is bent or whose parts lie off their places; a flat one's is kept.

    Parameters
    ----------
    refiner : Refiner
    refined : RefinedPose
        Of a still, borne out by its cells.

    Returns
    -------
    RefinedPose
        Relative to the plane that fits the print best in view.
    """
    telling, pose = _telling(refiner, refined), refined.fit.pose
    if telling is None or len(telling.edge_points.xy) < _LEAST:
        return refined
    rows, seen = linearized(telling.edge_points, refiner.camera, pose, None)
    lifted = common_px(rows[:, 0].copy(), -rows[:, 3], seen.weight)
    may_be_bent = lifted.deviations > _WORTH and lifted.px > _LEAST_COMMON_PX
    bent = _flattened(refiner, refined, telling, lifted) if may_be_bent else None
    if bent is not None or not parts_show(rows, seen, telling.edge_points.borders):
        return bent or refined
    bent = _flattened(refiner, refined, telling, lifted, short=True) if may_be_bent else None
    if bent is not None:
        return bent
    fit = fit_parts(refiner, pose)
    return refined if fit is None else replace(refined, fit=fit)


def _flattened(
    refiner: Refiner,
    refined: RefinedPose,
    telling: _Telling,
    before: Common,
    *,
    short: bool = False,
) -> RefinedPose | None:
    """The pose of a bent sheet; None where heights leave what neighbours have in common."""
    # Rows that were seen from different places pass for heights; the better explanation counts.
    least_odds = max(_LEAST_ODDS, refined.fit.shaking)
    found = _bent(refiner, telling, refined.fit.pose, least_odds, SHORT if short else USUAL)
    if found is None:
        return None
    fit, edge_points = found
    equations = Equations.of(edge_points, refiner.camera, fit)
    after = common_px(equations.residual, equations.moves[:, 2], edge_points.weight)
    # Short bends can take any form, also that of sheets side by side, but for a little more.
    fits = after.px < _CLEARLY * before.px if short else after.is_nothing or after.is_less(before)
    if not fits:
        return None
    points = telling.borders.points_mm
    answer = _answer(refiner, edge_points, fit, points)
    return replace(refined, fit=answer, flatness_mm=fit.sheet.flatness_mm(points))


def _telling(refiner: Refiner, refined: RefinedPose) -> _Telling | None:
    """The borders of the pose; or of larger cells where it rests on the pattern as a whole."""
    if refined.edge_points is not None:
        return _Telling(refined.layer, refined.cell_px, refined.borders, refined.edge_points)
    pose, camera, refine = refined.fit.pose, refiner.camera, refiner.params.refine
    for layer in sorted(refiner.pad.layers, key=lambda item: item.cell_mm):
        readable = refiner.readable(layer, pose)
        if readable is not None and readable.cell_px >= refine.align_below_px:
            window = refiner.window(layer, readable.cell_px, sharper=1)
            borders = readable.borders
            found = find_edge_points(borders, window, camera, pose, refine.reach_px)
            return _Telling(layer, readable.cell_px, borders, found)
    return None


def _bent(
    refiner: Refiner,
    telling: _Telling,
    pose: MovingPose,
    least_odds: float,
    lengths: Lengths,
) -> tuple[BentFit, EdgePoints] | None:
    """Pose and sheet, and the borders found where they put them; None where a flat sheet does."""
    camera, few = refiner.camera, telling.edge_points.thinned(_TELLING)
    first = first_bent(few, camera, pose.pose, max(refiner.pad.size_mm), lengths)
    if first is None or first[1] < least_odds:
        return None
    fit = first[0]
    for _ in range(_ROUNDS):
        edge_points = _measured(refiner, telling, fit)
        if len(edge_points.xy) < _LEAST:
            return None
        fit = fit_bent(edge_points, camera, fit, 2)
        fit = replace(fit, amplitude_mm=amplitude_of(edge_points, camera, fit))
    return fit, edge_points


def _measured(refiner: Refiner, telling: _Telling, fit: BentFit) -> EdgePoints:
    """Borders measured where the bent sheet puts them, with their places on the flat pad."""
    borders = telling.borders
    window = refiner.window(telling.layer, telling.cell_px, sharper=1)
    laid = borders._replace(points_mm=fit.sheet.laid(borders.points_mm))
    projector = fit.pose.projector(refiner.camera)
    which, xy, weight, blur_px2 = edge_points_kernel.find_borders(
        laid, projector, window, refiner.params.refine.reach_px
    )
    return EdgePoints(borders.take(which), xy, weight, blur_px2, window.pixel)


def _answer(refiner: Refiner, edge_points: EdgePoints, fit: BentFit, points: Array) -> Fit:
    """The fit relative to the plane that fits the sheet best at points (N, 3)."""
    camera = refiner.camera
    equations = Equations.of(edge_points, camera, fit)
    inliers = np.abs(equations.residual) < 4 * equations.sigma
    trust = edge_points.weight[inliers]
    rms = float(np.sqrt((trust * equations.residual[inliers] ** 2).sum() / trust.sum()))
    pose = MovingPose(fit.sheet.relative(fit.pose.pose, points))
    bounds = bounds_of(fit.pose, refiner.model(moving=False), edge_points.pixel)

    def explain() -> Explained:
        return Explained(pose, bent_covariance(edge_points, camera, fit, bounds))

    # Heights about the expected plane need not be level where only some of the sheet is seen.
    return Fit(pose, rms, inliers, explain, doubt=fit.pose.step_to(pose))
