"""Parts frames where another pad is followed, whose poses are in a frame of their own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import groupby
from typing import TypeVar

T = TypeVar("T")


def by_pad(items: Iterable[T], pad_of: Callable[[T], str | None]) -> Iterator[Iterator[T]]:
    """Runs of frames that show the same pad, in their order.

    Parameters
    ----------
    items : iterable
    pad_of : callable
        An item's pad; None where it shows none or does not say, which ends no run.
    """
    last: str | None = None

    def followed(item: T) -> str | None:
        nonlocal last
        last = pad_of(item) or last
        return last

    for _, run in groupby(items, key=followed):
        yield run
