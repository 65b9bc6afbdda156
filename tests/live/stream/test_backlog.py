"""What waits for decoding is never late, and what is decoded can be decoded rightly."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.live.stream.backlog import MAX_BYTES, Arrival, Backlog

_LATE_S, _STALE_S = 0.3, 2.0


def arrival(at_s: float, is_keyframe: bool, number: int = 1, size: int = 1) -> Any:
    packet: Any = SimpleNamespace(is_keyframe=is_keyframe, size=size)
    connection: Any = None
    return Arrival(packet, at_s, connection, number)


def backlog(now: list[float]) -> Backlog:
    return Backlog(_LATE_S, _STALE_S, lambda: now[0])


def test_what_is_in_time_comes_in_order() -> None:
    queue = backlog([0.2])
    packets = [arrival(0.0, True), arrival(0.1, False), arrival(0.2, False)]
    for each in packets:
        queue.put(each)
    assert [queue.take() for _ in packets] == [(each, False) for each in packets]
    assert queue.skipped == 0


def play(
    packets: list[Any], work_s: Callable[[int], float]
) -> tuple[list[tuple[float, int]], Backlog]:
    """Decode packets that come at their times, each for so long: how late which was taken."""
    now = [0.0]
    queue = backlog(now)
    # Who takes does not wait then.
    queue.finish()
    coming, taken = deque(packets), []
    while True:
        while coming and coming[0].arrived_s <= now[0]:
            queue.put(coming.popleft())
        found = queue.take()
        if found is not None:
            place = packets.index(found[0])
            taken.append((now[0] - found[0].arrived_s, place))
            now[0] += work_s(place)
        elif coming:
            now[0] = coming[0].arrived_s
        else:
            return taken, queue


def steady(count: int, every_s: float, keyframe_every: int) -> list[Any]:
    return [arrival(every_s * i, i % keyframe_every == 0) for i in range(count)]


_EVERY = st.floats(0.01, 0.1)
_GROUPS = st.integers(1, 40)


@given(_EVERY, _GROUPS, st.floats(1.02, 20.0))
def test_slow_decoding_leaves_latency_bounded(every_s: float, group: int, share: float) -> None:
    packets = steady(200, every_s, group)
    taken, queue = play(packets, lambda _place: every_s * share)
    assert len(taken) + queue.skipped == len(packets)
    work_s, group_s = every_s * share, every_s * group
    for (_, before), (late_s, place) in itertools.pairwise(taken):
        is_keyframe = packets[place].packet.is_keyframe
        # What rests on a frame that was passed over is passed over, too.
        assert place == before + 1 or is_keyframe
        assert is_keyframe or late_s <= _STALE_S
        # When no more come, what is left is decoded.
        if packets[place].arrived_s + late_s < packets[-1].arrived_s:
            assert late_s <= max(_LATE_S, work_s) + 2 * (group_s + work_s)


@given(_EVERY, _GROUPS, st.floats(0.0, 0.98))
def test_fast_decoding_passes_nothing_over(every_s: float, group: int, share: float) -> None:
    packets = steady(100, every_s, group)
    taken, queue = play(packets, lambda _place: every_s * share)
    assert [place for _, place in taken] == list(range(100))
    assert queue.skipped == 0


@given(_EVERY, st.floats(0.0, 0.3), st.floats(0.3, 1.9), st.integers(10, 40))
def test_a_stop_is_made_up_for_where_no_keyframe_comes(
    every_s: float, share: float, stop_s: float, at: int
) -> None:
    packets = steady(400, every_s, 1000)
    taken, queue = play(packets, lambda place: stop_s if place == at else every_s * share)
    assert queue.skipped == 0
    assert taken[-1][0] == pytest.approx(0.0, abs=1e-6)


def test_what_is_late_is_passed_over_up_to_the_newest_keyframe() -> None:
    packets = steady(60, 0.04, 10)
    taken, queue = play(packets, lambda place: 1.0 if place == 12 else 0.001)
    # One second later, the keyframes 20 and 30 have come.
    assert [place for _, place in taken] == [*range(13), *range(30, 60)]
    assert queue.skipped == 17


def test_what_is_stale_is_passed_over_up_to_the_next_keyframe() -> None:
    packets = steady(200, 0.04, 80)
    taken, queue = play(packets, lambda place: 2.5 if place == 2 else 0.001)
    assert [place for _, place in taken] == [0, 1, 2, *range(80, 200)]
    assert queue.skipped == 77


def test_a_new_connection_begins_anew() -> None:
    packets = steady(90, 0.04, 1000)
    packets[70:] = [arrival(each.arrived_s, False, number=2) for each in packets[70:]]
    taken, _ = play(packets, lambda place: 2.5 if place == 2 else 0.039)
    assert [place for _, place in taken] == [0, 1, 2, *range(70, 90)]


def test_what_waits_is_taken_before_the_end() -> None:
    queue = backlog([0.0])
    last = arrival(0.0, True)
    queue.put(last)
    queue.finish()
    assert queue.take() == (last, False)
    assert queue.take() is None


def test_it_holds_no_more_bytes_than_it_may() -> None:
    queue = backlog([0.0])
    half = MAX_BYTES // 2
    last = arrival(0.0, True)
    for each in (arrival(0.0, True, size=half), arrival(0.0, False, size=half + 1), last):
        queue.put(each)
    assert queue.take() == (last, False)
    assert queue.skipped == 2


def test_closing_lets_go_of_who_waits() -> None:
    queue = backlog([0.0])
    queue.close()
    assert queue.take() is None
