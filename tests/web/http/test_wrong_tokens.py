"""How long wrong tokens wait for their answer."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from padstudio.errors import BusyError
from padstudio.web.http.wrong_tokens import WrongTokens


def _run(coroutine: Coroutine[Any, Any, Any]) -> Any:
    """Its result; in a thread, as a browser of other tests may have a loop in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


class Clock:
    """Time that goes by as somebody sleeps."""

    def __init__(self) -> None:
        self.now_s = 50.0
        self.slept: list[float] = []

    async def sleep(self, seconds: float) -> None:
        self.slept.append(seconds)
        self.now_s += seconds


def _guess(times: int, clock: Clock, tokens: WrongTokens) -> None:
    async def guess() -> None:
        for _ in range(times):
            await tokens.slow_down()

    _run(guess())


def test_typing_errors_do_not_wait_and_guesses_wait_ever_longer() -> None:
    clock = Clock()
    _guess(200, clock, WrongTokens(lambda: clock.now_s, clock.sleep))
    assert clock.slept[:5] == [0.0] * 5
    assert clock.slept[5:20] == sorted(clock.slept[5:20])
    # Who guesses one after the other has few tries a minute.
    assert 200 / (clock.now_s - 50.0) < 1


def test_guesses_at_the_same_time_wait_the_longest() -> None:
    clock = Clock()
    frozen = WrongTokens(lambda: 0.0, clock.sleep)
    _guess(200, clock, frozen)
    assert max(clock.slept) == clock.slept[-1] == 10.0


def test_errors_are_forgotten() -> None:
    clock = Clock()
    tokens = WrongTokens(lambda: clock.now_s, clock.sleep)
    _guess(50, clock, tokens)
    clock.now_s += 600
    _guess(1, clock, tokens)
    assert clock.slept[-1] == 0.0


def test_no_more_wait_than_connections_can_be_spared() -> None:
    async def run() -> int:
        async def forever(_: float) -> None:
            await asyncio.Event().wait()

        tokens = WrongTokens(lambda: 0.0, forever)
        waiting = []
        refused = 0
        while not refused and len(waiting) < 5000:
            waiting.append(asyncio.ensure_future(tokens.slow_down()))
            await asyncio.sleep(0)
            if waiting[-1].done():
                with pytest.raises(BusyError):
                    waiting[-1].result()
                refused = len(waiting)
        for task in waiting:
            task.cancel()
        return refused

    assert 100 < _run(run()) < 1000
