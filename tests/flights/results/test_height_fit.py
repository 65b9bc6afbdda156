from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.errors import SpecError
from padstudio.flights.results.height_fit import (
    MAX_SAMPLES,
    choose_samples,
    compare_heights,
)


def _descent(
    slope: float, count: int = 200, noise_mm: float = 15.0
) -> tuple[np.ndarray, np.ndarray]:
    """Telemetry rounded as cameras do, m, and poses `slope` times as high, mm."""
    random = np.random.default_rng(5)
    height_m = np.linspace(12.0, 0.3, count)
    pose_mm = 1000 * slope * height_m + 350 + random.normal(0, noise_mm, count)
    return np.round(height_m, 1), pose_mm


@pytest.mark.parametrize(
    ("slope", "verdict"), [(1.0, "agrees"), (1.05, "too_high"), (0.9, "too_low"), (1.01, "agrees")]
)
def test_the_slope_tells_a_wrong_scale(slope: float, verdict: str) -> None:
    found = compare_heights(*_descent(slope))
    assert found is not None
    assert found.slope == pytest.approx(slope, abs=0.003)
    assert found.slope_low < slope < found.slope_high
    assert found.offset_mm == pytest.approx(350, abs=20)
    assert found.scatter_mm < 40
    assert found.verdict == verdict


def test_a_quarter_of_wrong_poses_does_not_change_the_verdict() -> None:
    telemetry, poses = _descent(1.05)
    poses[::4] = 20_000.0
    found = compare_heights(telemetry, poses)
    assert found is not None
    assert found.slope == pytest.approx(1.05, abs=0.02)
    least_squares = np.polyfit(telemetry, poses / 1000, 1)[0]
    assert abs(least_squares - 1.05) > 0.2


@pytest.mark.parametrize("count", [5, 200])
def test_too_little_is_said_to_be_too_little(count: int) -> None:
    telemetry, poses = _descent(1.3, count)
    near = telemetry / 20 if count > 100 else telemetry
    found = compare_heights(near, poses)
    assert found is not None
    assert found.verdict == "uncertain"


def test_a_hover_and_no_telemetry_give_nothing() -> None:
    assert compare_heights([3.0] * 50, np.linspace(2990, 3010, 50)) is None
    assert compare_heights([], []) is None
    assert compare_heights([1.0, np.nan, 2.0], [1000.0, 1500.0, 2000.0]) is None


def test_long_flights_are_thinned() -> None:
    found = compare_heights(*_descent(1.05, 20_000))
    assert found is not None
    assert found.samples == MAX_SAMPLES
    assert found.slope == pytest.approx(1.05, abs=0.003)


def test_lists_of_different_length_are_refused() -> None:
    with pytest.raises(SpecError, match="differ"):
        compare_heights([1.0, 2.0], [1.0])


@given(
    slope=st.floats(0.2, 5),
    shift=st.floats(-3, 3),
    factor=st.floats(0.5, 2),
)
def test_the_slope_follows_scale_and_not_the_point_of_take_off(
    slope: float, shift: float, factor: float
) -> None:
    telemetry, poses = _descent(slope, 30)
    first = compare_heights(telemetry, poses)
    moved = compare_heights(telemetry + shift, factor * poses)
    assert first is not None
    assert moved is not None
    assert moved.slope == pytest.approx(factor * first.slope, rel=1e-6)


@given(
    first=st.integers(0, 1000),
    places=st.integers(0, 500),
    stride=st.integers(1, 20),
    count=st.integers(1, 60),
)
def test_samples_are_frames_that_were_read_at_even_distances(
    first: int, places: int, stride: int, count: int
) -> None:
    last = first + places * stride
    chosen = choose_samples(first, last, stride, count)
    assert len(chosen) == min(count, places + 1)
    assert all((frame - first) % stride == 0 and first <= frame <= last for frame in chosen)
    assert chosen == sorted(set(chosen))
    if len(chosen) > 1:
        assert (chosen[0], chosen[-1]) == (first, last)
        steps = np.diff(chosen) // stride
        assert np.ptp(steps) <= 1
