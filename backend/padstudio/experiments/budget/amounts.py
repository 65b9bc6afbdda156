"""How much a source adds to the error, and how sure that is: from single frames' errors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.experiments.budget.frames import Reading

#: What is measured of each frame: lengths in mm, the last in degrees.
MEASURES = ("position", "height", "across", "attitude")
# Fewer frames that are read, or less than this share of them, tell nothing.
_FEWEST_READ, _LEAST_SHARE = 4, 0.5
_RESAMPLES = 2000
_CONFIDENCE = 0.95


@dataclass(frozen=True, eq=False)
class Excess:
    """What is added to the squares of the errors, frame by frame.

    Attributes
    ----------
    squares : (N, 4) float64
        Of `MEASURES`, mm² and deg²; below 0 where chance has it so.
    counts : (N,) bool
        Which frames are read in all that it compares.
    """

    squares: Array
    counts: NDArray[np.bool_]

    @property
    def is_measured(self) -> bool:
        """Whether enough frames are read."""
        read = int(self.counts.sum())
        return read >= max(_FEWEST_READ, _LEAST_SHARE * len(self.counts))


@dataclass(frozen=True)
class Amount:
    """A root mean square with its bounds of confidence, 95 %.

    Attributes
    ----------
    value, low, high : float
        mm or degrees.
    is_resolved : bool
        False where it cannot be told from nothing.
    """

    value: float
    low: float
    high: float
    is_resolved: bool


class Sample:
    """Resamples frames, the same ones for all that is compared (paired bootstrap).

    The percentiles are spread as Student's law is wider than the normal one, and by n over n - 1:
    the expanded percentile interval of Hesterberg (2015, doi:10.1080/00031305.2015.1089789).

    Parameters
    ----------
    frames : int
    seed : int
    """

    def __init__(self, frames: int, seed: int) -> None:
        rng = np.random.default_rng([seed, *b"bootstrap"])
        even = np.full(frames, 1 / frames)
        # The first is the sample itself.
        drawn = rng.multinomial(frames, even, _RESAMPLES)
        self._weights = np.vstack([np.ones(frames), drawn]).astype(float)
        self._frames = frames

    def means(self, excess: Excess) -> Array:
        """Mean squares (1 + resamples, 4) of frames that count; the first is the sample's own."""
        weights = self._weights * excess.counts
        total = weights.sum(axis=1, keepdims=True)
        squares = np.where(excess.counts[:, None], excess.squares, 0.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(weights @ squares / total)

    def bounds(self, values: Array) -> tuple[float, float]:
        """Bounds of confidence of figures (1 + resamples,)."""
        told = values[1:][np.isfinite(values[1:])]
        tail = _expanded_tail(self._frames)
        low, high = np.quantile(told, [tail, 1 - tail]) if len(told) else (-np.inf, np.inf)
        return float(low), float(high)

    def amount(self, mean_squares: Array) -> Amount:
        """The root of mean squares (1 + resamples,), of which those below 0 are 0."""
        low, high = self.bounds(mean_squares)
        value = float(mean_squares[0])
        return Amount(_root(value), _root(low), _root(high), low > 0)

    def amounts(self, mean_squares: Array) -> tuple[Amount, ...]:
        """As `amount`, of each of `MEASURES`."""
        return tuple(self.amount(column) for column in mean_squares.T)


def alone(readings: Sequence[Reading]) -> Excess:
    """The errors themselves."""
    errors, counts = _errors(readings)
    return Excess(_squares(errors), counts)


def over(readings: Sequence[Reading], floor: Sequence[Reading]) -> Excess:
    """What a source adds in quadrature to the floor of pixels and noise.

    Parameters
    ----------
    readings, floor : sequence of Reading
        Of the same frames, with and without the source.
    """
    errors, counts = _errors(readings)
    below, below_counts = _errors(floor)
    return Excess(_squares(errors) - _squares(below), counts & below_counts)


def beside(readings: Sequence[Reading], floor: Sequence[Reading]) -> Excess:
    """What a wrong belief of the detector changes, where pictures and noise are the same.

    Parameters
    ----------
    readings, floor : sequence of Reading
        Of the same pictures, with the wrong belief and without.
    """
    errors, counts = _errors(readings)
    below, below_counts = _errors(floor)
    return Excess(_squares(errors - below), counts & below_counts)


def _errors(readings: Sequence[Reading]) -> tuple[Array, NDArray[np.bool_]]:
    errors = np.array([[*each.error_mm, *each.turn_deg] for each in readings], float)
    return errors, np.array([each.state == "full" for each in readings])


def _squares(errors: Array) -> Array:
    x, y, z, *turn = errors.T**2
    return np.column_stack([x + y + z, z, x + y, sum(turn)])


def _root(square: float) -> float:
    return math.sqrt(max(square, 0.0))


def _expanded_tail(count: int) -> float:
    """The share of resamples beyond each bound."""
    normal = NormalDist()
    student = _student(normal.inv_cdf((1 + _CONFIDENCE) / 2), count - 1)
    return normal.cdf(-math.sqrt(count / (count - 1)) * student)


def _student(z: float, degrees: int) -> float:
    """Student's quantile from the normal one (Abramowitz and Stegun 1964, 26.7.5)."""
    terms = (
        (z**3 + z) / 4,
        (5 * z**5 + 16 * z**3 + 3 * z) / 96,
        (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384,
        (79 * z**9 + 776 * z**7 + 1482 * z**5 - 1920 * z**3 - 945 * z) / 92160,
    )
    return float(z + sum(term / degrees**power for power, term in enumerate(terms, 1)))
