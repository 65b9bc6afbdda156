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
from padstudio.vision.pose.row_motion_kernel import STATIC, RowSums, solve_with_priors

#: Intervals of rows over what was measured; a vibration of four periods a frame needs as many over
#: all of it.
INTERVALS, FEW_INTERVALS = 16, 8
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
# Over less than such a share of the frame a shaking looks like tilt, and is always reckoned with.
_FEW_ROWS = 0.5
# Intervals that leave a direction of shift this much less sure than the other tell nothing.
_ONE_SIDED = 50.0


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

    def drift_sigmas(self, sizes: Array) -> Array:
        """Standard deviations (S, 6) of the drift about what is expected, at some sizes of it."""
        turn = np.array([1.0, 1.0, _YAW])
        climb = np.minimum(_CLIMB * sizes * self.height_mm, self.climb_mm)
        sideways = sizes[:, None] * np.full(2, self.height_mm)
        return np.hstack([sideways, climb[:, None], sizes[:, None] * turn])


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
    def of_few(cls, normal: Array, pull: Array, sigma: Array, log_prior: Array) -> _Posteriors:
        """As `of`, of few unknowns: `padstudio.vision.pose.row_motion_kernel.solve_with_priors`."""
        return cls(*solve_with_priors(normal, pull, sigma, log_prior))

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
    return bounds.drift_sigmas(_DRIFTS[some]), _LOG_PRIOR[some]


def intervals_over(first: float, last: float) -> tuple[float, float, int]:
    """Where intervals of rows begin that cover some row times, their length and their number."""
    count = INTERVALS if last - first > _FEW_ROWS else FEW_INTERVALS
    return first - 1e-9, (last - first + 2e-9) / count, count


def explain_rows(
    sums: RowSums, first: float, width: float, motion: Array, bounds: MotionBounds
) -> RowFit:
    """Solve for pose, biases and motion by the sums over rows.

    Parameters
    ----------
    sums : RowSums
        Scaled so that their inverse is a covariance.
    first, width : float
        Row time of the first interval's beginning, and its length.
    motion : (6,) float64
        The drift about which the sums were made.
    bounds : MotionBounds
    """
    count = sums.normal.shape[1]
    normal, pull = _static(sums, bounds)
    if not bounds.rolling:
        still = _Posteriors.of_few(normal, pull, np.zeros((1, 0)), np.zeros(1))
        return _mixed([still], bounds, count)
    starts = first + width * np.arange(count, dtype=float)
    away = motion - bounds.expected
    normal, pull = _with_drift(normal, pull, sums, (starts, width), away)
    drift = _drifting(normal, pull, bounds)
    best = drift.mean[np.argmax(drift.log_weight)]
    shaken = _unrest(sums, (starts, width), best, away) > _SHAKEN
    if not shaken and width * count > _FEW_ROWS:
        return _mixed([drift], bounds, count)
    sway = _swaying((normal, pull), sums, (starts, width), away, bounds)
    fit = replace(_mixed([drift, sway], bounds, count), shaken=shaken)
    whole = np.concatenate([fit.step, fit.motion - bounds.expected])
    left = _unrest(sums, (starts, width), whole, away, fit.sway)
    log_odds = float(sway.log_weight.max() - drift.log_weight.max())
    return replace(fit, covariance=fit.covariance * max(1.0, left), log_odds=log_odds)


def _static(sums: RowSums, bounds: MotionBounds) -> tuple[Array, Array]:
    normal = sums.normal[0].sum(axis=0)
    normal[[6, 7], [6, 7]] += 1 / bounds.bias_px**2
    return normal, sums.pull[0].sum(axis=0)


def _with_drift(
    normal: Array, pull: Array, sums: RowSums, rows: tuple[Array, float], away: Array
) -> tuple[Array, Array]:
    """Normal equations (14, 14) of the static parameters and the drift, without its prior."""
    (starts, width), (m0, m1, m2), (g0, g1) = rows, sums.normal, sums.pull
    at = starts[:, None, None]
    once = (at * m0 + width * m1).sum(axis=0)[:, :6]
    twice = (at * at * m0 + 2 * width * at * m1 + width * width * m2).sum(axis=0)[:6, :6]
    whole = np.block([[normal, once], [once.T, twice]])
    moved = (starts[:, None] * g0 + width * g1).sum(axis=0)[:6]
    return whole, np.concatenate([pull, moved]) + whole[:, STATIC:] @ away


def _drifting(normal: Array, pull: Array, bounds: MotionBounds) -> _Posteriors:
    return _Posteriors.of_few(normal, pull, bounds.drift_sigmas(_DRIFTS), _LOG_PRIOR)


def _unrest(
    sums: RowSums, rows: tuple[Array, float], best: Array, away: Array, sway: Array | None = None
) -> float:
    """Squared shifts that single intervals still ask for, over their variance."""
    starts, width = rows
    drift = best[STATIC:] - away
    left = sums.pull[0] - sums.normal[0] @ best[:STATIC]
    moments = starts[:, None, None] * sums.normal[0] + width * sums.normal[1]
    left = (left - moments[:, :, :6] @ drift)[:, 3:5]
    if sway is not None:
        m0, m1 = (sums.normal[k][:, 3:5, 3:6] for k in range(2))
        left = left - np.einsum("kij,kj->ki", m0 - m1, sway[:-1])
        left = left - np.einsum("kij,kj->ki", m1, sway[1:])
    a, b, c = (sums.normal[0][:, i, j] for i, j in ((3, 3), (4, 4), (3, 4)))
    middle, half = (a + b) / 2, np.sqrt((a - b) ** 2 / 4 + c * c)
    tells = (middle > 0) & (middle + half < _ONE_SIDED * (middle - half))
    a, b, c, (x, y) = a[tells], b[tells], c[tells], left[tells].T
    squares = (b * x * x - 2 * c * x * y + a * y * y) / (a * b - c * c)
    free = 2 * len(a) - 6
    return float(squares.sum() / free) if free > 0 else 0.0


def _swaying(
    drifting: tuple[Array, Array],
    sums: RowSums,
    rows: tuple[Array, float],
    away: Array,
    bounds: MotionBounds,
) -> _Posteriors:
    """With a shaking besides, of several sizes and lengths."""
    starts, width = rows
    normal, pull = _with_sway(*drifting, sums, rows, away)
    knots = starts[0] + width * np.arange(len(starts) + 1)
    size = np.array([_DRIFTS[_DRIFT_BESIDE]])
    sigma = bounds.drift_sigmas(size)[0]
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


def _with_sway(
    normal: Array, pull: Array, sums: RowSums, rows: tuple[Array, float], away: Array
) -> tuple[Array, Array]:
    """Normal equations of static parameters, drift, and rotations at the intervals' ends, between
    which they go straight."""
    (starts, width), (m0, m1, m2), (g0, g1) = rows, sums.normal, sums.pull
    head, turns = STATIC + 6, slice(3, 6)
    size = head + 3 * (len(starts) + 1)
    whole, right = np.zeros((size, size)), np.zeros(size)
    whole[:head, :head], right[:head] = normal, pull
    # What an interval's rotation at its beginning sees of static parameters and drift, and its end.
    before, after = m0 - m1, m1
    at = starts[:, None, None]
    moved = (at * before + width * (m1 - m2), at * after + width * m2)
    for k in range(len(starts)):
        here, there = (slice(head + 3 * n, head + 3 * n + 3) for n in (k, k + 1))
        for place, seen, drift, asked in (
            (here, before[k], moved[0][k], g0[k] - g1[k]),
            (there, after[k], moved[1][k], g1[k]),
        ):
            whole[:STATIC, place] += seen[:, turns]
            whole[STATIC:head, place] += drift[:6, turns]
            right[place] += asked[turns] + drift[turns, :6] @ away
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


def _mixed(found: list[_Posteriors], bounds: MotionBounds, count: int) -> RowFit:
    """Moments of the mixture of all answers."""
    log_weight = np.concatenate([part.log_weight for part in found])
    weight = np.exp(log_weight - log_weight.max())
    weight /= weight.sum()
    size = found[-1].mean.shape[1]
    mean = np.zeros((len(weight), size))
    covariance, first = np.zeros((6, 6)), 0
    for part in found:
        here = slice(first, first + len(part.mean))
        mean[here, : part.mean.shape[1]] = part.mean
        covariance += (weight[here] @ part.covariance.reshape(-1, 36)).reshape(6, 6)
        first = here.stop
    whole = weight @ mean
    away = mean[:, :6] - whole[:6]
    covariance += (away * weight[:, None]).T @ away
    drift, sway = np.zeros(6), np.zeros((count + 1, 3))
    if size > STATIC:
        drift = whole[STATIC : STATIC + 6]
    if size > STATIC + 6:
        sway = whole[STATIC + 6 :].reshape(-1, 3)
    motion = bounds.expected + drift
    return RowFit(whole[:STATIC], covariance, motion, sway, shaken=len(found) > 1)
