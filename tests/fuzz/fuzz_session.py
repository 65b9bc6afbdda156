"""One reader under fuzzing: which lines files reach, and which files are changed further."""

from __future__ import annotations

import contextlib
import random
import resource
import signal
import sys
import time
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

from fuzz_mutate import MOST_BYTES, mutated
from fuzz_targets import Target, outcome

_OURS = f"{Path('padstudio')}/"
# Tries to make a finding smaller.
_TRIES = 300


@dataclass(frozen=True)
class Limits:
    """What a small file may cost: more is a finding."""

    cpu_s: float = 10.0
    memory_bytes: int = 6_000_000_000


class TooSlowError(BaseException):
    """A file took more than its time; no reader catches it."""


class Session:
    """Reads files and keeps those that reach what no file before did.

    Parameters
    ----------
    target : Target
    chance : random.Random
    limits : Limits
    current : Path
        Where each file lies while it is read, for who finds the process dead.
    """

    def __init__(
        self, target: Target, chance: random.Random, limits: Limits, current: Path
    ) -> None:
        self._target, self._chance, self._limits, self._current = target, chance, limits, current
        self._reached: set[tuple[CodeType, int]] = set()
        self._kept: list[tuple[bytes, frozenset[tuple[CodeType, int]]]] = []
        self.files = 0
        resource.setrlimit(resource.RLIMIT_AS, (limits.memory_bytes, limits.memory_bytes))
        signal.signal(signal.SIGVTALRM, _too_slow)

    @property
    def lines(self) -> int:
        """Lines of the program that were reached."""
        return len(self._reached)

    def next(self) -> bytes:
        """A changed file; the later ones are changed more often."""
        last = len(self._kept) - 1
        place = last - int(abs(self._chance.triangular(-last, last, 0))) if last > 0 else 0
        others = [data for data, _ in self._kept] or [b""]
        return mutated(others[place], others, self._chance)

    def look(self, data: bytes) -> str | None:
        """Read a file; the traceback where that is a finding."""
        data = data[:MOST_BYTES]
        self.files += 1
        self._current.write_bytes(data)
        lines: set[tuple[CodeType, int]] = set()
        with _traced(lines):
            fault = self._fault(data)
        if not lines <= self._reached:
            self._reached |= lines
            self._kept.append((data, frozenset(lines)))
        return fault

    def smaller(self, data: bytes, fault: str) -> bytes:
        """A part of a file that has the same last line of the fault."""
        end = fault.splitlines()[-1]
        size = len(data) // 2
        for _ in range(_TRIES):
            if not size or len(data) < 2:
                break
            at = self._chance.randrange(max(1, len(data) - size + 1))
            less = data[:at] + data[at + size :]
            found = self._fault(less)
            if found and found.splitlines()[-1] == end:
                data = less
            elif self._chance.random() < 0.2:
                size //= 2
        return data

    def smallest(self, most: int, most_bytes: int) -> list[bytes]:
        """Few small files that together reach what all small ones do."""
        left = sorted((k for k in self._kept if len(k[0]) <= most_bytes), key=lambda k: len(k[0]))
        chosen: list[bytes] = []
        reached: set[tuple[CodeType, int]] = set()
        while left and len(chosen) < most:
            data, lines = max(left, key=lambda k: (len(k[1] - reached), -len(k[0])))
            if lines <= reached:
                break
            chosen.append(data)
            reached |= lines
        return chosen

    def _fault(self, data: bytes) -> str | None:
        begun = time.process_time()
        signal.setitimer(signal.ITIMER_VIRTUAL, self._limits.cpu_s)
        try:
            outcome(self._target, data)
        except (Exception, TooSlowError):
            return traceback.format_exc()
        finally:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        if time.process_time() - begun > self._limits.cpu_s:
            return f"it took {self._limits.cpu_s:g} s and more"
        return None


def _too_slow(_signal: int, _frame: FrameType | None) -> None:
    raise TooSlowError


@contextlib.contextmanager
def _traced(lines: set[tuple[CodeType, int]]) -> Iterator[None]:
    """Note the program's own lines."""
    ours: dict[CodeType, bool] = {}

    def line(frame: FrameType, _event: str, _argument: Any) -> Any:
        lines.add((frame.f_code, frame.f_lineno))
        return line

    def call(frame: FrameType, _event: str, _argument: Any) -> Any:
        code = frame.f_code
        if code not in ours:
            ours[code] = _OURS in code.co_filename
        return line if ours[code] else None

    sys.settrace(call)
    try:
        yield
    finally:
        sys.settrace(None)
