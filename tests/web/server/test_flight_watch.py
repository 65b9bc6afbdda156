"""One look at a flight serves all who watch it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from padstudio.errors import NotFoundError
from padstudio.web.server.flight_watch import FlightWatch


def _run(coroutine: Coroutine[Any, Any, Any]) -> Any:
    """Its result; in a thread, as a browser of other tests may have a loop in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


class Flight:
    """A flight that goes on by one step between two looks, and how often it was looked at."""

    def __init__(self, steps: int) -> None:
        self.steps, self.looks = steps, 0
        self.waits: list[float] = []

    def look(self, flight_id: str) -> tuple[str, bool]:
        assert flight_id == "f"
        self.looks += 1
        return f"step {self.looks}", self.looks >= self.steps

    async def sleep(self, seconds: float) -> None:
        self.waits.append(seconds)
        # All who watch have been told by then.
        for _ in range(5):
            await asyncio.sleep(0)


async def _told(
    watchers: int, look: Callable[[str], tuple[str, bool]], watch: FlightWatch
) -> list[list[str]]:
    async def one() -> list[str]:
        return [text async for text in watch.watch("f", look)]

    return await asyncio.gather(*(one() for _ in range(watchers)))


@pytest.mark.parametrize("watchers", [1, 1000])
def test_looks_do_not_grow_with_watchers(watchers: int) -> None:
    flight = Flight(4)
    told = _run(_told(watchers, flight.look, FlightWatch(flight.sleep)))
    assert told == [["step 1", "step 2", "step 3", "step 4"]] * watchers
    assert flight.looks == 4


def test_a_crowd_is_told_less_often() -> None:
    waits = {}
    for watchers in (10, 1000):
        flight = Flight(3)
        _run(_told(watchers, flight.look, FlightWatch(flight.sleep)))
        waits[watchers] = flight.waits[-1]
    assert waits[10] == 0.5
    assert 1000 / waits[1000] <= 300


def test_nothing_is_told_twice_and_a_flight_that_is_gone_ends() -> None:
    looks = iter(["queued", "queued", "queued"])

    def look(_: str) -> tuple[str, bool]:
        try:
            return next(looks), False
        except StopIteration:
            raise NotFoundError("gone") from None

    assert _run(_told(3, look, FlightWatch(Flight(0).sleep))) == [["queued"]] * 3


def test_a_look_that_fails_is_tried_again(caplog: pytest.LogCaptureFixture) -> None:
    flight, faults = Flight(2), [OSError("database")]

    def look(flight_id: str) -> tuple[str, bool]:
        if faults:
            raise faults.pop()
        return flight.look(flight_id)

    assert _run(_told(2, look, FlightWatch(flight.sleep))) == [["step 1", "step 2"]] * 2
    assert "trying again" in caplog.text


def test_looks_end_with_the_last_watcher_and_begin_anew() -> None:
    flight = Flight(10**6)
    watch = FlightWatch(flight.sleep)

    async def run() -> int:
        first = watch.watch("f", flight.look)
        second = watch.watch("f", flight.look)
        assert [await anext(first), await anext(second)] == ["step 1"] * 2
        await first.aclose()  # type: ignore[attr-defined]
        await second.aclose()  # type: ignore[attr-defined]
        for _ in range(20):
            await asyncio.sleep(0)
        before = flight.looks
        for _ in range(20):
            await asyncio.sleep(0)
        assert flight.looks == before
        third = watch.watch("f", flight.look)
        assert await anext(third) == f"step {before + 1}"
        await third.aclose()  # type: ignore[attr-defined]
        return before

    assert _run(run()) >= 1
