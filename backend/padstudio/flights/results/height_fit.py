"""Figures that need computing: pose height against telemetry, frames to show as samples."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from padstudio.errors import SpecError

#: Pairs of samples are all looked at: 600 samples make 180 000 pairs.
MAX_SAMPLES = 600
#: Telemetry is rounded to 0.1 m and drifts by as much; over less range a slope says nothing.
MIN_RANGE_M = 1.0
MIN_SAMPLES = 12
#: Barometers and take-off points are not truer than this.
TOLERANCE = 0.02

Verdict = Literal["agrees", "too_high", "too_low", "uncertain"]


@dataclass(frozen=True)
class HeightComparison:
    """Pose height as a line over telemetry height: ``pose = slope · telemetry + offset``.

    A pose's height is proportional to the focal length and to the size of the cells that it was
    told. A slope of 1.05 therefore means that the focal length is 5 % too long, or that the print
    is 1 / 1.05 of the size that the pad's file says. The offset holds the height of the take-off
    point over the pad and says nothing of either.

    Attributes
    ----------
    slope, slope_low, slope_high : float
        The median of the slopes of all pairs, and its 95 % interval.
    offset_mm : float
    scatter_mm : float
        Median distance of the poses from the line.
    samples : int
    range_m : float
        Of the telemetry's heights.
    verdict : {"agrees", "too_high", "too_low", "uncertain"}
        ``uncertain`` where the range is too short, the samples too few or the interval too wide.
    """

    slope: float
    slope_low: float
    slope_high: float
    offset_mm: float
    scatter_mm: float
    samples: int
    range_m: float
    verdict: Verdict


def compare_heights(telemetry_m: ArrayLike, pose_mm: ArrayLike) -> HeightComparison | None:
    """Fit pose height against telemetry height, not misled by up to 29 % wrong samples.

    Parameters
    ----------
    telemetry_m : array_like, shape (n,)
        Heights over the point of take-off, m, each at the time of a pose.
    pose_mm : array_like, shape (n,)
        Heights of the camera over the pad, mm.

    Returns
    -------
    HeightComparison or None
        None where there are fewer than three samples of different heights.

    Raises
    ------
    SpecError
        If the two do not have the same length.

    Notes
    -----
    Slope: Theil–Sen, the median over all pairs of samples; interval: Sen's, from Kendall's rank
    variance, as if samples were independent.

    References
    ----------
    P. K. Sen, "Estimates of the Regression Coefficient Based on Kendall's Tau", Journal of the
    American Statistical Association 63 (1968), doi:10.1080/01621459.1968.10480934.
    """
    x, y = np.asarray(telemetry_m, float), np.asarray(pose_mm, float)
    if x.shape != y.shape or x.ndim != 1:
        raise SpecError(f"heights to compare differ in number: {x.shape} and {y.shape}")
    finite = np.isfinite(x) & np.isfinite(y)
    x, y = x[finite], y[finite]
    if len(x) > MAX_SAMPLES:
        chosen = np.linspace(0, len(x) - 1, MAX_SAMPLES).round().astype(int)
        x, y = x[chosen], y[chosen]
    if len(x) < 3 or np.ptp(x) == 0:
        return None
    slope, low, high = (value / 1000 for value in _theil_sen(x, y))
    offset_mm = float(np.median(y - 1000 * slope * x))
    scatter_mm = float(np.median(np.abs(y - 1000 * slope * x - offset_mm)))
    range_m = float(np.ptp(x))
    known = len(x) >= MIN_SAMPLES and range_m >= MIN_RANGE_M and high - low < 4 * TOLERANCE
    verdict = _verdict(slope, low, high) if known else "uncertain"
    return HeightComparison(slope, low, high, offset_mm, scatter_mm, len(x), range_m, verdict)


def _verdict(slope: float, low: float, high: float) -> Verdict:
    if low > 1 and slope > 1 + TOLERANCE:
        return "too_high"
    if high < 1 and slope < 1 - TOLERANCE:
        return "too_low"
    return "agrees"


def _theil_sen(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float, float]:
    """Slope with the ends of its 95 % interval."""
    first, second = np.triu_indices(len(x), 1)
    dx, dy = x[second] - x[first], y[second] - y[first]
    slopes = np.sort(dy[dx != 0] / dx[dx != 0])
    count, pairs = len(x), len(slopes)
    spread = 1.96 * np.sqrt(count * (count - 1) * (2 * count + 5) / 18)
    # Pairs of equal height have no slope; the ranks shrink with those that are left.
    spread *= pairs / (count * (count - 1) / 2)
    low = max(0, int(np.floor((pairs - spread) / 2)))
    high = min(pairs - 1, int(np.ceil((pairs + spread) / 2)))
    return float(np.median(slopes)), float(slopes[low]), float(slopes[high])


def choose_samples(first: int, last: int, stride: int, count: int) -> list[int]:
    """Frame numbers spread evenly over a flight, its first and last among them.

    Parameters
    ----------
    first, last : int
        Frame numbers that were read, the last within.
    stride : int
        Between frames that were read.
    count : int
        How many, at most.
    """
    places = (last - first) // stride
    if count < 2 or places == 0:
        return [first]
    chosen = np.linspace(0, places, min(count, places + 1)).round().astype(int)
    return [first + int(place) * stride for place in chosen]
