"""How fast something climbs and turns, on an even grid of times, from uneven samples with gaps.

A camera and the vehicle that carries it share two things whatever the mounting: the rate of climb,
and the rate of turning up to one fixed rotation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array

#: Between two times of the grid, s.
STEP_S = 0.05
# Samples further apart than this, or than four times the usual, have nothing between them, s.
_MAX_GAP_S = 1.0
# Reach of the kernel in its standard deviations.
_REACH = 3.0
# A slope is told where samples lie on both sides: their spread and their mean, in deviations.
_LEAST_SPREAD, _MOST_OFF = 0.5, 0.6


@dataclass(frozen=True, eq=False)
class Motion:
    """Samples of one flight, each None where there are none.

    Attributes
    ----------
    height_time_s, height_m : (N,) float64 or None
    attitude_time_s : (M,) float64 or None
    quaternion_wxyz : (M, 4) float64 or None
        Scalar first; takes vectors of what turns (camera, body) to those of what stands still.
    """

    height_time_s: Array | None = None
    height_m: Array | None = None
    attitude_time_s: Array | None = None
    quaternion_wxyz: Array | None = None

    @property
    def usual_gap_s(self) -> float:
        """Between samples, the larger of both medians."""
        times = [each for each in (self.height_time_s, self.attitude_time_s) if each is not None]
        gaps = [float(np.median(np.diff(each))) for each in times if len(each) > 1]
        return max(gaps, default=0.0)


@dataclass(frozen=True, eq=False)
class Rates:
    """Rates on a grid of `STEP_S`.

    Attributes
    ----------
    start_s : float
        Time of the first value.
    climb_m_s : (G, 1) float64
    turn_rad_s : (G, 3) float64
        In the frame that turns.
    climbs, turns : (G,) bool
        Where they are known; elsewhere values are 0.
    """

    start_s: float
    climb_m_s: Array
    turn_rad_s: Array
    climbs: NDArray[np.bool_]
    turns: NDArray[np.bool_]


def rates_of(motion: Motion, sigma_s: float) -> Rates | None:
    """Rates smoothed by a Gaussian kernel; None where there are no samples.

    Parameters
    ----------
    motion : Motion
    sigma_s : float
        Standard deviation of the kernel.
    """
    times = [
        each
        for each in (motion.height_time_s, motion.attitude_time_s)
        if each is not None and len(each) > 1
    ]
    if not times:
        return None
    start_s = min(float(each[0]) for each in times)
    end_s = max(float(each[-1]) for each in times)
    count = int(np.ceil((end_s - start_s) / STEP_S)) + 1
    grid = _Grid(start_s, count, sigma_s)
    climb, climbs = np.zeros((count, 1)), np.zeros(count, bool)
    turn, turns = np.zeros((count, 3)), np.zeros(count, bool)
    if motion.height_time_s is not None and motion.height_m is not None:
        climb, climbs = grid.slopes(motion.height_time_s, motion.height_m[:, None])
    if motion.attitude_time_s is not None and motion.quaternion_wxyz is not None:
        turn, turns = grid.means(*_turn_rates(motion.attitude_time_s, motion.quaternion_wxyz))
    return Rates(start_s, climb, turn, climbs, turns)


class _Grid:
    """Local fits at even times; exact times of samples count, though they are sorted into bins."""

    def __init__(self, start_s: float, count: int, sigma_s: float) -> None:
        self._start_s, self._count, self._sigma_s = start_s, count, sigma_s
        reach = int(np.ceil(_REACH * sigma_s / STEP_S))
        self._offset_s = np.arange(-reach, reach + 1) * STEP_S
        self._kernel = np.exp(-0.5 * (self._offset_s / sigma_s) ** 2)

    def slopes(self, time_s: Array, values: Array) -> tuple[Array, NDArray[np.bool_]]:
        """(G, K) slopes of local lines, and (G,) where they are told."""
        s0, s1, s2, place, within = self._moments(time_s)
        spread = np.maximum(s0 * s2 - s1 * s1, 1e-12)
        told = self._is_told(s0, s1, s2)
        slopes = np.empty((self._count, values.shape[1]))
        for k, column in enumerate(values.T):
            # A slope does not hang on the mean; of large heights, sums lose their last digits.
            t0, t1 = self._weighted(place, within, column - column.mean())
            slopes[:, k] = (s0 * t1 - s1 * t0) / spread
        slopes[~told] = 0.0
        return slopes, told

    def means(self, time_s: Array, values: Array) -> tuple[Array, NDArray[np.bool_]]:
        """(G, K) local means, likewise."""
        if not len(time_s):
            return np.zeros((self._count, values.shape[1])), np.zeros(self._count, bool)
        s0, s1, s2, place, within = self._moments(time_s)
        told = self._is_told(s0, s1, s2)
        means = np.empty((self._count, values.shape[1]))
        for k, column in enumerate(values.T):
            means[:, k] = self._weighted(place, within, column)[0] / np.maximum(s0, 1e-12)
        means[~told] = 0.0
        return means, told

    def _moments(self, time_s: Array) -> tuple[Array, Array, Array, NDArray[np.intp], Array]:
        at = (time_s - self._start_s) / STEP_S
        place = np.clip(np.rint(at).astype(np.intp), 0, self._count - 1)
        within = (at - place) * STEP_S
        w, o = self._kernel, self._offset_s
        m0, m1, m2 = (self._binned(place, within**power) for power in (0, 1, 2))
        s0 = self._sum(m0, w)
        s1 = self._sum(m0, w * o) + self._sum(m1, w)
        s2 = self._sum(m0, w * o * o) + 2 * self._sum(m1, w * o) + self._sum(m2, w)
        return s0, s1, s2, place, within

    def _weighted(
        self, place: NDArray[np.intp], within: Array, column: Array
    ) -> tuple[Array, Array]:
        w, o = self._kernel, self._offset_s
        v0, v1 = self._binned(place, column), self._binned(place, column * within)
        return self._sum(v0, w), self._sum(v0, w * o) + self._sum(v1, w)

    def _is_told(self, s0: Array, s1: Array, s2: Array) -> NDArray[np.bool_]:
        mean = s1 / np.maximum(s0, 1e-12)
        spread = np.sqrt(np.maximum(s2 / np.maximum(s0, 1e-12) - mean**2, 0.0))
        near = np.abs(mean) < _MOST_OFF * self._sigma_s
        return np.asarray((s0 > 1.0) & near & (spread > _LEAST_SPREAD * self._sigma_s))

    def _binned(self, place: NDArray[np.intp], weights: Array) -> Array:
        return np.bincount(place, weights=weights, minlength=self._count).astype(float)

    def _sum(self, bins: Array, kernel: Array) -> Array:
        """Σ over k of kernel[k] · bins[g + k] at every g."""
        reach = len(kernel) // 2
        return np.correlate(np.pad(bins, reach), kernel, "valid")


def _turn_rates(time_s: Array, q: Array) -> tuple[Array, Array]:
    """Times between neighbours, s, and (N, 3) rates of turning there, in the frame that turns."""
    gap_s = np.diff(time_s)
    near = gap_s <= min(_MAX_GAP_S, 4 * float(np.median(gap_s)))
    step = rotation_vectors(q[:-1], q[1:])
    middle_s = (time_s[:-1] + time_s[1:]) / 2
    return middle_s[near], (step / gap_s[:, None])[near]


def rotation_vectors(first: Array, second: Array) -> Array:
    """(N, 3) rotation vectors, in the frame that turns, from attitudes (N, 4) to others."""
    w = np.sum(first * second, axis=1)
    v = (
        first[:, :1] * second[:, 1:]
        - second[:, :1] * first[:, 1:]
        - np.cross(first[:, 1:], second[:, 1:])
    )
    v = np.where(w[:, None] < 0, -v, v)
    sine = np.linalg.norm(v, axis=1)
    angle = 2 * np.arctan2(sine, np.abs(w))
    return np.asarray(v * np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 2.0)[:, None])
