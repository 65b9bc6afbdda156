"""The server that is harmed: started again whenever it is gone, as a service manager does."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from pathlib import Path

import httpx
import psutil

PROGRAM = Path(sys.executable).with_name("padstudio")
_GONE_S = 60
# So long a start may take, however busy the machine is.
_STARTED_S = 600


class SoakServer:
    """A server's process, in a group of its own.

    Parameters
    ----------
    data, log : Path
    environment : dict of str to str
        Beside that of this process.

    Attributes
    ----------
    starts, failed_starts : int
    codes : list of int
        With which it ended by itself or when it was told to.
    """

    def __init__(self, data: Path, log: Path, environment: dict[str, str]) -> None:
        self._log = log
        self._environment = os.environ | environment
        self._command = [str(PROGRAM), "serve", "--port", "0", "--data", str(data)]
        self._process: subprocess.Popen[str] | None = None
        self.client = httpx.Client()
        self.starts, self.failed_starts = 0, 0
        self.codes: list[int] = []

    def see_that_it_runs(self) -> bool:
        """Start it where it is gone; False where that fails."""
        if self._process is not None and self._process.poll() is None:
            return True
        self._reap()
        with self._log.open("a", encoding="utf-8") as log:
            self._process = subprocess.Popen(
                self._command,
                env=self._environment,
                start_new_session=True,
                stderr=subprocess.PIPE,
                text=True,
            )
            assert self._process.stderr is not None
            told = self._process.stderr.readline()
            log.write(told)
        self.starts += 1
        words = [word for word in told.split() if word.startswith("http://")]
        if not words:
            self.failed_starts += 1
            return False
        _copy(self._process, self._log)
        self.client.close()
        self.client = httpx.Client(base_url=words[0], timeout=120, trust_env=False)
        return True

    def workers(self) -> list[psutil.Process]:
        """Its worker processes."""
        with contextlib.suppress(psutil.Error):
            if self._process is not None:
                children = psutil.Process(self._process.pid).children(recursive=True)
                return [child for child in children if "spawn_main" in " ".join(child.cmdline())]
        return []

    def kill(self) -> None:
        """End the server's process alone, as for lack of memory."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()

    def kill_group(self) -> None:
        """End it with all that it started."""
        if self._process is not None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()

    def end(self) -> int | None:
        """Tell it to end; its exit code, or None where it had to be killed."""
        assert self._process is not None
        self._process.terminate()
        try:
            self.codes.append(self._process.wait(_GONE_S))
        except subprocess.TimeoutExpired:
            self.kill_group()
            return None
        return self.codes[-1]

    def second(self) -> tuple[int, str]:
        """Start another one on the same folder: its exit code, and what it said."""
        try:
            done = subprocess.run(
                self._command,
                env=self._environment,
                stderr=subprocess.PIPE,
                text=True,
                timeout=_STARTED_S,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return 0, "it runs"
        return done.returncode, done.stderr.strip()

    def _reap(self) -> None:
        """Leave nothing of the last one behind."""
        if self._process is not None and self._process.stderr is not None:
            self._process.stderr.close()


def _copy(process: subprocess.Popen[str], log: Path) -> None:
    """What a server says goes to a file, by a process that ends with it."""
    with log.open("a", encoding="utf-8") as file:
        subprocess.Popen(["cat"], stdin=process.stderr, stdout=file)
