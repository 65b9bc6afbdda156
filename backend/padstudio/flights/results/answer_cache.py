"""Keeps what takes long to find out about a flight, as long as it is true or nearly so."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any, TypeVar

from padstudio.store.database.flight_tables import OPEN, FlightRow

ValueT = TypeVar("ValueT")
# Over a million frames an answer may take a second, and pages ask for it each second while the
# flight runs; so an answer is good for so many times as long as it took.
_GOOD_FOR = 10.0


@dataclass(frozen=True)
class _Answer:
    value: Any
    frames_done: int
    is_final: bool
    good_until_s: float


class KeptAnswers:
    """The last answers about flights.

    Parameters
    ----------
    most : int
        Answers to keep.
    """

    def __init__(self, most: int = 200) -> None:
        self._most = most
        self._answers: dict[Hashable, _Answer] = {}

    def of(self, flight: FlightRow, question: Hashable, find_out: Callable[[], ValueT]) -> ValueT:
        """The answer to a question about a flight: kept, or found out now.

        Parameters
        ----------
        flight : FlightRow
            As it is now.
        question : hashable
            Equal for questions with equal answers.
        find_out : callable
        """
        key, is_final = (flight.id, question), flight.state not in OPEN
        kept = self._answers.pop(key, None)
        if kept is None or not _is_good(kept, flight.frames_done, is_final):
            start = time.monotonic()
            value = find_out()
            end = time.monotonic()
            good_until_s = end + _GOOD_FOR * (end - start)
            kept = _Answer(value, flight.frames_done, is_final, good_until_s)
        # The one asked for last comes last, and goes last.
        self._answers[key] = kept
        while len(self._answers) > self._most:
            self._answers.pop(next(iter(self._answers)), None)
        found: ValueT = kept.value
        return found


def _is_good(kept: _Answer, frames_done: int, is_final: bool) -> bool:
    if kept.is_final == is_final and kept.frames_done == frames_done:
        return True
    return not is_final and not kept.is_final and time.monotonic() < kept.good_until_s
