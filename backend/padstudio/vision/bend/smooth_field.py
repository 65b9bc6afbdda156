"""A smooth height field as a Gaussian process on few cosines, and the evidence for one.

Heights are a sum of cosines over a box, each with the variance that the spectral density of a
squared-exponential covariance gives it. Two figures say what is expected of a sheet: how high its
bends are, and how long; both are found by the marginal likelihood, which counts what freedom costs.

References
----------
Solin, A. and Särkkä, S. (2020). Hilbert space methods for reduced-rank Gaussian process regression.
doi:10.1007/s11222-019-09886-w. MacKay, D. J. C. (1992). Bayesian interpolation.
doi:10.1162/neco.1992.4.3.415.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array

# Cosines of up to this angular frequency, over the length of bends, leave out 1 % of a bend.
_HIGHEST = 3.2
# The box reaches so many lengths of bends beyond what is measured: cosines are level at its rim.
_MARGIN = 1.0
# Amplitudes tried, mm: a factor of two from one to the next but one.
_AMPLITUDES_MM = 2.0 ** np.arange(-3.0, 6.01, 0.5)


@dataclass(frozen=True, eq=False)
class Cosines:
    """Orthonormal cosines over a box of the pad's plane.

    Attributes
    ----------
    low, side : (2,) float64
        The box, mm.
    modes : (K, 2) int
        Half waves along x and y.
    length_mm : float
        Over which heights are alike: the scale of the covariance exp(−d²/2ℓ²).
    """

    low: Array
    side: Array
    modes: NDArray[np.intp]
    length_mm: float

    @classmethod
    def over(cls, box: Array, length_mm: float) -> Cosines:
        """Those that bends of a length need.

        Parameters
        ----------
        box : (2, 2) float64
            Least and largest x and y of what is measured, mm.
        length_mm : float
        """
        low = box[0] - _MARGIN * length_mm
        side = box[1] - box[0] + 2 * _MARGIN * length_mm
        most = (_HIGHEST * side / (np.pi * length_mm)).astype(int) + 1
        modes = np.stack(np.meshgrid(*map(np.arange, most)), axis=-1).reshape(-1, 2)
        waves = np.hypot(*(np.pi * modes / side).T)
        return cls(low, side, modes[waves * length_mm < _HIGHEST], length_mm)

    @cached_property
    def variance(self) -> Array:
        """Variances (K,) of the coefficients of a field of unit variance."""
        square = ((np.pi * self.modes / self.side) ** 2).sum(axis=1) * self.length_mm**2
        return np.asarray(2 * np.pi * self.length_mm**2 * np.exp(-square / 2))

    def at(self, xy: Array, slope: int | None = None) -> Array:
        """The cosines, or their slopes along axis ``slope``, at points (N, 2): (N, K)."""
        parts = []
        for axis in range(2):
            number = np.arange(self.modes[:, axis].max() + 1)
            wave = np.pi * number / self.side[axis]
            phase = np.outer(wave, xy[:, axis] - self.low[axis])
            one = -wave[:, None] * np.sin(phase) if slope == axis else np.cos(phase)
            one *= (np.where(number == 0, 1.0, np.sqrt(2)) / np.sqrt(self.side[axis]))[:, None]
            parts.append(one[self.modes[:, axis]])
        # A mode's values lie side by side: picking columns would take three times as long.
        return np.asarray((parts[0] * parts[1]).T)


class Evidence(NamedTuple):
    """How well a field of the best amplitude explains residuals, over a flat sheet.

    Attributes
    ----------
    log_odds : float
        Natural logarithm of the ratio of marginal likelihoods.
    amplitude_mm : float
    """

    log_odds: float
    amplitude_mm: float


def find_evidence(normal: Array, right: Array, variance: Array) -> Evidence:
    """The evidence for a field in normal equations of a pose and its coefficients.

    Parameters
    ----------
    normal : (6 + K, 6 + K) float64
    right : (6 + K,) float64
        Of the residuals about the flat sheet.
    variance : (K,) float64
        As of `Cosines.variance`.
    """
    across = solve(normal[:6, :6], np.column_stack([normal[:6, 6:], right[:6]]))
    scale = np.sqrt(variance)
    inner = normal[6:, 6:] - normal[6:, :6] @ across[:, :-1]
    values, vectors = np.linalg.eigh(inner * np.outer(scale, scale))
    values = np.maximum(values, 0.0)
    pull = (vectors.T @ (scale * (right[6:] - normal[6:, :6] @ across[:, -1]))) ** 2
    power = _AMPLITUDES_MM[:, None] ** 2
    odds = pull / (values + 1 / power) - np.log1p(values * power)
    log_odds = 0.5 * odds.sum(axis=1)
    best = int(log_odds.argmax())
    return Evidence(float(log_odds[best]), float(_AMPLITUDES_MM[best]))


def solve(matrix: Array, right: Array) -> Array:
    """Solution of a symmetric, positive definite system whose units differ widely."""
    unit = 1 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    scaled = unit[:, None] * right if right.ndim > 1 else unit * right
    inner = np.linalg.solve(matrix * np.outer(unit, unit), scaled)
    return np.asarray(unit[:, None] * inner if right.ndim > 1 else unit * inner)
