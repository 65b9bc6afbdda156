"""Runs an iterator in a thread of its own, a few items ahead of who takes them.

Decoders let go of the interpreter's lock while they work, and so do the detector's loops: one
thread for each keeps two cores busy. Where they share a core, each works on several items at a
time, as what one has in the caches the other displaces. What is made, and in which order, does not
depend on when.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Generator
from typing import Generic, TypeVar

T = TypeVar("T")
# While nothing comes, `pause` is called about so often.
_PAUSE_EVERY_S = 0.005


class ReadAhead(Generic[T]):
    """Items of a generator, made ahead of time; to be closed, as by `contextlib.closing`.

    Parameters
    ----------
    source : generator
        Runs in the thread from its first step to its last, and is closed there.
    most : int
        Items that may wait to be taken; they are handed over when they are so many, or the last
        ones. With the one that is taken and the one being made, that many and two more exist.
    pause : callable
        Called while no item is ready, in the thread that takes them, where what it raises goes on.
    """

    def __init__(
        self,
        source: Generator[T],
        most: int,
        pause: Callable[[], object] = lambda: None,
    ) -> None:
        self._source, self._most, self._pause = source, most, pause
        self._changed = threading.Condition()
        self._made: deque[T] = deque()
        self._error: BaseException | None = None
        self._is_over = self._is_closed = self._is_full = False
        self._thread = threading.Thread(target=self._run, name="read ahead", daemon=True)
        self._thread.start()

    def __iter__(self) -> ReadAhead[T]:
        return self

    def __next__(self) -> T:
        """The next item; raises what the source raised, after all items made before."""
        while not self._wait_for_item():
            self._pause()
        with self._changed:
            if self._made:
                item = self._made.popleft()
                if not self._made:
                    self._is_full = False
                    self._changed.notify_all()
                return item
            error, self._error = self._error, None
        if error is not None:
            raise error
        raise StopIteration

    def close(self) -> None:
        """Let go of items not taken, and wait until the source is closed."""
        with self._changed:
            self._is_closed = True
            self._made.clear()
            self._changed.notify_all()
        self._thread.join()

    def _wait_for_item(self) -> bool:
        """False where none came for a while; True too where none will come any more."""
        with self._changed:
            return self._changed.wait_for(
                lambda: self._is_full or self._is_over or self._is_closed, _PAUSE_EVERY_S
            )

    def _run(self) -> None:
        error: BaseException | None = None
        try:
            for item in self._source:
                if not self._offer(item):
                    break
                del item
            self._source.close()
        except BaseException as raised:
            error = raised
        with self._changed:
            self._error, self._is_over = error, True
            self._changed.notify_all()

    def _offer(self, item: T) -> bool:
        """Wait for room; False where nobody takes items any more."""
        with self._changed:
            self._changed.wait_for(lambda: not self._is_full or self._is_closed)
            if not self._is_closed:
                self._made.append(item)
                self._is_full = len(self._made) >= self._most
                if self._is_full:
                    self._changed.notify_all()
            return not self._is_closed
