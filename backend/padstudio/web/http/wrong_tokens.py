"""Wrong tokens are answered late, so that guessing takes long; right ones never wait."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Awaitable, Callable

from padstudio.errors import BusyError

# The first few may be typing errors; each further one waits longer, s, and all are forgotten by
# and by.
_FREE, _STEP_S, _LONGEST_S, _FORGET_S = 5, 0.2, 10.0, 60.0
# Each that waits holds a connection.
_MOST_WAITING = 500


class WrongTokens:
    """Makes who sent a wrong token wait, the longer the more came lately, from wherever.

    Only answers that say no are delayed: nobody can lock out who has the token.

    Parameters
    ----------
    now : callable
        The time, s.
    sleep : callable
        As `asyncio.sleep`.
    """

    def __init__(
        self,
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], Awaitable[object]] = asyncio.sleep,
    ) -> None:
        self._now, self._sleep = now, sleep
        self._lately, self._counted_s, self._waiting = 0.0, now(), 0

    async def slow_down(self) -> None:
        """Wait before a wrong token is answered.

        Raises
        ------
        BusyError
            If too many wait already.
        """
        now_s = self._now()
        self._lately = 1 + self._lately * math.exp((self._counted_s - now_s) / _FORGET_S)
        self._counted_s = now_s
        if self._waiting >= _MOST_WAITING:
            raise BusyError(
                "too many wrong tokens came of late; try again with the right one",
                code="too_many_wrong_tokens",
            )
        self._waiting += 1
        try:
            await self._sleep(min(_LONGEST_S, _STEP_S * max(0.0, self._lately - _FREE)))
        finally:
            self._waiting -= 1
