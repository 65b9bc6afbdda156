"""Prints whose parts lie off their places: sheets with gaps, turned, or in each other's place.

The print is divided into small squares, and each may be shifted: a linear model of random effects.
What is left within squares tells the pose, however they are shifted. Whether shifts are worth it,
and how large they are, is told by the marginal likelihood. Nothing is assumed of their cause.

References
----------
Laird, N. M. and Ware, J. H. (1982). Random-effects models for longitudinal data.
doi:10.2307/2529876. MacKay, D. J. C. (1992). Bayesian interpolation.
doi:10.1162/neco.1992.4.3.415.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.bend.parts_kernel import SHARED, PartSums, part_sums, without_shifts
from padstudio.vision.pose import least_squares_kernel
from padstudio.vision.pose.edge_points import EdgePoints
from padstudio.vision.pose.least_squares_kernel import Sightings
from padstudio.vision.pose.row_motion import MotionBounds, drift_priors
from padstudio.vision.pose.row_motion_kernel import solve_with_priors

# Standard deviations of shifts that are tried, mm.
_SHIFTS_MM = 2.0 ** np.arange(-5.0, 4.0)
# Shifts to begin with are nearly free, 1/mm².
_FREE = 1e-3
# Residuals within squares of a sheet are alike, too: they count by such a share.
_TEMPER = 0.25
# By such a share gaps and overlaps stretch a print.
_STRETCH = 0.01


class Squares(NamedTuple):
    """Squares of the pad's plane.

    Attributes
    ----------
    part : (N,) int
        The square that each of some points lies in.
    shape : (rows, columns)
    at : (P, 2) float64
        Their middles, mm.
    middle : (2,) float64
        Of the points.
    """

    part: NDArray[np.intp]
    shape: tuple[int, int]
    at: Array
    middle: Array

    @classmethod
    def over(cls, points_mm: Array, side_mm: float) -> Squares:
        """Those that hold points (N, 3)."""
        xy = points_mm[:, :2]
        low = xy.min(axis=0) - 1e-6
        index = ((xy - low) / side_mm).astype(np.intp)
        columns, rows = index.max(axis=0) + 1
        place = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1)
        at = low + side_mm * (place.reshape(-1, 2) + 0.5)
        part = np.asarray(index[:, 1] * columns + index[:, 0], np.intp)
        return cls(part, (int(rows), int(columns)), at, xy.mean(axis=0))


class Answer(NamedTuple):
    """What squares share, whatever their shifts are: the mean over sizes of the drift.

    Attributes
    ----------
    log_evidence : float
        But for a constant.
    step : (15,) float64
        Of pose, drift and stretch.
    covariance : (6, 6) float64
        Of the pose, if residuals were independent.
    """

    log_evidence: float
    step: Array
    covariance: Array


@dataclass(frozen=True, eq=False)
class Shifted:
    """Borders about a pose that stands still, on squares that may be shifted.

    Attributes
    ----------
    rows : (N, 7) float64
        As of `least_squares_kernel.linearize`, pixels.
    seen : Sightings
    squares : Squares
    sigma : float
        Standard deviation of the residuals within squares, pixels.
    trust : (N,) float64
    sums : PartSums
    """

    rows: Array
    seen: Sightings
    squares: Squares
    sigma: float
    trust: Array
    sums: PartSums

    @classmethod
    def of(
        cls, edge_points: EdgePoints, camera: Camera, pose: MovingPose, side_mm: float
    ) -> Shifted:
        """Borders about a pose, on squares with sides so long."""
        seen = edge_points.seen_by(camera)
        rows = least_squares_kernel.linearize(seen, pose.state) * camera.focal_px
        squares = Squares.over(seen.points_mm, side_mm)
        first = cls._about(rows, seen, squares, rows[:, 0].copy())
        shifts = first.shifts(np.zeros(SHARED), _FREE)
        return cls._about(rows, seen, squares, first.left(np.zeros(SHARED), shifts))

    @classmethod
    def _about(cls, rows: Array, seen: Sightings, squares: Squares, left: Array) -> Shifted:
        sigma = least_squares_kernel.scatter(left.copy(), seen.weight)
        trust = least_squares_kernel.trust_of(left, seen.weight, sigma)
        place, parts = squares.at - squares.middle, len(squares.at)
        sums = part_sums(rows, seen.row_time, place, trust, squares.part, parts)
        return cls(rows, seen, squares, sigma, trust, sums)

    def shifts(self, step: Array, expected: float) -> Array:
        """Shifts (P, 2) of the squares, mm, after a step of what they share."""
        left = self.sums.pull - self.sums.cross @ step
        inner = self.sums.inner + expected * np.eye(2)
        return np.asarray(np.linalg.solve(inner, left[:, :, None])[:, :, 0])

    def left(self, step: Array, shifts: Array) -> Array:
        """Residuals (N,) after a step of what squares share, and their shifts, pixels."""
        changes = self.rows[:, 1:]
        shared = changes @ step[:6] + self.seen.row_time * (changes @ step[6:12])
        moved = shifts + (self.squares.at - self.squares.middle) @ stretch_of(step)
        # A part that moves is seen where a camera that moves the other way would see it.
        away = (changes[:, :2] * moved[self.squares.part]).sum(axis=1)
        return np.asarray(self.rows[:, 0] - shared + away)

    def solved(self, weight: Array, expected: float, bounds: MotionBounds) -> Answer:
        """What squares share.

        Parameters
        ----------
        weight : (P,) float64
            By which each square counts.
        expected : float
            Inverse variance of shifts, 1/mm²; inf where there are none, and no stretch.
        bounds : MotionBounds
        """
        if np.isinf(expected):
            normal, right = self.sums.shared.sum(axis=0), self.sums.right.sum(axis=0)
            twice_log, stretch = 0.0, 1e-9
        else:
            normal, right, twice_log = without_shifts(self.sums, weight, expected)
            stretch = _STRETCH
        drifts, log_prior = drift_priors(bounds)
        sigma = np.hstack([drifts, np.full((len(drifts), 3), stretch)])
        found = solve_with_priors(_TEMPER * normal, _TEMPER * right, sigma, log_prior)
        log_weight, mean, covariance = found
        share = np.exp(log_weight - log_weight.max())
        log_evidence = float(log_weight.max() + np.log(share.sum()) + _TEMPER * twice_log / 2)
        share /= share.sum()
        step = share @ mean
        away = mean[:, :6] - step[:6]
        spread = np.tensordot(share, covariance, 1) + (away * share[:, None]).T @ away
        return Answer(log_evidence, step, _TEMPER * spread)

    def evidence(self, bounds: MotionBounds) -> tuple[float, float]:
        """Natural logarithm of the odds for shifts against none, and their best size, mm."""
        weight = np.ones(len(self.squares.at))
        none = self.solved(weight, np.inf, bounds).log_evidence
        sizes = _SHIFTS_MM**-2.0
        odds = [self.solved(weight, size, bounds).log_evidence - none for size in sizes]
        best = int(np.argmax(odds))
        return odds[best], float(_SHIFTS_MM[best])


def stretch_of(step: Array) -> Array:
    """The symmetric matrix (2, 2) by which a print is stretched, of an answer's step."""
    return np.array([[step[12], step[14]], [step[14], step[13]]])
