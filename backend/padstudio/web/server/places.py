"""How many event streams there may be at a time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from padstudio.errors import BusyError


class Places:
    """So many streams at a time; of one event loop.

    Parameters
    ----------
    most : int
    """

    def __init__(self, most: int) -> None:
        self._most, self._taken = most, 0

    @contextmanager
    def taken(self) -> Iterator[None]:
        """Take a place while the block lasts.

        Raises
        ------
        BusyError
            If none is free.
        """
        if self._taken >= self._most:
            raise BusyError(
                f"{self._most} event streams are open, as many as the server takes; close pages "
                "that are not looked at, or ask for the state from time to time instead",
                code="too_many_streams",
            )
        self._taken += 1
        try:
            yield
        finally:
            self._taken -= 1
