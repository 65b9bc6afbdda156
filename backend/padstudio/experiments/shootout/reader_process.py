"""A reader's own process, as seen from outside: it may crash or hang, and costs one frame."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable
from typing import Any

from padstudio.experiments.shootout.child import ONE_THREAD


class ReaderLostError(Exception):
    """The process died, or was ended as its time was over; the text says which."""


class ReaderFailedError(Exception):
    """What was called raised; the text has the error."""


class ReaderProcess:
    """Calls functions in a process with one thread; use it as a context.

    The process is a program of its own and no `multiprocessing.Process`, which a worker of the
    studio's own may not start.
    """

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "padstudio.experiments.shootout.child"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=os.environ | ONE_THREAD,
        )
        self._is_over_time = False

    def __enter__(self) -> ReaderProcess:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                try:
                    pipe.close()
                except BrokenPipeError:
                    continue
        self._process.wait()

    def call(self, limit_s: float, function: Callable[..., Any], *args: Any) -> Any:
        """What a function gives there.

        Parameters
        ----------
        limit_s : float
            Seconds after which the process is ended.
        function : callable
            Importable by name.
        *args : object
            Picklable.

        Raises
        ------
        ReaderLostError, ReaderFailedError
        """
        asked, answers = self._process.stdin, self._process.stdout
        assert asked is not None
        assert answers is not None
        packed = pickle.dumps((limit_s, function, args))
        timer = threading.Timer(limit_s, self._end_late)
        timer.start()
        try:
            asked.write(packed)
            asked.flush()
            kind, value = pickle.load(answers)
        except (EOFError, OSError, pickle.UnpicklingError):
            raise ReaderLostError(self._reason(limit_s)) from None
        finally:
            timer.cancel()
        if kind == "error":
            raise ReaderFailedError(value)
        return value

    def _reason(self, limit_s: float) -> str:
        code = self._process.wait()
        if self._is_over_time:
            return f"took longer than {limit_s:g} s and was ended"
        return f"died of signal {-code}" if code < 0 else f"ended with code {code}"

    def _end_late(self) -> None:
        self._is_over_time = True
        self._end()

    def _end(self) -> None:
        self._process.kill()
