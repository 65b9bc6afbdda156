"""Sums over the times that two flights of one vehicle have both seen, at every offset between them.

What correlations at an offset are made of; see `padstudio.flights.vehicle.clock`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.flights.vehicle.motion import STEP_S, Rates

# Seconds that both have to be seen, and as a share of what there is of the flight.
_LEAST_OVERLAP_S, _LEAST_SHARE = 3.0, 0.3
_BLOCK_S, _BLOCKS = 3.0, (4, 24)
# Places between one step of the grid before the best lag and one after.
_BETWEEN = np.linspace(-1.0, 1.0, 101)
# A share that is never explained, whatever was measured: two clocks' rows are nowhere so alike.
_UNEXPLAINED = 1e-3


@dataclass(frozen=True, eq=False)
class Sums:
    """Sums over the times at which both are known, for each lag.

    ``climb``: (6, L) of 1, a, a², b, b², ab. ``turn``: (12, L) of 1, |a|², |b|², and the nine
    products of a's and b's components, a's first.
    """

    climb: Array
    turn: Array


@dataclass(frozen=True, eq=False)
class BlockSums:
    """The same in blocks of time: (K, 6, L) and (K, 12, L)."""

    climb: Array
    turn: Array

    @property
    def count(self) -> int:
        return len(self.climb)

    def total(self, weights: Array) -> Sums:
        """Of blocks, each so many times."""
        return Sums(np.tensordot(weights, self.climb, 1), np.tensordot(weights, self.turn, 1))


class RatePair:
    """Rates of camera and vehicle; at lag L, place i of the camera's is i + L of the vehicle's."""

    def __init__(self, ours: Rates, theirs: Rates) -> None:
        self._a, self._b = ours, theirs
        self._first = 1 - len(ours.climbs)
        self._size = len(ours.climbs) + len(theirs.climbs) - 1
        self._climb_length = _memory(ours.climb_m_s, ours.climbs, theirs.climb_m_s, theirs.climbs)
        self._turn_length = _memory(ours.turn_rad_s, ours.turns, theirs.turn_rad_s, theirs.turns)
        self._overlap = np.maximum(
            self._correlated(ours.climbs, theirs.climbs), self._correlated(ours.turns, theirs.turns)
        )

    def offset_s(self, lag: float) -> float:
        """The log's time less the flight's."""
        return self._b.start_s - self._a.start_s + lag * STEP_S

    def lags_with_overlap(self) -> NDArray[np.intp]:
        known = max(int(self._a.climbs.sum()), int(self._a.turns.sum()))
        least = max(_LEAST_OVERLAP_S / STEP_S, _LEAST_SHARE * known)
        return np.flatnonzero(self._overlap >= least) + self._first

    def sums(self) -> Sums:
        """For all lags, from the first."""
        a, b = self._a, self._b
        x, y, m, n = a.climb_m_s[:, 0], b.climb_m_s[:, 0], a.climbs, b.climbs
        climb: list[tuple[Array | NDArray[np.bool_], Array | NDArray[np.bool_]]]
        climb = [(m, n), (x, n), (x * x, n), (m, y), (m, y * y), (x, y)]
        u, v, p, q = a.turn_rad_s, b.turn_rad_s, a.turns, b.turns
        turn: list[tuple[Array | NDArray[np.bool_], Array | NDArray[np.bool_]]]
        turn = [(p, q), (np.sum(u * u, 1), q), (p, np.sum(v * v, 1))]
        turn += [(u[:, i], v[:, j]) for i in range(3) for j in range(3)]
        return Sums(
            np.array([self._correlated(*pair) for pair in climb]),
            np.array([self._correlated(*pair) for pair in turn]),
        )

    def block_sums(self, lags: NDArray[np.intp]) -> BlockSums:
        """For some lags, in blocks of time."""
        count = len(self._a.climbs)
        blocks = int(np.clip(count * STEP_S / _BLOCK_S, *_BLOCKS))
        edges = np.linspace(0, count, blocks + 1).astype(int)
        climb = np.zeros((blocks, 6, len(lags)))
        turn = np.zeros((blocks, 12, len(lags)))
        for place, lag in enumerate(lags):
            products = self._products(int(lag))
            for into, rows in zip((climb, turn), products, strict=True):
                into[:, :, place] = np.add.reduceat(rows, edges[:-1], axis=1).T
        return BlockSums(climb, turn)

    def _products(self, lag: int) -> tuple[Array, Array]:
        """What is summed, (6, G) and (12, G), at one lag."""
        a, b = self._a, self._b
        places = np.arange(len(a.climbs)) + lag
        inside = (places >= 0) & (places < len(b.climbs))
        places = np.clip(places, 0, len(b.climbs) - 1)
        both = a.climbs & b.climbs[places] & inside
        x, y = a.climb_m_s[:, 0] * both, b.climb_m_s[places, 0] * both
        turns = a.turns & b.turns[places] & inside
        u, v = a.turn_rad_s * turns[:, None], b.turn_rad_s[places] * turns[:, None]
        climb = np.array([both.astype(float), x, x * x, y, y * y, x * y])
        nine = (u[:, :, None] * v[:, None, :]).reshape(-1, 9).T
        head = np.array([turns.astype(float), np.sum(u * u, 1), np.sum(v * v, 1)])
        return climb, np.vstack([head, nine])

    def odds(self, sums: Sums, lags: NDArray[np.intp]) -> Array:
        """Logarithm of the odds against chance at lags, of sums for all of them."""
        places = lags - self._first
        return self._odds(self._parts(Sums(sums.climb[:, places], sums.turn[:, places])))

    def peak(self, sums: Sums, lags: NDArray[np.intp]) -> float | None:
        """The lag of the highest odds, between steps, of sums for these alone; None at an end.

        What is left unexplained is a parabola near the best lag, of each signal.
        """
        parts = self._parts(sums)
        best = int(np.argmax(self._odds(parts)))
        if not 0 < best < len(lags) - 1:
            return None
        around = slice(best - 1, best + 2)
        fine = [
            (free[best], np.polyval(np.polyfit((-1.0, 0.0, 1.0), left[around], 2), _BETWEEN))
            for free, left in parts
        ]
        found = self._odds([(free, np.maximum(left, _UNEXPLAINED)) for free, left in fine])
        return float(lags[best] + _BETWEEN[int(np.argmax(found))])

    @staticmethod
    def _odds(parts: Sequence[tuple[Array, Array]]) -> Array:
        return np.asarray(sum(-0.5 * free * np.log(left) for free, left in parts))

    def _parts(self, sums: Sums) -> list[tuple[Array, Array]]:
        """Of climbing and of turning: free samples, and the share that is left unexplained."""
        climb, turn = self.correlations(sums)
        parts = []
        for correlation, samples, components, fitted in (
            (climb, sums.climb[0] / self._climb_length, 1, 2),
            # A rotation that was fitted explains as much as three numbers can.
            (turn, sums.turn[0] / self._turn_length, 3, 3),
        ):
            positive = np.maximum(np.nan_to_num(correlation), 0.0)
            free = np.maximum(components * samples - fitted, 0.0)
            parts.append((free, 1 - positive**2 + _UNEXPLAINED))
        return parts

    def correlations(self, sums: Sums) -> tuple[Array, Array]:
        """Of climbing and of turning, at as many lags as the sums have; NaN where not known."""
        n, a, aa, b, bb, ab = sums.climb
        scale = (n * aa - a * a) * (n * bb - b * b)
        with np.errstate(invalid="ignore", divide="ignore"):
            climb = np.where(scale > 0, (n * ab - a * b) / np.sqrt(np.maximum(scale, 0)), np.nan)
            size = np.sqrt(np.maximum(sums.turn[1] * sums.turn[2], 0))
            matrices = np.moveaxis(sums.turn[3:].reshape(3, 3, -1), -1, 0)
            singular = np.linalg.svd(matrices, compute_uv=False)
            sign = np.where(np.linalg.det(matrices) < 0, -1.0, 1.0)
            trace = singular[:, 0] + singular[:, 1] + sign * singular[:, 2]
            turn = np.where(size > 0, trace / size, np.nan)
        return climb, turn

    def _correlated(self, a: Array | NDArray[np.bool_], b: Array | NDArray[np.bool_]) -> Array:
        """Σ over i of a[i] · b[i + L], for every lag."""
        length = 1 << int(np.ceil(np.log2(self._size)))
        spectrum = np.conj(np.fft.rfft(a.astype(float), length))
        whole = np.fft.irfft(spectrum * np.fft.rfft(b.astype(float), length), length)
        return np.asarray(np.roll(whole, -self._first)[: self._size])


def _memory(a: Array, known_a: NDArray[np.bool_], b: Array, known_b: NDArray[np.bool_]) -> float:
    """How many steps of the grid two signals' correlation takes for one independent sample."""
    ra, rb = _autocorrelation(a, known_a), _autocorrelation(b, known_b)
    count = min(len(ra), len(rb))
    return max(1.0, 1 + 2 * float(np.sum(ra[1:count] * rb[1:count])))


def _autocorrelation(values: Array, known: NDArray[np.bool_]) -> Array:
    """From lag 0 to where it first vanishes."""
    if not known.any():
        return np.ones(1)
    centred = np.where(known[:, None], values - values[known].mean(axis=0), 0.0)
    length = 1 << int(np.ceil(np.log2(2 * len(centred))))
    power = np.sum(np.abs(np.fft.rfft(centred, length, axis=0)) ** 2, axis=1)
    whole = np.fft.irfft(power, length)[: len(centred)]
    if whole[0] <= 0:
        return np.ones(1)
    falling = whole / whole[0]
    end = np.flatnonzero(falling < 0)
    return np.asarray(falling[: end[0]] if len(end) else falling)
