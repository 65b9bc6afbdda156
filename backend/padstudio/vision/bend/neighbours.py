"""What residuals of neighbouring borders have in common: what is smooth along the print.

References
----------
Neumann, J. von (1941). Distribution of the ratio of the mean square successive difference to the
variance. doi:10.1214/aoms/1177731677.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.vision.pose import least_squares_kernel
from padstudio.vision.pose.edge_points_kernel import Borders
from padstudio.vision.pose.least_squares_kernel import Sightings

# Of what neighbours have in common an explanation may leave this share, or as little as a flat
# sheet has.
_MOST_LEFT, _LITTLE_PX, _CHANCE = 0.4, 0.035, 2.5
# Parts that lie off their places have more in common than this, pixels; and of that a shaking's
# rows leave more than such a share: of vibrating frames 0.07 at the most, of sheets 0.34.
_LEAST_PX, _MOST_BY_ROWS = 0.05, 0.2
# A shaking is smooth over so many intervals of what was measured.
_INTERVALS = 24


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


def parts_show(rows: Array, seen: Sightings, borders: Borders) -> bool:
    """True where neighbours are off alike along the pad, and rows of the frame do not tell why.

    Parameters
    ----------
    rows : (N, 7) float64
        As of `padstudio.vision.pose.least_squares_kernel.linearize`, pixels.
    seen : Sightings
    borders : Borders
    """
    aside = np.where(borders.across_mm[:, 0] != 0, rows[:, 1], rows[:, 2])
    residual = rows[:, 0].copy()
    before = common_px(residual, aside, seen.weight)
    if before.px < _LEAST_PX or before.deviations < _CHANCE:
        return False
    sigma = least_squares_kernel.scatter(residual, seen.weight)
    trust = least_squares_kernel.trust_of(residual, seen.weight, sigma)
    after = common_px(_left_by_rows(rows, seen.row_time, trust), aside, seen.weight)
    return after.px > _MOST_BY_ROWS * before.px and after.deviations > _CHANCE


def _left_by_rows(rows: Array, row_time: Array, trust: Array) -> Array:
    """What a shaking while the shutter rolled leaves of residuals, (N,) pixels.

    A rotation about each of the camera's axes at the ends of intervals of rows, between which they
    go straight, by least squares.

    Parameters
    ----------
    rows : (N, 7) float64
        As of `padstudio.vision.pose.least_squares_kernel.linearize`, pixels.
    row_time, trust : (N,) float64
    """
    first, last = float(row_time.min()), float(row_time.max())
    at = (row_time - first) / max(last - first, 1e-9) * _INTERVALS
    begin = np.minimum(at.astype(int), _INTERVALS - 1)
    design = np.zeros((len(at), _INTERVALS + 1, 3))
    every = np.arange(len(at))
    design[every, begin] = (1 - (at - begin))[:, None] * rows[:, 4:]
    design[every, begin + 1] = (at - begin)[:, None] * rows[:, 4:]
    design = np.hstack([design.reshape(len(at), -1), rows[:, 1:4]])
    weighted = design * trust[:, None]
    normal = weighted.T @ design
    normal[np.diag_indices_from(normal)] *= 1 + 1e-6
    normal[np.diag_indices_from(normal)] += 1e-12 * np.trace(normal)
    found = np.linalg.solve(normal, weighted.T @ rows[:, 0])
    return np.asarray(rows[:, 0] - design @ found)
