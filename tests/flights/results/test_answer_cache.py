"""Answers about flights are kept while they are true; a running flight's, a little longer."""

from __future__ import annotations

import pytest

from padstudio.flights.results import answer_cache
from padstudio.flights.results.answer_cache import KeptAnswers
from padstudio.store.database.flight_tables import FlightRow


class Clock:
    """Time that passes when somebody looks for an answer."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.asked = 0

    def monotonic(self) -> float:
        return self.now_s

    def find_out(self) -> int:
        self.now_s += 2.0
        self.asked += 1
        return self.asked


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(answer_cache, "time", made)
    return made


def flight(state: str = "done", frames_done: int = 5, name: str = "a") -> FlightRow:
    return FlightRow(id=name, state=state, frames_done=frames_done)


def test_an_answer_about_a_flight_that_is_over_is_kept(clock: Clock) -> None:
    kept = KeptAnswers()
    assert [kept.of(flight(), "q", clock.find_out) for _ in range(3)] == [1, 1, 1]
    clock.now_s += 1e6
    assert kept.of(flight(), "q", clock.find_out) == 1


def test_questions_and_flights_are_told_apart(clock: Clock) -> None:
    kept = KeptAnswers()
    assert kept.of(flight(), "q", clock.find_out) == 1
    assert kept.of(flight(), "other", clock.find_out) == 2
    assert kept.of(flight(name="b"), "q", clock.find_out) == 3


def test_while_it_runs_an_answer_is_good_for_ten_times_its_cost(clock: Clock) -> None:
    kept = KeptAnswers()
    assert kept.of(flight("running", 1), "q", clock.find_out) == 1
    clock.now_s += 19.9
    assert kept.of(flight("running", 2), "q", clock.find_out) == 1
    clock.now_s += 0.2
    assert kept.of(flight("running", 3), "q", clock.find_out) == 2


def test_the_end_of_a_flight_is_told_at_once(clock: Clock) -> None:
    kept = KeptAnswers()
    assert kept.of(flight("running", 5), "q", clock.find_out) == 1
    assert kept.of(flight("done", 5), "q", clock.find_out) == 2
    # Tried again: what was found of it before does not count.
    assert kept.of(flight("queued", 5), "q", clock.find_out) == 3


def test_those_not_asked_for_longest_go_first(clock: Clock) -> None:
    kept = KeptAnswers(most=2)
    for name in ("a", "b", "a", "c", "a", "b"):
        kept.of(flight(name=name), "q", clock.find_out)
    assert clock.asked == 4
