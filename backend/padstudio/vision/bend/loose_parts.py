"""The pose of a print whose parts lie off their places, by what is left within small squares.

Squares that a seam crosses, or that show another sheet than the pad has there, fit no shift: they
stand out by what a shift leaves over, and count little. The answer is relative to the plane and
the places that fit the squares in view best. Its covariance is that of the scores of single squares
(as of `padstudio.vision.pose.covariance`), however alike what lies within them, and grows by what
separates the squares' mean place from the nominal one: shifts are alike over as many squares as
their correlogram says, and a stretch that shows in view goes on to the pad's centre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Layer
from padstudio.vision.bend.parts import Answer, Shifted, stretch_of
from padstudio.vision.bend.parts_kernel import without_shifts
from padstudio.vision.frame.pyramid import Window
from padstudio.vision.pose.edge_points import EdgeFinder, EdgePoints, measurable_borders
from padstudio.vision.pose.edge_points_kernel import Borders
from padstudio.vision.pose.least_squares import Fit, bounds_of
from padstudio.vision.pose.noise_kernel import newton_share, noise_share
from padstudio.vision.pose.pose_posterior import Explained
from padstudio.vision.pose.row_motion import MotionBounds
from padstudio.vision.refine.refiner import Refiner

# So many borders are measured, so many of them in a square, which is so many cells wide at least.
_MOST, _IN_A_SQUARE, _CELLS = 12_000, 14, 4.0
# Fewer borders make no squares.
_LEAST = 150
# Borders are measured anew so often, and squares weighted.
_ROUNDS, _WEIGHINGS = 3, 4
# Residuals count as this many standard deviations at the most where squares are compared; a square
# whose mean square exceeds that of the middle one by this share counts a quarter.
_MOST_OFF, _STANDS_OUT = 3.0, 0.3
# Squares that count by less than this tell nothing of shifts.
_COUNTS = 0.3
# Squares with fewer borders tell nothing, as of the kernel; and fewer squares no shifts.
_LEAST_IN_A_SQUARE, _FEWEST_SQUARES = 4, 6
# Natural logarithm of the odds that shifts need.
_LEAST_ODDS = 10.0
# Neighbouring shifts are alike where they correlate by more than this, told by this share of pairs.
_ALIKE, _PAIRS = 0.25, 0.1
# No shifts are smaller, mm.
_LEAST_SHIFT_MM = 0.01


@dataclass(frozen=True, eq=False)
class PartsFit:
    """A pose and the squares about it.

    Attributes
    ----------
    pose : MovingPose
        Still, at which the borders were measured.
    edge_points : EdgePoints
    shifted : Shifted
    answer : Answer
    weight : (P,) float64
        By which squares count.
    variance : float
        Of the squares' shifts without what stretches the print, mm².
    alike : float
        How many squares go together.
    """

    pose: MovingPose
    edge_points: EdgePoints
    shifted: Shifted
    answer: Answer
    weight: Array
    variance: float
    alike: float

    @property
    def expected(self) -> float:
        """Inverse variance of a shift, if all were independent, 1/mm²."""
        return 1 / (self.variance * self.alike)


def fit_parts(refiner: Refiner, pose: MovingPose) -> Fit | None:
    """The pose whatever the shifts of the print's parts are; None where they are none.

    Parameters
    ----------
    refiner : Refiner
    pose : MovingPose
        As if the print were one flat sheet.
    """
    chosen = _borders(refiner, pose)
    if chosen is None:
        return None
    borders, layer, window = chosen
    finder = EdgeFinder(borders, window, refiner.camera, refiner.params.refine.reach_px)
    pose, found, expected = MovingPose(pose.pose), None, 0.0
    for _ in range(_ROUNDS):
        edge_points = finder.find(pose)
        if len(edge_points.xy) < _LEAST:
            return None
        bounds = bounds_of(pose, refiner.model(moving=False), edge_points.pixel)
        area = float(np.prod(np.ptp(edge_points.borders.points_mm[:, :2], axis=0)))
        side = max(_CELLS * layer.cell_mm, float(np.sqrt(area * _IN_A_SQUARE / len(borders.step))))
        shifted = Shifted.of(edge_points, refiner.camera, pose, side)
        if found is None:
            odds, size = shifted.evidence(bounds)
            if odds < _LEAST_ODDS:
                return None
            expected = size**-2.0
        found = _weighted(pose, edge_points, shifted, expected, bounds)
        if found is None:
            return None
        pose, expected = pose.moved(found.answer.step[:6]), found.expected
    return None if found is None else _fit_of(found)


def _borders(refiner: Refiner, pose: MovingPose) -> tuple[Borders, Layer, Window] | None:
    """All borders in view of the finest layer that can be measured."""
    least_px = refiner.params.refine.least_cell_px
    for layer in sorted(refiner.pad.layers, key=lambda item: item.cell_mm):
        borders, cell_px = measurable_borders(
            refiner.pad, layer, refiner.camera, pose, _MOST, least_px
        )
        if len(borders.step) >= _LEAST and cell_px >= least_px:
            return borders, layer, refiner.window(layer, cell_px, sharper=1)
    return None


def _weighted(
    pose: MovingPose,
    edge_points: EdgePoints,
    shifted: Shifted,
    expected: float,
    bounds: MotionBounds,
) -> PartsFit | None:
    """The answer where squares that fit no shift count little."""
    count, part = shifted.sums.borders, shifted.squares.part
    used = count >= _LEAST_IN_A_SQUARE
    weight, found = used.astype(float), None
    for _ in range(_WEIGHINGS):
        answer = shifted.solved(weight, expected, bounds)
        shifts = shifted.shifts(answer.step, expected)
        off = np.abs(shifted.left(answer.step, shifts)) / shifted.sigma
        square = shifted.seen.weight * np.minimum(off, _MOST_OFF) ** 2
        total = np.bincount(part, square, len(count))
        trust = np.bincount(part, shifted.seen.weight, len(count))
        mean = total / np.maximum(trust, 1e-9) * count / np.maximum(count - 2, 1)
        beyond = np.maximum(mean / np.median(mean[used]) - 1, 0) / _STANDS_OUT
        weight = used / (1 + beyond**2) ** 2
        counts = weight > _COUNTS
        if counts.sum() < _FEWEST_SQUARES:
            return None
        variance, alike = _alike(shifted.squares.shape, shifts, counts)
        found = PartsFit(pose, edge_points, shifted, answer, weight, variance, alike)
        expected = found.expected
    return found


def _alike(shape: tuple[int, int], shifts: Array, counts: NDArray[np.bool_]) -> tuple[float, float]:
    """Variance of shifts (P, 2), mm², and how many squares go together, by their correlogram."""
    mean = shifts[counts].mean(axis=0)
    left = (shifts - mean) * counts[:, None]
    twice = (2 * shape[0], 2 * shape[1])

    def correlogram(values: Array) -> Array:
        waves = np.fft.rfft2(values.reshape(shape), twice)
        return np.asarray(np.fft.irfft2(np.abs(waves) ** 2, twice))

    pairs = np.maximum(correlogram(counts.astype(float)), 0.5)
    together = sum(correlogram(axis) for axis in left.T) / pairs
    alike = together / max(float(together[0, 0]), 1e-12)
    tells = (alike > _ALIKE) & (pairs > _PAIRS * pairs[0, 0])
    variance = float((left**2).sum() / (2 * counts.sum()))
    return max(variance, _LEAST_SHIFT_MM**2), max(1.0, float(alike[tells].sum()))


def _fit_of(found: PartsFit) -> Fit:
    shifted, step = found.shifted, found.answer.step
    left = shifted.left(step, shifted.shifts(step, found.expected))
    trust = shifted.seen.weight * found.weight[shifted.squares.part]
    inliers = (np.abs(left) < 4 * shifted.sigma) & (trust > 0)
    rms = float(np.sqrt((trust * left**2)[inliers].sum() / max(trust[inliers].sum(), 1e-12)))
    pose = found.pose.moved(step[:6])
    explained = Explained(pose, _covariance(found))
    return Fit(pose, rms, inliers, lambda: explained)


def _together(shifted: Shifted, score: Array, alike: float) -> Array:
    """Sums of scores (P, 6) over squares that go together: sheets are turned as a whole."""
    columns = shifted.squares.shape[1]
    side = max(1, round(float(np.sqrt(alike))))
    row, column = np.divmod(np.arange(len(score)), columns)
    group = row // side * (columns // side + 1) + column // side
    return np.stack([np.bincount(group, axis) for axis in score.T], axis=1)


def _covariance(found: PartsFit) -> Array:
    """Covariance (6, 6) of the pose relative to the nominal plane and place."""
    shifted, step, weight = found.shifted, found.answer.step, found.weight
    sums, expected = shifted.sums, found.expected
    inner = sums.inner + (expected / np.maximum(weight, 1e-9))[:, None, None] * np.eye(2)
    held = np.linalg.solve(inner, (sums.pull - sums.cross @ step)[:, :, None])
    score = sums.right - sums.shared @ step - (sums.cross.transpose(0, 2, 1) @ held)[:, :, 0]
    score = _together(shifted, (score * weight[:, None])[:, :6], found.alike)
    normal = without_shifts(sums, weight, expected)[0][:6, :6]
    noise = noise_share(normal, score.T @ score, score, len(score), np.inf)
    robust = shifted.trust * shifted.sigma**2 / np.maximum(shifted.seen.weight, 1e-12)
    share = newton_share(robust, shifted.seen.weight * weight[shifted.squares.part])
    out = found.answer.covariance * (noise / share**2)
    # Where the nominal centre lies from the squares in view.
    at = shifted.squares.at[weight > _COUNTS]
    middle = at.mean(axis=0)
    stretched = stretch_of(step) @ middle
    out[:2, :2] += np.outer(stretched, stretched)
    beyond = float(middle @ middle) / max(float(at.var(axis=0).sum()), 1e-9)
    out[[0, 1], [0, 1]] += found.variance * found.alike / len(at) * beyond
    return np.asarray(out)
