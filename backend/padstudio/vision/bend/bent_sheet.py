"""Is the sheet bent? A test that costs next to nothing, and the pose where it says so.

Neighbouring borders of a bent sheet are off by alike heights, those of a flat one by noise. So the
mean product of neighbours' residuals, each counted positive where it lies as if higher, tells
whether heights are worth a fit (as of von Neumann's ratio); the odds of the fit then decide. What
is smooth along the sheet may also be a shaking camera or a print of many sheets: a sheet counts as
bent only where its heights take away what neighbours have in common.

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
from padstudio.pad.spec import Layer
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
from padstudio.vision.pose.edge_points import EdgePoints, find_edge_points
from padstudio.vision.pose.edge_points_kernel import Borders
from padstudio.vision.pose.least_squares import Fit, bounds_of
from padstudio.vision.pose.pose_posterior import Explained
from padstudio.vision.pose.refiner import Refiner
from padstudio.vision.pose.results import RefinedPose

# Neighbours that agree by so many standard deviations make heights worth a fit; flat sheets do so
# in one frame of eight, and are then told by the odds.
_WORTH = 2.5
# What lens and compression leave over smoothly is no bend, pixels.
_LEAST_COMMON_PX = 0.015
# Of what neighbours have in common heights may leave this share, or as little as a flat sheet has.
# Sheets of a tiled print leave half and more.
_MOST_LEFT, _LITTLE_PX, _CHANCE = 0.4, 0.035, 2.5
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


def flattened(refiner: Refiner, refined: RefinedPose) -> RefinedPose:
    """The pose relative to the plane that fits a bent sheet best; unchanged where it is flat.

    Parameters
    ----------
    refiner : Refiner
    refined : RefinedPose
        Of a still, borne out by its cells.
    """
    telling, pose = _telling(refiner, refined), refined.fit.pose
    if telling is None or len(telling.edge_points.xy) < _LEAST:
        return refined
    rows, seen = linearized(telling.edge_points, refiner.camera, pose, None)
    before = common_px(rows[:, 0].copy(), -rows[:, 3], seen.weight)
    if not (before.deviations > _WORTH and before.px > _LEAST_COMMON_PX):
        return refined
    # Rows that were seen from different places pass for heights; the better explanation counts.
    found = _bent(refiner, telling, pose, max(_LEAST_ODDS, refined.fit.shaking))
    if found is None:
        return refined
    fit, edge_points = found
    equations = Equations.of(edge_points, refiner.camera, fit)
    after = common_px(equations.residual, equations.moves[:, 2], edge_points.weight)
    if not (after.is_nothing or after.is_less(before)):
        return refined
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
    refiner: Refiner, telling: _Telling, pose: MovingPose, least_odds: float
) -> tuple[BentFit, EdgePoints] | None:
    """Pose and sheet, and the borders found where they put them; None where a flat sheet does."""
    camera, few = refiner.camera, telling.edge_points.thinned(_TELLING)
    fit, log_odds = first_bent(few, camera, pose.pose, max(refiner.pad.size_mm))
    if log_odds < least_odds:
        return None
    for _ in range(_ROUNDS):
        edge_points = _measured(refiner, telling, fit)
        if len(edge_points.xy) < _LEAST:
            return None
        fit = fit_bent(edge_points, camera, fit, 2)
        fit = replace(fit, amplitude_mm=amplitude_of(edge_points, camera, fit))
    return fit, edge_points


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

    @property
    def is_nothing(self) -> bool:
        """True where a flat sheet has as much."""
        return self.px <= _LITTLE_PX or self.deviations <= _CHANCE

    def is_less(self, before: Common) -> bool:
        """True where little of what there was before is left, in size and in clearness."""
        little = self.px <= _MOST_LEFT * before.px
        return little and self.deviations <= _MOST_LEFT * before.deviations


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
