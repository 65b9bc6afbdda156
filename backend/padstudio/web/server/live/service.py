"""The live sessions of a server: started, watched, ended when nobody watches."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any, Literal

from padstudio.errors import LimitError, NotFoundError
from padstudio.live.watched.order import LiveOrder, Told
from padstudio.store.database.data_folder import new_id
from padstudio.web.server.live.process import LiveProcess, over
from padstudio.workers.inside import Limits

State = Literal["starting", "running", "failed", "idle"]
_OPEN = ("starting", "running")
# Sessions that are over and still told of.
_KEPT = 5
_LOOK_EVERY_S = 1.0
# Sessions get this long to end with the server; what they record survives in any case.
_CLOSE_S = 1.0
# Between the server, at 0, and the workers.
_NICENESS = 5
_DIED = {
    "code": "worker_crashed",
    "message": "the session's process died, most likely for lack of memory or of a damaged stream; "
    "start it again",
}
_IDLE = {
    "code": "live_unwatched",
    "message": "the session was ended because nobody watched it; start it again",
}


@dataclass(kw_only=True, eq=False)
class LiveSession:
    """One session; fields as of `padstudio.web.schemas.live.LiveInfo`.

    Attributes
    ----------
    source : str
        What is read, without a password.
    pads : list of dict
        Id and name of each.
    camera : dict
        Its id and name.
    told : dict
        What its process said last, as of `padstudio.live.watched.session.WatchedSession.state`.
    pose : dict or None
        Number and record of the newest frame.
    """

    source: str
    pads: list[dict[str, str]]
    camera: dict[str, str]
    id: str = field(default_factory=new_id)
    created_at: datetime = field(default_factory=lambda: datetime.now(UTC))
    state: State = "starting"
    error: dict[str, Any] | None = None
    told: dict[str, Any] = field(default_factory=dict)
    pose: dict[str, Any] | None = None
    process: LiveProcess | None = field(default=None, repr=False)
    watched_s: float = field(default_factory=time.monotonic)
    changed: asyncio.Event = field(default_factory=asyncio.Event, repr=False)

    @property
    def is_open(self) -> bool:
        """True until it is over."""
        return self.state in _OPEN

    async def call(self, name: str, *args: Any) -> Any:
        """Ask its process; raises as `LiveProcess.call`."""
        self.watched_s = time.monotonic()
        if self.process is None or not self.is_open:
            raise over()
        try:
            return await self.process.call(name, *args)
        finally:
            self.watched_s = time.monotonic()

    def take(self, told: Told | None) -> None:
        """Note what its process says; None where that has ended."""
        if not self.is_open:
            return
        if told is None:
            self._close("failed", _DIED)
        elif told.kind == "failed":
            self._close("failed", dict(told.values))
        elif told.kind == "pose":
            self.pose = told.values
        else:
            if self.state == "starting":
                self.watched_s = time.monotonic()
            self.state, self.told = "running", told.values
        self.wake()

    def wake(self) -> None:
        """Tell all who watch that something has changed."""
        before, self.changed = self.changed, asyncio.Event()
        before.set()

    def _close(self, state: State, error: dict[str, Any]) -> None:
        self.state, self.error = state, {"detail": {}, **error}

    def end_idle(self) -> None:
        """Nobody watches it."""
        self._close("idle", _IDLE)
        self.wake()


class LiveService:
    """All sessions; for one event loop.

    Parameters
    ----------
    most : int
        Sessions at a time.
    idle_s : float
        After so long without a watcher a session is ended.
    memory_bytes : int
        That each may take.
    """

    def __init__(self, most: int, idle_s: float, memory_bytes: int) -> None:
        self._most, self._idle_s = most, idle_s
        self._limits = Limits(memory_bytes, _NICENESS)
        self._sessions: dict[str, LiveSession] = {}
        self._reaper: asyncio.Task[None] | None = None

    def list(self) -> list[LiveSession]:
        """All that are known, the newest first."""
        return list(reversed(self._sessions.values()))

    def get(self, session_id: str) -> LiveSession:
        """One of them; raises `NotFoundError`."""
        if session_id not in self._sessions:
            raise NotFoundError("there is no live session of that id; start another one")
        return self._sessions[session_id]

    def start(self, session: LiveSession, order: LiveOrder) -> None:
        """Start a session's process.

        Raises
        ------
        LimitError
            If as many sessions as may be are open.
        """
        if sum(other.is_open for other in self._sessions.values()) >= self._most:
            raise LimitError(
                f"{self._most} live sessions are open, the limit; stop one of them",
                code="too_many_live",
            )
        gone = [other.id for other in self._sessions.values() if not other.is_open]
        for other_id in gone[: max(0, len(gone) - _KEPT + 1)]:
            del self._sessions[other_id]
        session.process = LiveProcess(order, self._limits, session.take)
        self._sessions[session.id] = session
        if self._reaper is None:
            self._reaper = asyncio.create_task(self._reap())

    async def stop(self, session_id: str) -> None:
        """End one and forget it; raises as `get`."""
        session = self.get(session_id)
        del self._sessions[session_id]
        await self._let_go(session)

    async def watch(self, session: LiveSession) -> AsyncIterator[None]:
        """Gives at once, and whenever something of a session has changed, until it is over."""
        while True:
            changed = session.changed
            session.watched_s = time.monotonic()
            yield
            if not session.is_open or session.id not in self._sessions:
                return
            while not changed.is_set():
                session.watched_s = time.monotonic()
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(changed.wait(), _LOOK_EVERY_S)

    async def close(self) -> None:
        """End all of them."""
        if self._reaper is not None:
            self._reaper.cancel()
        sessions = self.list()
        self._sessions.clear()
        await asyncio.gather(*(self._let_go(session, _CLOSE_S) for session in sessions))

    async def _let_go(self, session: LiveSession, *within_s: float) -> None:
        process, session.process = session.process, None
        if session.is_open:
            session.state = "idle"
        session.wake()
        if process is not None:
            await asyncio.to_thread(process.leave, *within_s)

    async def _reap(self) -> None:
        """End sessions that nobody watches, and let go of processes of those that are over."""
        while True:
            await asyncio.sleep(min(_LOOK_EVERY_S, self._idle_s))
            for session in self.list():
                unwatched_s = time.monotonic() - session.watched_s
                is_unwatched = unwatched_s > self._idle_s and session.state == "running"
                if is_unwatched and not self._records(session):
                    session.end_idle()
                if not session.is_open and session.process is not None:
                    process, session.process = session.process, None
                    await asyncio.to_thread(process.leave)

    @staticmethod
    def _records(session: LiveSession) -> bool:
        recording = session.told.get("recording")
        return bool(recording and recording["is_on"])
