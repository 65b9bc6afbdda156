"""One place for the newest item: who is slow finds the newest one, never an old one."""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Mailbox(Generic[T]):
    """Holds the newest item that was not taken yet."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._item: T | None = None
        self._is_closed = False

    def put(self, item: T) -> bool:
        """Lay an item here; False where it takes the place of one that nobody took."""
        with self._changed:
            was_taken = self._item is None
            self._item = item
            self._changed.notify()
        return was_taken

    def take(self, timeout_s: float) -> T | None:
        """The newest item, waiting for it; None where none came, or when closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._item is not None or self._is_closed, timeout_s)
            item, self._item = self._item, None
            return item

    @property
    def is_full(self) -> bool:
        """True where an item waits."""
        with self._changed:
            return self._item is not None

    def clear(self) -> bool:
        """Let go of an item that nobody took; whether there was one."""
        with self._changed:
            item, self._item = self._item, None
            return item is not None

    def close(self) -> None:
        """Let go of the item and of who waits."""
        with self._changed:
            self._item, self._is_closed = None, True
            self._changed.notify_all()
