"""The process of one session: takes calls over a pipe, and says how the session fares."""

from __future__ import annotations

import logging
import os
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from typing import Any

from padstudio.errors import StudioError
from padstudio.live.reports.source import FrameSource
from padstudio.live.stream.live_stream import LiveStream
from padstudio.live.stream.options import StreamOptions
from padstudio.live.watched.order import LiveOrder, Told
from padstudio.live.watched.pushed import PushedFrames
from padstudio.live.watched.recording import RecordingSwitch
from padstudio.live.watched.session import WatchedSession
from padstudio.workers.inside import Limits, known_fault, portable, settle

# Calls that are answered at a time: one frame that is read, and watchers that wait for the next.
_CALLS = 6
#: Methods of `WatchedSession` that may be called.
CALLS = ("push", "newest", "frame", "frames", "picture", "record", "stop_recording")
_log = logging.getLogger(__name__)


def serve(pipe: Connection, order: LiveOrder, limits: Limits) -> None:
    """The process: holds the session until the pipe closes, or the session ends."""
    settle(limits)
    sending = threading.Lock()

    def send(message: Any) -> None:
        try:
            with sending:
                pipe.send(message)
        except OSError:
            os._exit(1)  # nobody is left to hold it for

    try:
        session, source = _begun(order, lambda told: send(("told", told)))
    except Exception as error:
        send(("told", _failure(error)))
        return

    def run(work: Callable[[], None]) -> None:
        try:
            work()
        except Exception as error:
            send(("told", _failure(error)))
        else:
            return
        os._exit(1)

    works = [session.read, session.say, session.check]
    if order.address is not None:
        works.append(session.keep)
    threads = [threading.Thread(target=run, args=(work,), daemon=True) for work in works]
    for thread in threads:
        thread.start()
    _answer(pipe, session, send)
    source.close()
    session.stop_recording()
    for thread in threads:
        thread.join()


def _begun(order: LiveOrder, tell: Callable[[Told], None]) -> tuple[WatchedSession, FrameSource]:
    recording = RecordingSwitch()
    source: FrameSource = PushedFrames()
    if order.address is not None:
        options = StreamOptions(max_pixels=order.max_pixels)
        source = LiveStream(order.address, options, taps=[recording])
    return WatchedSession(order, source, recording, tell), source


def _answer(pipe: Connection, session: WatchedSession, send: Callable[[Any], None]) -> None:
    """Answer calls until the pipe closes."""

    def answer(number: int, name: str, args: tuple[Any, ...]) -> None:
        try:
            send((number, "value", getattr(session, name)(*args)))
        except StudioError as error:
            send((number, "error", portable(error)))
        except Exception as error:
            known = known_fault(error)
            send((number, "error", known) if known else (number, "defect", traceback.format_exc()))

    with ThreadPoolExecutor(_CALLS) as threads:
        while True:
            try:
                call = pipe.recv()
            except (EOFError, OSError):
                call = None
            if call is None:
                session.close()  # whoever waits for a frame waits no longer
                return
            assert call[1] in CALLS, call[1]
            threads.submit(answer, *call)


def _failure(error: Exception) -> Told:
    known = error if isinstance(error, StudioError) else known_fault(error)
    if known is not None:
        return Told("failed", {"code": known.error_code, "message": known.message})
    _log.error("a live session failed", exc_info=error)
    return Told(
        "failed",
        {
            "code": "internal_error",
            "message": "the session met a fault of the program, and logged it",
        },
    )
