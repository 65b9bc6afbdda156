"""Which of a process's time counts as work."""

from __future__ import annotations

import pytest

from padstudio.workers.work_clock import WorkClock


def test_what_comes_before_the_work_does_not_count() -> None:
    clock = WorkClock(10.0, 100.0)
    assert (clock.left_s(500.0) or 0) > 0
    clock.turn("at_work", 500.0)
    assert clock.left_s(507.0) == pytest.approx(3.0)
    assert clock.left_s(511.0) == pytest.approx(-1.0)


def test_preparing_in_the_midst_of_it_does_not_count() -> None:
    clock = WorkClock(10.0, 0.0)
    clock.turn("at_work", 1.0)
    clock.turn("prepares", 5.0)
    assert (clock.left_s(90.0) or 0) > 0
    clock.turn("at_work", 95.0)
    assert clock.left_s(95.0) == pytest.approx(6.0)


def test_other_calls_in_between_do_not_count_however_long_they_take() -> None:
    clock = WorkClock(10.0, 0.0)
    clock.turn("at_work", 0.0)
    clock.turn("aside", 4.0)
    assert clock.left_s(1e6) is None
    clock.turn("at_work", 1e6)
    assert clock.left_s(1e6) == pytest.approx(6.0)


def test_who_never_gets_to_work_hangs() -> None:
    clock = WorkClock(10.0, 0.0)
    assert (clock.left_s(1e5) or 0) < 0


def test_without_a_limit_nothing_runs_out() -> None:
    clock = WorkClock(None, 0.0)
    assert clock.left_s(1e6) is None
    clock.turn("at_work", 1e6)
    assert clock.left_s(1e9) is None
