"""Calls who wants to know that a flight has ended, again and again until it is taken."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future, wait
from datetime import UTC, datetime
from functools import cached_property

import httpx

from padstudio import __version__
from padstudio.errors import StudioError
from padstudio.flights.callbacks import Callbacks, DueCallback
from padstudio.store.database.engine import DatabaseFault
from padstudio.web.server.callbacks import signing
from padstudio.web.server.callbacks.hosts import (
    CallbackError,
    CallbackHosts,
    host_of,
    port_of,
    resolve,
)

logger = logging.getLogger(__name__)

#: Waits after each attempt but the last: a day and some hours in all.
WAITS_S = (5.0, 60.0, 300.0, 1800.0, 7200.0, 18_000.0, 36_000.0, 36_000.0)
_LOOK_S = 1.0
# Where nobody may be called, there can only be orders of an earlier server, to be refused.
_REST_S = 30.0
_AT_A_TIME = 4
_TIMEOUT_S = 10.0


class CallbackService:
    """One thread that makes the callbacks that are due.

    Parameters
    ----------
    callbacks : Callbacks
    hosts : CallbackHosts
        Asked again before each attempt, as settings may have changed.
    secret : str
    resolve_host : callable
        As `padstudio.web.server.callbacks.hosts.resolve`.
    waits_s : sequence of float, optional
        `WAITS_S`, or other waits.
    """

    def __init__(
        self,
        callbacks: Callbacks,
        hosts: CallbackHosts,
        secret: str,
        *,
        resolve_host: Callable[[str, int], str] = resolve,
        waits_s: Sequence[float] | None = None,
    ) -> None:
        self._callbacks, self._hosts, self._secret = callbacks, hosts, secret
        self._resolve = resolve_host
        self._waits_s = WAITS_S if waits_s is None else waits_s
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="callbacks", daemon=True)

    def start(self) -> None:
        """Begin, with what an earlier server left undelivered."""
        self._thread.start()

    def close(self) -> None:
        """Stop; what is not known to be delivered is tried again at the next start."""
        self._closing.set()
        if self._thread.is_alive():
            self._thread.join()

    def make_due(self) -> int:
        """Make the callbacks that are due, and wait for their answers; how many there were."""
        due = self._callbacks.due(_AT_A_TIME)
        attempts = [_begin(self._make, each) for each in due]
        for attempt in attempts:
            while not (attempt.done() or self._closing.is_set()):
                wait([attempt], _LOOK_S / 10)
            if attempt.done():
                attempt.result()
        return len(due)

    def _run(self) -> None:
        while not self._closing.wait(_LOOK_S if self._hosts else _REST_S):
            try:
                while not self._closing.is_set() and self.make_due():
                    pass
            except DatabaseFault:
                logger.exception("the database cannot be used; callbacks are tried again")

    def _make(self, due: DueCallback) -> None:
        is_last = due.attempts >= len(self._waits_s)
        # After the last one it is only tried again where the server ended in the middle of it.
        wait_s = self._waits_s[min(due.attempts, len(self._waits_s) - 1)]
        if not self._callbacks.begin(due, wait_s):
            return
        try:
            self._send(due)
        except CallbackError as error:
            self._callbacks.failed(due, error.message, is_last=is_last)
            logger.warning("callback of flight %s: %s", due.flight.id, error.message)
        else:
            self._callbacks.delivered(due)

    def _send(self, due: DueCallback) -> None:
        """Call once, at the address that was looked at; raises `CallbackError` where it fails."""
        try:
            url = self._hosts.check(due.url)
        except StudioError as error:
            raise CallbackError(error.message) from error
        host = host_of(url)
        pinned = url.copy_with(host=self._resolve(host, port_of(url)))
        body = signing.message(due.flight)
        headers = signing.headers(self._secret, due.delivery, body, datetime.now(UTC))
        headers |= {
            "Host": url.netloc.decode("ascii"),
            "Content-Type": "application/json",
            "User-Agent": f"padstudio/{__version__}",
        }
        target = {"sni_hostname": host}
        try:
            # What it answers beside the status is nothing to us, however long it is.
            with self._client.stream(
                "POST", pinned, content=body, headers=headers, extensions=target
            ) as answer:
                status = answer.status_code
        except httpx.HTTPError as error:
            raise CallbackError(f"{host} cannot be reached: {type(error).__name__}") from error
        if not 200 <= status < 300:
            raise CallbackError(f"{host} answered with status {status}")

    @cached_property
    def _client(self) -> httpx.Client:
        # A proxy or a redirect would lead elsewhere than to the address that was looked at.
        return httpx.Client(
            verify=httpx.create_ssl_context(),
            trust_env=False,
            follow_redirects=False,
            timeout=_TIMEOUT_S,
            limits=httpx.Limits(max_keepalive_connections=0),
        )


def _begin(make: Callable[[DueCallback], None], due: DueCallback) -> Future[None]:
    """Make a callback in a thread that does not keep the server from ending, as executors' do."""
    attempt: Future[None] = Future()

    def run() -> None:
        try:
            make(due)
        except BaseException as error:
            attempt.set_exception(error)
        else:
            attempt.set_result(None)

    threading.Thread(target=run, name="callback", daemon=True).start()
    return attempt
