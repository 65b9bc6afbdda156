"""A session's process as the server sees it."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import multiprocessing
import threading
from collections.abc import Callable
from typing import Any

from padstudio.errors import ConflictError
from padstudio.live.watched import process
from padstudio.live.watched.order import LiveOrder, Told
from padstudio.workers.inside import Limits
from padstudio.workers.process import NO_ROOM, NoWorkerError

# A fork of a threaded server may inherit locks that nobody will release.
_context = multiprocessing.get_context("spawn")
# A stream lets go of its socket within this time; then the process is ended.
_LEAVE_S = 3.0
_log = logging.getLogger(__name__)


def over() -> ConflictError:
    """What a session that is over answers with."""
    return ConflictError("this session is over; start another one", code="live_over")


class LiveProcess:
    """One process and the pipe to it; for one event loop.

    Parameters
    ----------
    order : LiveOrder
    limits : Limits
    told : callable
        Takes what the process says of its own accord; None where it has ended. Called in the event
        loop.

    Raises
    ------
    NoWorkerError
        If the system has no room for it.
    """

    def __init__(
        self, order: LiveOrder, limits: Limits, told: Callable[[Told | None], None]
    ) -> None:
        self._loop, self._told = asyncio.get_running_loop(), told
        self._calls: dict[int, asyncio.Future[Any]] = {}
        self._number = 0
        self._is_over = False
        self._sending = threading.Lock()
        self._thread = threading.Thread(target=self._receive, name="live", daemon=True)
        try:
            self._pipe, other = _context.Pipe()
            self._process = _context.Process(
                target=process.serve, args=(other, order, limits), name="live", daemon=True
            )
            # Where one of them is not there, the other finds its end of the pipe closed.
            try:
                self._thread.start()
                self._process.start()
            finally:
                other.close()
        except NO_ROOM as error:
            raise NoWorkerError.of(error) from error

    @property
    def pid(self) -> int | None:
        """The process's id."""
        return self._process.pid

    async def call(self, name: str, *args: Any) -> Any:
        """What a method of `padstudio.live.watched.session.WatchedSession` gives.

        Raises
        ------
        StudioError
            The method's own.
        ConflictError
            If the process has ended.
        """
        if self._is_over:
            raise over()
        self._number += 1
        number = self._number
        future = self._calls[number] = self._loop.create_future()
        try:
            # A large picture may fill the pipe, and the process may be at another one.
            await asyncio.to_thread(self._send, (number, name, args))
            return await future
        except OSError as error:
            raise over() from error
        finally:
            self._calls.pop(number, None)
            future.cancel()

    def leave(self, within_s: float = _LEAVE_S) -> None:
        """Let it end in peace, and end it where it does not in time; blocks."""
        # Whoever is sending a picture may wait until the one before it has been read.
        if self._sending.acquire(timeout=within_s):
            with contextlib.suppress(OSError):
                self._pipe.send(None)
            self._sending.release()
            self._process.join(within_s)
        self.end()

    def end(self) -> None:
        """End it at once; blocks until it is gone."""
        self._process.kill()
        self._process.join()
        self._thread.join()
        self._pipe.close()

    def _send(self, message: Any) -> None:
        with self._sending:
            self._pipe.send(message)

    def _receive(self) -> None:
        """Hand on what the process says, until its end of the pipe closes."""
        while True:
            try:
                message = self._pipe.recv()
            except (EOFError, OSError):
                break
            self._in_loop(self._take, message)
        self._in_loop(self._ended)

    def _in_loop(self, function: Callable[..., None], *args: Any) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended with the server
            self._loop.call_soon_threadsafe(function, *args)

    def _take(self, message: Any) -> None:
        if message[0] == "told":
            self._told(message[1])
            return
        number, kind, value = message
        future = self._calls.get(number)
        if future is None or future.done():
            return
        if kind == "value":
            future.set_result(value)
        elif kind == "error":
            future.set_exception(value)
        else:
            _log.error("a live session's call failed:\n%s", value)
            future.set_exception(RuntimeError("a live session's call failed; the log says how"))

    def _ended(self) -> None:
        self._is_over = True
        for future in self._calls.values():
            if not future.done():
                future.set_exception(over())
                future.exception()  # whoever still sends finds the pipe closed
        self._told(None)
