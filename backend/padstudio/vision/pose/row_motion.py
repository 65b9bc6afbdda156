"""What a frame's rows say of motion while the shutter rolled, and what they leave open.

A rolling shutter reads one row after another, so each row sees a pose of its own: the pose at the
middle row, a steady drift, and a shaking that is smooth from row to row. The measured borders'
normal equations are summed by intervals of rows; on these sums a linear Gaussian model is solved,
with the drift of an unknown size, and the shaking a Gaussian process of unknown size and length
that is zero at the middle row. Sizes and lengths are weighted by their marginal likelihoods, so
that what shows no motion is as sure as its residuals, and what may be motion or pose is no surer
than the motion that shows elsewhere in the frame.

References
----------
Rasmussen, C. E. and Williams, C. K. I. (2006). Gaussian processes for machine learning, chapters 2
and 5. MIT Press. MacKay, D. J. C. (1992). Bayesian interpolation.
doi:10.1162/neco.1992.4.3.415. Meingast, M., Geyer, C. and Sastry, S. (2005). Geometric models of
rolling-shutter cameras. arXiv:cs/0503076.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from padstudio.arrays import Array
from padstudio.vision.pose.drift_kernel import Drift, Priors, Rows, drifting, mixture, unrest
from padstudio.vision.pose.row_motion_kernel import FEW_ROWS, STATIC

# Sizes of a drift within the frame, radians, and shares of the height; the first is none.
_DRIFTS = np.array([1e-6, 5e-5, 1.5e-4, 5e-4, 1.5e-3, 4e-3, 1e-2, 3e-2, 8e-2])
_NO_DRIFT = 0.6
_LOG_PRIOR = np.log([_NO_DRIFT, *[(1 - _NO_DRIFT) / (len(_DRIFTS) - 1)] * (len(_DRIFTS) - 1)])
# A vehicle sinks faster than it drifts, by so many times, and turns about the camera's axis faster
# than it leans; but it sinks by no more than half of the height a second, in the time that the
# shutter rolls or in 24 ms.
_CLIMB, _YAW, _MOST_CLIMB_S, _READOUT_MS = 8.0, 2.0, 0.5, 24.0
# Standard deviations of a shaking, radians (0.01 … 0.4 degrees), and its lengths, frames.
_SWAYS = np.array([2e-4, 6e-4, 2e-3, 6e-3])
_LENGTHS = (0.05, 0.12, 0.3)
# Sizes of the drift beside a shaking; shaking about the axis is less; and what keeps it definite.
_DRIFT_BESIDE, _ROLL, _NUGGET = 4, 0.7, 1e-3
# Squared shifts of single intervals over their variance from which a shaking is looked for; frames
# at rest reach 1.4 once in ten.
_SHAKEN = 1.7
# A drift's standard deviations by its size: sideways and in height in heights, and of attitude.
_SHAPE = np.array([1.0, 1.0, _CLIMB, 1.0, 1.0, _YAW])
_BY_SIZE = _DRIFTS[:, None] * _SHAPE


@dataclass(frozen=True, eq=False)
class MotionBounds:
    """What is known of a frame's motion beforehand.

    Attributes
    ----------
    height_mm : float
    expected : (6,) float64
        Change of centre (mm) and attitude (radians) from the first row to the last.
    climb_mm : float
        By how much the expected change of height may be off at the most, one standard deviation.
    bias_px : float
        By how far steps may seem to lie toward the dark, one standard deviation.
    rolling : bool
        The shutter may roll.
    at_rest : bool
        Nothing moves, not even while the shutter is open.
    """

    height_mm: float
    expected: Array
    climb_mm: float
    bias_px: float
    rolling: bool
    at_rest: bool = False

    @classmethod
    def unknown(
        cls, height_mm: float, bias_px: float, readout_ms: float | None, *, rolling: bool
    ) -> MotionBounds:
        """Of a frame by itself."""
        seconds = (_READOUT_MS if readout_ms is None else readout_ms) / 1000
        climb = _MOST_CLIMB_S * seconds * height_mm
        return cls(height_mm, np.zeros(6), climb, bias_px, rolling)

    @property
    def drift_sigmas(self) -> Array:
        """Standard deviations (S, 6) of the drift about what is expected, at all its sizes."""
        sigma: Array = _BY_SIZE.copy()
        sigma[:, :3] *= self.height_mm
        sigma[:, 2] = np.minimum(sigma[:, 2], self.climb_mm)
        return sigma

    @property
    def _priors(self) -> Priors:
        if self.rolling:
            return Priors(self.bias_px, self.drift_sigmas, _LOG_PRIOR)
        return Priors(self.bias_px, np.zeros((1, 0)), np.zeros(1))


@dataclass(frozen=True, eq=False)
class RowFit:
    """What the rows say.

    Attributes
    ----------
    step : (8,) float64
        Of the pose at the middle row, then of the two biases.
    covariance : (6, 6) float64
        Of the pose.
    motion : (6,) float64
        Drift from the first row to the last.
    sway : (I + 1, 3) float64
        Rotation vectors of the shaking at the intervals' ends.
    shaken : bool
        A shaking shows.
    log_odds : float
        Natural logarithm of a shaking's odds against none, where it was looked for.
    """

    step: Array
    covariance: Array
    motion: Array
    sway: Array
    shaken: bool
    log_odds: float = 0.0


@dataclass(frozen=True, eq=False)
class _Posteriors:
    """Answers under several sizes of motion: their log weights, means and covariances."""

    log_weight: Array
    mean: Array
    covariance: Array

    @classmethod
    def of(cls, normal: Array, pull: Array, log_prior: Array) -> _Posteriors:
        """Solutions of normal equations (S, n, n) and what they make of their priors' weights."""
        unit = 1 / np.sqrt(np.einsum("sii->si", normal))
        scaled = normal * unit[:, :, None] * unit[:, None, :]
        scaled += 1e-13 * np.eye(len(pull))
        lower = np.linalg.cholesky(scaled)
        spread = np.log(np.einsum("sii->si", lower) / unit).sum(axis=1)
        # Of the inverse the pose's six columns are enough.
        right = np.zeros((*unit.shape, 7))
        right[:, range(6), range(6)] = unit[:, :6]
        right[:, :, 6] = unit * pull
        found = np.linalg.solve(scaled, right) * unit[:, :, None]
        mean = np.ascontiguousarray(found[:, :, 6])
        weight = log_prior + 0.5 * mean @ pull - spread
        return cls(weight, mean, np.ascontiguousarray(found[:, :6, :6]))


def drift_priors(bounds: MotionBounds) -> tuple[Array, Array]:
    """Standard deviations (S, 6) of sizes of a drift, and the logarithms (S,) of their priors."""
    some = slice(None if bounds.rolling else 1)
    return bounds.drift_sigmas[some], _LOG_PRIOR[some]


def explain_rows(rows: Rows, motion: Array, bounds: MotionBounds) -> RowFit:
    """Solve for pose, biases and motion by the sums over rows.

    Parameters
    ----------
    rows : Rows
    motion : (6,) float64
        The drift about which the sums were made.
    bounds : MotionBounds
    """
    count, away = rows.sums.pull.shape[1], motion - bounds.expected
    drift = drifting(rows, away, bounds._priors)
    shaken = drift.unrest > _SHAKEN
    if not bounds.rolling or (not shaken and rows.width * count > FEW_ROWS):
        return _row_fit(drift.mixed.mean, drift.mixed.covariance, bounds, count)
    sway = _swaying(drift, rows, away, bounds)
    fit = replace(_mixed(drift, sway, bounds, count), shaken=shaken)
    whole = np.concatenate([fit.step, fit.motion - bounds.expected])
    left = unrest(rows, whole, away, fit.sway)
    log_odds = float(sway.log_weight.max() - drift.log_weight.max())
    return replace(fit, covariance=fit.covariance * max(1.0, left), log_odds=log_odds)


def _swaying(drift: Drift, rows: Rows, away: Array, bounds: MotionBounds) -> _Posteriors:
    """With a shaking besides, of several sizes and lengths."""
    normal, pull = _with_sway(drift, rows, away)
    knots = rows.first + rows.width * np.arange(rows.sums.pull.shape[1] + 1)
    sigma = bounds.drift_sigmas[_DRIFT_BESIDE]
    sigma[2] = bounds.climb_mm
    head = STATIC + 6
    normal[range(STATIC, head), range(STATIC, head)] += sigma**-2.0
    every, priors = [], []
    axes = np.array([1.0, 1.0, _ROLL])
    for length in _LENGTHS:
        inverse, spread = _process(knots, length)
        for sway in _SWAYS:
            one = normal.copy()
            for axis in range(3):
                one[head + axis :: 3, head + axis :: 3] += inverse / (sway * axes[axis]) ** 2
            every.append(one)
            log_sizes = len(knots) * np.log(sway * axes).sum()
            priors.append(-1.5 * spread - log_sizes - np.log(sigma).sum())
    share = np.log((1 - _NO_DRIFT) / len(every))
    return _Posteriors.of(np.stack(every), pull, np.array(priors) + share)


def _with_sway(drift: Drift, rows: Rows, away: Array) -> tuple[Array, Array]:
    """Normal equations of static parameters, drift, and rotations at the intervals' ends, between
    which they go straight."""
    width, (m0, m1, m2), (g0, g1) = rows.width, rows.sums.normal, rows.sums.pull
    starts = rows.first + width * np.arange(len(g0), dtype=float)
    head, turns = STATIC + 6, slice(3, 6)
    size = head + 3 * (len(starts) + 1)
    whole, right = np.zeros((size, size)), np.zeros(size)
    whole[:head, :head], right[:head] = drift.normal, drift.pull
    # What an interval's rotation at its beginning sees of static parameters and drift, and its end.
    before, after = m0 - m1, m1
    at = starts[:, None, None]
    moved = (at * before + width * (m1 - m2), at * after + width * m2)
    for k in range(len(starts)):
        here, there = (slice(head + 3 * n, head + 3 * n + 3) for n in (k, k + 1))
        for place, seen, drifted, asked in (
            (here, before[k], moved[0][k], g0[k] - g1[k]),
            (there, after[k], moved[1][k], g1[k]),
        ):
            whole[:STATIC, place] += seen[:, turns]
            whole[STATIC:head, place] += drifted[:6, turns]
            right[place] += asked[turns] + drifted[turns, :6] @ away
        whole[here, here] += (m0[k] - 2 * m1[k] + m2[k])[turns, turns]
        whole[there, there] += m2[k][turns, turns]
        whole[here, there] += (m1[k] - m2[k])[turns, turns]
    upper = np.triu(whole)
    return upper + np.triu(whole, 1).T, right


def _process(at: Array, length: float) -> tuple[Array, float]:
    """Inverse covariance and log determinant of a smooth process that is zero at time 0."""
    near = np.exp(-0.5 * ((at[:, None] - at) / length) ** 2)
    middle = np.exp(-0.5 * (at / length) ** 2)
    values = near - middle[:, None] - middle + 1 + _NUGGET * np.eye(len(at))
    return np.asarray(np.linalg.inv(values)), float(np.linalg.slogdet(values)[1])


def _mixed(drift: Drift, sway: _Posteriors, bounds: MotionBounds, count: int) -> RowFit:
    """Moments of the mixture of all answers, with a shaking and without."""
    still = np.zeros((len(drift.mean), sway.mean.shape[1]))
    still[:, : drift.mean.shape[1]] = drift.mean
    found = mixture(
        np.concatenate([drift.log_weight, sway.log_weight]),
        np.concatenate([still, sway.mean]),
        np.concatenate([drift.covariance, sway.covariance]),
    )
    return _row_fit(found.mean, found.covariance, bounds, count)


def _row_fit(mean: Array, covariance: Array, bounds: MotionBounds, count: int) -> RowFit:
    """The fit whose parameters, as many as it has, are these."""
    motion, sway = bounds.expected, np.zeros((count + 1, 3))
    if len(mean) > STATIC:
        motion = motion + mean[STATIC : STATIC + 6]
    if len(mean) > STATIC + 6:
        sway = mean[STATIC + 6 :].reshape(-1, 3)
    return RowFit(mean[:STATIC], covariance, motion, sway, shaken=False)
