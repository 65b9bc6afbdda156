"""The autopilot's clock against one whose offset, drift and delays are known."""

from __future__ import annotations

import numpy as np
import pytest
from autopilot_end import AutopilotClockTruth
from hypothesis import given
from hypothesis import strategies as st

from padstudio.autopilot.clock import AutopilotClock


def _ask(
    clock: AutopilotClock, truth: AutopilotClockTruth, sent_s: float, there_s: float, back_s: float
) -> None:
    clock.take(sent_s, round(truth.at(sent_s + there_s) * 1e9), sent_s + there_s + back_s)


@pytest.mark.parametrize("seed", range(12))
def test_it_is_found_through_jitter_that_differs_by_the_way(seed: int) -> None:
    random = np.random.default_rng(seed)
    drift, offset_s = random.uniform(-2e-4, 2e-4), random.uniform(-1e5, 1e7)
    truth, clock = AutopilotClockTruth(offset_s, drift), AutopilotClock()
    errors_s = []
    sent_s = 50.0
    for k in range(200):
        there_s, back_s = 0.001 + random.exponential((0.002, 0.01))
        _ask(clock, truth, sent_s, there_s, back_s)
        # As of a frame that was taken a little before.
        shown = clock.at_ns(sent_s - 0.05)
        assert (shown is not None) == (k >= 9)
        if shown is not None:
            errors_s.append(abs(shown * 1e-9 - truth.at(sent_s - 0.05)))
        sent_s += 0.1 if k < 50 else 0.5
    assert max(errors_s) < 4e-3
    assert max(errors_s[20:]) < 2e-3
    state = clock.state(sent_s)
    assert state.drift_ppm == pytest.approx(drift * 1e6, abs=20)
    assert 1e-3 <= state.error_s < 3e-3
    assert state.restarts == 0


@given(st.floats(-3e-4, 3e-4), st.floats(-1e6, 1e6), st.floats(1e-4, 0.4))
def test_ways_of_one_length_leave_no_error(drift: float, offset_s: float, way_s: float) -> None:
    truth, clock = AutopilotClockTruth(offset_s, drift), AutopilotClock()
    for k in range(20):
        _ask(clock, truth, 5.0 + k, way_s, way_s)
    shown = clock.at_ns(24.0)
    assert shown is not None
    assert shown * 1e-9 == pytest.approx(truth.at(24.0), abs=1e-6)
    assert clock.state(24.0).error_s == pytest.approx(way_s, rel=1e-3, abs=1e-6)


def test_few_answers_and_old_ones_say_nothing() -> None:
    truth, clock = AutopilotClockTruth(), AutopilotClock()
    for k in range(9):
        _ask(clock, truth, 10 + k, 0.001, 0.001)
        assert clock.at_ns(10.0 + k) is None
    _ask(clock, truth, 20, 0.001, 0.001)
    assert clock.at_ns(20.0) is not None
    assert clock.at_ns(79.0) is not None
    assert clock.at_ns(81.0) is None
    assert not clock.state(81.0).is_known


def test_a_clock_that_begins_anew_is_followed() -> None:
    clock = AutopilotClock()
    for k in range(30):
        _ask(clock, AutopilotClockTruth(500.0), 10 + 0.1 * k, 0.001, 0.001)
    later = AutopilotClockTruth(-13.0)
    for k in range(12):
        _ask(clock, later, 14 + 0.1 * k, 0.001, 0.001)
    shown = clock.at_ns(15.0)
    assert shown is not None
    assert shown * 1e-9 == pytest.approx(later.at(15.0), abs=1e-3)
    assert clock.state(15.0).restarts == 1


def test_answers_that_took_too_long_or_came_before_they_were_asked_for_are_left_out() -> None:
    truth, clock = AutopilotClockTruth(), AutopilotClock()
    for k in range(20):
        _ask(clock, truth, 10 + k, 0.8, 0.9)
        clock.take(10.0 + k, 5, 9.0 + k)
    assert clock.state(30.0).answers == 0
