"""Clocks matched by motion, and refused where motion does not tell."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from two_motions import TwoMotions, quaternion_wxyz

from padstudio.flights.vehicle.clock import match_clocks
from padstudio.flights.vehicle.motion import Motion, rates_of

OFFSET_S = 73.413


def camera(
    of: TwoMotions, seconds: float = 24.0, *, heights: bool = True, turns: bool = True
) -> Motion:
    """At 20 frames a second, a fifth of them lost and two seconds on end."""
    rng = np.random.default_rng(5)
    time_s = np.arange(0, seconds, 0.05)
    time_s = time_s[(rng.random(len(time_s)) > 0.2) & ((time_s < 9) | (time_s > 11))]
    height = 1.04 * of.height_m(time_s) + rng.normal(size=len(time_s)) * 0.005
    q = quaternion_wxyz(of.camera(time_s, 0.2))
    return _motion(time_s, height if heights else None, q if turns else None)


def log(of: TwoMotions, *, heights: bool = True, turns: bool = True, hertz: float = 10.0) -> Motion:
    """From 20 s before the flight to 40 s behind it, with a gap."""
    rng = np.random.default_rng(6)
    time_s = np.arange(-20, 64, 1 / hertz)
    time_s = time_s[(time_s < 15) | (time_s > 16.5)]
    height = of.height_m(time_s) + rng.normal(size=len(time_s)) * 0.03
    q = quaternion_wxyz(of.body(time_s))
    return _motion(time_s + OFFSET_S, height if heights else None, q if turns else None)


def _motion(time_s: Any, height: Any, q: Any) -> Motion:
    return Motion(None if height is None else time_s, height, None if q is None else time_s, q)


@pytest.mark.parametrize("seed", range(4))
def test_offsets_lie_within_what_is_told(seed: int) -> None:
    motions = TwoMotions(seed)
    found = match_clocks(camera(motions), log(motions))
    assert found.offset_s is not None, found.reason
    assert found.sigma_s is not None
    assert abs(found.offset_s - OFFSET_S) < 4 * found.sigma_s
    assert found.sigma_s < 0.02
    assert min(found.climb_correlation or 0, found.turn_correlation or 0) > 0.95
    assert 15 < found.overlap_s < 22


@pytest.mark.parametrize(("heights", "turns"), [(True, False), (False, True)])
def test_either_signal_is_enough(heights: bool, turns: bool) -> None:
    motions = TwoMotions(2)
    found = match_clocks(camera(motions), log(motions, heights=heights, turns=turns))
    assert found.offset_s == pytest.approx(OFFSET_S, abs=0.03)
    assert (found.climb_correlation is None) == (not heights)
    assert (found.turn_correlation is None) == (not turns)


def test_a_camera_on_a_gimbal_is_matched_by_its_height() -> None:
    motions, gimbal = TwoMotions(3), TwoMotions(30)
    ours = camera(motions)
    assert ours.attitude_time_s is not None
    steady = Motion(
        ours.height_time_s,
        ours.height_m,
        ours.attitude_time_s,
        quaternion_wxyz(gimbal.camera(ours.attitude_time_s)),
    )
    found = match_clocks(steady, log(motions))
    assert found.offset_s == pytest.approx(OFFSET_S, abs=0.05)


@pytest.mark.parametrize("seed", range(4))
def test_another_flights_log_is_refused(seed: int) -> None:
    found = match_clocks(camera(TwoMotions(seed)), log(TwoMotions(seed + 40)))
    assert found.offset_s is None
    assert found.reason


def test_a_hover_tells_nothing() -> None:
    still = TwoMotions(1, axes=(0.0, 0.0, 0.0), climb_m=0.0)
    found = match_clocks(camera(still), log(still))
    assert (found.offset_s, found.sigma_s) == (None, None)
    assert "moved too little" in found.reason


def test_a_swing_that_repeats_itself_is_refused() -> None:
    time_s = np.arange(0, 20, 0.05)
    ours = Motion(time_s, np.sin(2 * np.pi * time_s / 4), None, None)
    longer_s = np.arange(-30, 60, 0.1)
    theirs = Motion(longer_s, np.sin(2 * np.pi * longer_s / 4), None, None)
    found = match_clocks(ours, theirs)
    assert found.offset_s is None
    assert "repeats itself" in found.reason


def test_nothing_to_compare() -> None:
    motions = TwoMotions()
    assert "too few" in match_clocks(Motion(), log(motions)).reason
    short = camera(motions, 1.5)
    assert "three seconds" in match_clocks(short, log(motions)).reason


def test_rates_are_those_of_a_steady_climb_and_turn() -> None:
    time_s = np.sort(np.random.default_rng(0).uniform(0, 10, 300))
    half = 0.2 * time_s
    q = np.column_stack([np.cos(half), np.zeros((len(half), 2)), np.sin(half)])
    rates = rates_of(Motion(time_s, 3000 + 0.7 * time_s, time_s, q), 0.2)
    assert rates is not None
    assert rates.climbs.mean() > 0.9
    assert rates.climb_m_s[rates.climbs, 0] == pytest.approx(0.7, abs=1e-6)
    assert rates.turn_rad_s[rates.turns] == pytest.approx(
        np.tile([0, 0, 0.4], (int(rates.turns.sum()), 1)), abs=1e-6
    )
