"""What is read ahead comes in order, never too much of it, with errors in their place."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Generator

import pytest

from padstudio.media.read_ahead import ReadAhead

WAIT_S = 10.0


class Counted:
    """Numbers 0 … count − 1, with what is known of who makes them."""

    def __init__(self, count: int, error: BaseException | None = None) -> None:
        self.count, self.error = count, error
        self.made = 0
        self.changed = threading.Condition()
        self.threads: set[int] = set()
        self.is_closed = False

    def __call__(self) -> Generator[int]:
        self.threads.add(threading.get_ident())
        try:
            for number in range(self.count):
                with self.changed:
                    self.made = number + 1
                    self.changed.notify_all()
                yield number
            if self.error is not None:
                raise self.error
        finally:
            self.threads.add(threading.get_ident())
            self.is_closed = True

    def wait_until_made(self, count: int) -> None:
        with self.changed:
            assert self.changed.wait_for(lambda: self.made >= count, WAIT_S)


def test_items_come_in_order_from_another_thread() -> None:
    source = Counted(200)
    with contextlib.closing(ReadAhead(source(), 3)) as items:
        assert list(items) == list(range(200))
    assert len(source.threads) == 1
    assert threading.get_ident() not in source.threads


@pytest.mark.parametrize("most", [1, 3])
def test_so_many_wait_and_no_more(most: int) -> None:
    source = Counted(50)
    with contextlib.closing(ReadAhead(source(), most)) as items:
        source.wait_until_made(most + 1)
        for number in items:
            # Some wait, handed over together, and one more has no room until all are taken.
            handed_over = number - number % most + most
            assert source.made <= handed_over + 1 + most * (number % most == most - 1)
            source.wait_until_made(min(handed_over, 50))


def test_items_are_handed_over_together_and_the_last_ones_too() -> None:
    source = Counted(8)
    with contextlib.closing(ReadAhead(source(), 3)) as items:
        assert next(items) == 0
        assert source.made >= 3
        assert list(items) == list(range(1, 8))


@pytest.mark.parametrize("error", [ValueError("broken"), SystemExit(3)])
def test_an_error_comes_behind_what_was_made_before(error: BaseException) -> None:
    source, seen = Counted(5, error), []
    with contextlib.closing(ReadAhead(source(), 9)) as items:
        source.wait_until_made(5)
        with pytest.raises(type(error)) as caught:
            seen.extend(items)  # `extend` takes them one by one
        assert caught.value is error
        assert list(items) == []
    assert seen == list(range(5))


def test_closing_ends_the_source_wherever_it_is() -> None:
    for taken in (0, 1, 7):
        source = Counted(1_000_000)
        items = ReadAhead(source(), 2)
        for _ in range(taken):
            next(items)
        source.wait_until_made(taken + 1)
        items.close()
        assert source.is_closed
        assert source.made <= taken + 3
        assert list(items) == []


def test_who_waits_is_asked_meanwhile_and_may_give_up() -> None:
    begun, go_on = threading.Event(), threading.Event()
    closed = threading.Event()

    def slow() -> Generator[int]:
        begun.set()
        try:
            go_on.wait(WAIT_S)
            yield 1
        finally:
            closed.set()

    def give_up() -> None:
        assert threading.get_ident() == here
        assert begun.wait(WAIT_S)
        go_on.set()
        raise KeyError("enough")

    here = threading.get_ident()
    with (
        pytest.raises(KeyError, match="enough"),
        contextlib.closing(ReadAhead(slow(), 2, give_up)) as items,
    ):
        next(items)
    assert closed.is_set()
