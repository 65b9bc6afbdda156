"""Is the sheet bent? A test that costs next to nothing, and the pose where it says so.

Neighbouring borders of a bent sheet are off by alike heights, those of a flat one by noise. So the
mean product of neighbours' residuals, each counted positive where it lies as if higher, is a test
(as of von Neumann's ratio). What is smooth along the sheet may also be a shaking camera or a print
of many sheets: a sheet counts as bent only where its heights take away what neighbours have in
common.

References
----------
Neumann, J. von (1941). Distribution of the ratio of the mean square successive difference to the
variance. doi:10.1214/aoms/1177731677.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.bend.bent_fit import (
    BentFit,
    Equations,
    amplitude_of,
    bent_covariance,
    first_bent,
    fit_bent,
    linearized,
)
from padstudio.vision.pose import edge_points_kernel, least_squares_kernel
from padstudio.vision.pose.edge_points import EdgePoints
from padstudio.vision.pose.least_squares import Fit, bounds_of
from padstudio.vision.pose.refiner import Refiner
from padstudio.vision.pose.results import RefinedPose

# Neighbours agree beyond doubt at so many standard deviations: by chance once in three million.
_SURE = 5.0
# What lens and compression leave over smoothly is no bend, pixels.
_LEAST_COMMON_PX = 0.02
# Of what neighbours have in common heights may leave this share, or as little as a flat sheet has.
_MOST_LEFT, _LITTLE_PX = 0.3, 0.035
# So many borders tell a bend; fewer than the least leave no room for heights.
_TELLING, _LEAST = 1200, 150
# Log odds that the heights need.
_LEAST_ODDS = 20.0
# Borders are measured anew so often where the sheet puts them.
_ROUNDS = 2


def flattened(refiner: Refiner, refined: RefinedPose) -> RefinedPose:
    """The pose relative to the plane that fits a bent sheet best; unchanged where it is flat.

    Parameters
    ----------
    refiner : Refiner
    refined : RefinedPose
        Of a still, borne out by its cells.
    """
    edge_points, camera = refined.edge_points, refined.camera
    if edge_points is None or len(edge_points.xy) < _LEAST:
        return refined
    rows, seen = linearized(edge_points, camera, refined.fit.pose, None)
    before = common_px(rows[:, 0].copy(), -rows[:, 3], seen.weight)
    if not (before.deviations > _SURE and before.px > _LEAST_COMMON_PX):
        return refined
    pose, pad_mm = refined.fit.pose.pose, max(refiner.pad.size_mm)
    fit, log_odds = first_bent(edge_points.thinned(_TELLING), camera, pose, pad_mm)
    if log_odds < _LEAST_ODDS:
        return refined
    for _ in range(_ROUNDS):
        edge_points = _measured(refiner, refined, fit)
        if len(edge_points.xy) < _LEAST:
            return refined
        fit = fit_bent(edge_points, camera, fit, 2)
        fit = replace(fit, amplitude_mm=amplitude_of(edge_points, camera, fit))
    equations = Equations.of(edge_points, camera, fit)
    after = common_px(equations.residual, equations.moves[:, 2], edge_points.weight)
    if after.px > max(_MOST_LEFT * before.px, _LITTLE_PX):
        return refined
    return _answer(refiner, refined, edge_points, fit)


@dataclass(frozen=True)
class Common:
    """What residuals of neighbours have in common.

    Attributes
    ----------
    px : float
        Root of their mean product; negative where they rather differ.
    deviations : float
        The same in standard deviations of what independent residuals would give.
    """

    px: float
    deviations: float


def common_px(residual: Array, rise: Array, weight: Array) -> Common:
    """What neighbours in a list of borders have in common, as heights.

    Parameters
    ----------
    residual : (N,) float64
        Pixels, of borders in the order of `padstudio.vision.pose.edge_points_kernel`: along rows.
    rise : (N,) float64
        Pixels a mm of height.
    weight : (N,) float64
    """
    sigma = least_squares_kernel.scatter(residual, weight)
    trust = least_squares_kernel.trust_of(residual, weight, sigma) * sigma**2
    higher = residual * np.sign(rise)
    pair, product = trust[1:] * trust[:-1], higher[1:] * higher[:-1]
    total = float((pair * product).sum())
    mean = total / max(float(pair.sum()), 1e-12)
    chance = float(np.sqrt(((pair * product) ** 2).sum()))
    return Common(float(np.copysign(np.sqrt(abs(mean)), mean)), total / max(chance, 1e-12))


def _measured(refiner: Refiner, refined: RefinedPose, fit: BentFit) -> EdgePoints:
    """Borders measured where the bent sheet puts them, with their places on the flat pad."""
    borders = refined.borders
    window = refiner.window(refined.layer, refined.cell_px, sharper=1)
    laid = borders._replace(points_mm=fit.sheet.laid(borders.points_mm))
    projector = fit.pose.projector(refined.camera)
    which, xy, weight, blur_px2 = edge_points_kernel.find_borders(
        laid, projector, window, refiner.params.refine.reach_px
    )
    return EdgePoints(borders.take(which), xy, weight, blur_px2, window.pixel)


def _answer(
    refiner: Refiner, refined: RefinedPose, edge_points: EdgePoints, fit: BentFit
) -> RefinedPose:
    camera, sheet, points = refined.camera, fit.sheet, refined.borders.points_mm
    equations = Equations.of(edge_points, camera, fit)
    inliers = np.abs(equations.residual) < 4 * equations.sigma
    trust = edge_points.weight[inliers]
    rms = float(np.sqrt((trust * equations.residual[inliers] ** 2).sum() / trust.sum()))
    pose = MovingPose(sheet.relative(fit.pose.pose, points))
    bounds = bounds_of(fit.pose, refiner.model(moving=False), edge_points.pixel)

    def explain() -> tuple[MovingPose, Array]:
        return pose, bent_covariance(edge_points, camera, fit, bounds)

    # Heights about the expected plane need not be level where only some of the sheet is seen.
    answer = Fit(pose, rms, inliers, explain, doubt=fit.pose.step_to(pose))
    return replace(
        refined, fit=answer, edge_points=edge_points, flatness_mm=sheet.flatness_mm(points)
    )
