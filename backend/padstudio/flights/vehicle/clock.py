"""The clock of a vehicle's log against that of a flight, found by the motion that both saw.

Each offset is judged by two correlations: of the rates of climb, and of the rates of turning under
the rotation that fits them best, as the camera's mounting is not known. Both are turned into the
logarithm of odds against chance, with as many independent samples as the signals' own
autocorrelations leave (Bartlett), and added. Gaps count on neither side.

References
----------
M. S. Bartlett, "Some aspects of the time-correlation problem in regard to tests of significance",
Journal of the Royal Statistical Society 98 (1935), doi:10.2307/2342284.
W. Kabsch, "A solution for the best rotation to relate two sets of vectors", Acta Crystallographica
A32 (1976), doi:10.1107/S0567739476001873.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from padstudio.flights.vehicle.motion import STEP_S, Motion, rates_of
from padstudio.flights.vehicle.rate_pair import RatePair

# The kernel of rates, s, and against the distance of samples.
_SIGMA_S, _SIGMA_GAPS = 0.15, 0.75
# Odds against chance, and against every other offset, as natural logarithms.
_LEAST_ODDS = 7.0
# One of both has to agree as well as this: of 290 pairs of simulated flights that had nothing to do
# with each other, odds alone let four pass, at 0.55 to 0.77; flights and their own logs had 0.98.
_LEAST_CORRELATION = 0.85
# Offsets so close to the best are the same answer.
_LOBE_S = 0.75
# An offset that is less sure tells nothing about poses at frames' times.
_MOST_SIGMA_S = 0.15
_RESAMPLED, _AGREEING = 200, 0.95
# Of the grid, the fits and the stamps of logs, which resampling does not show, s.
_FLOOR_S = 0.005


@dataclass(frozen=True)
class ClockMatch:
    """What the motion tells of two clocks.

    Attributes
    ----------
    offset_s : float or None
        The log's time is the flight's and this; None where the motion does not tell.
    sigma_s : float or None
        One standard deviation.
    climb_correlation, turn_correlation : float or None
        Of the rates at that offset; None where they are not known on both sides.
    overlap_s : float
        Time that both have seen there.
    reason : str
        Why there is no offset.
    """

    offset_s: float | None = None
    sigma_s: float | None = None
    climb_correlation: float | None = None
    turn_correlation: float | None = None
    overlap_s: float = 0.0
    reason: str = ""


def match_clocks(ours: Motion, theirs: Motion) -> ClockMatch:
    """Find the offset of a log's clock.

    Parameters
    ----------
    ours : Motion
        The camera's, on the flight's clock.
    theirs : Motion
        The vehicle's, on its log's.
    """
    gap_s = max(ours.usual_gap_s, theirs.usual_gap_s)
    sigma_s = max(_SIGMA_S, _SIGMA_GAPS * gap_s)
    a, b = rates_of(ours, sigma_s), rates_of(theirs, sigma_s)
    if a is None or b is None:
        return ClockMatch(reason="there are too few poses, or rows of the log, to compare")
    pair = RatePair(a, b)
    lags = pair.lags_with_overlap()
    if not len(lags):
        return ClockMatch(
            reason="at no offset do the poses and the log overlap for three seconds or more"
        )
    odds = pair.odds(pair.sums(), lags)
    best = int(np.argmax(odds))
    chance = float(np.log(max(len(lags) * STEP_S / sigma_s, 1.0)))
    if odds[best] < chance + _LEAST_ODDS:
        return ClockMatch(
            reason="nowhere do the vehicle's climbing and turning agree with the camera's: it "
            "moved too little, or the log is of another flight"
        )
    lobe = max(1, round(max(_LOBE_S, 2 * sigma_s) / STEP_S))
    apart = np.abs(lags - lags[best]) > lobe
    if apart.any() and odds[best] - odds[apart].max() < _LEAST_ODDS:
        other = lags[apart][int(np.argmax(odds[apart]))] - lags[best]
        return ClockMatch(
            reason="the motion repeats itself: an offset that differs by "
            f"{abs(other) * STEP_S:.1f} s fits as well"
        )
    return _settled(pair, int(lags[best]), lobe)


def _settled(pair: RatePair, lag: int, lobe: int) -> ClockMatch:
    """The offset between two steps of the grid, and how sure it is by resampled blocks of time."""
    near = np.arange(lag - lobe, lag + lobe + 1)
    near = near[np.isin(near, pair.lags_with_overlap())]
    blocks = pair.block_sums(near)
    whole = blocks.total(np.ones(blocks.count))
    centre = pair.peak(whole, near)
    if centre is None:
        return ClockMatch(reason="the best offset lies at the end of what both have seen")
    rng = np.random.default_rng(0)
    peaks = []
    for _ in range(_RESAMPLED):
        drawn = rng.multinomial(blocks.count, np.full(blocks.count, 1 / blocks.count))
        peaks.append(pair.peak(blocks.total(drawn.astype(float)), near))
    found = np.array([peak for peak in peaks if peak is not None])
    if len(found) < _AGREEING * _RESAMPLED:
        return ClockMatch(reason="parts of the flight ask for other offsets than the whole of it")
    inflation = blocks.count / (blocks.count - 1)
    sigma_s = float(np.hypot(STEP_S * found.std() * np.sqrt(inflation), _FLOOR_S))
    if sigma_s > _MOST_SIGMA_S:
        return ClockMatch(
            reason=f"the motion is too slow to tell the offset better than {sigma_s:.2f} s"
        )
    climb, turn = pair.correlations(whole)
    place = int(np.argmin(np.abs(near - centre)))
    closest = float(np.nanmax([climb[place], turn[place], 0.0]))
    if closest < _LEAST_CORRELATION:
        return ClockMatch(
            reason="even at the best offset the vehicle's climbing and turning agree too little "
            f"with the camera's, with a correlation of {closest:.2f}: the log is of another "
            "flight, or the poses are too noisy"
        )
    return ClockMatch(
        offset_s=pair.offset_s(centre),
        sigma_s=sigma_s,
        climb_correlation=None if np.isnan(climb[place]) else float(climb[place]),
        turn_correlation=None if np.isnan(turn[place]) else float(turn[place]),
        overlap_s=float(max(whole.climb[0][place], whole.turn[0][place]) * STEP_S),
    )
