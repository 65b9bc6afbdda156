"""Fuses the poses of a recorded flight with those after them, too.

The filter goes forward, and its results are carried back from later frames (Rauch, Tung and
Striebel), a stretch at a time: what lies further ahead than `LOOK_AHEAD_S` changes nothing that
counts, so that flights of any length are smoothed in little memory.

References
----------
Rauch, H. E., Tung, F. and Striebel, C. T. (1965). Maximum likelihood estimates of linear dynamic
systems. doi:10.2514/3.3166.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Generic, TypeVar

from padstudio.vision.fusion import kernel
from padstudio.vision.fusion.kernel import Track
from padstudio.vision.fusion.measurement import Fused, Measurement
from padstudio.vision.fusion.pose_filter import Link, PoseFilter

T = TypeVar("T")

#: What a frame is smoothed with, at the least; some ten times as long as the filter remembers.
LOOK_AHEAD_S = 5.0
# Frames are given out when they span so much more than that, or when too many wait.
_STRETCH_S, _MOST_WAITING = 5.0, 20_000


def fuse(
    items: Iterable[T],
    measure: Callable[[T], Measurement | None],
    pose_filter: PoseFilter,
    *,
    smooth: bool = False,
) -> Iterator[tuple[T, Fused | None]]:
    """Each item with its fused pose; None where it has none of its own.

    Parameters
    ----------
    items : iterable
        In the order of time.
    measure : callable
        An item's own pose, or None.
    pose_filter : PoseFilter
        Begins with its state, and holds that after the last item.
    smooth : bool
        With the frames after each, too; items then come later than they are taken.
    """

    def usable(item: T) -> Measurement | None:
        frame = measure(item)
        return frame if frame is not None and frame.is_usable else None

    if smooth:
        yield from _Smoother(usable, pose_filter).run(items)
        return
    for item in items:
        frame = usable(item)
        yield item, None if frame is None else pose_filter.step(frame)


class _Smoother(Generic[T]):
    """Items that wait for those after them."""

    def __init__(self, measure: Callable[[T], Measurement | None], pose_filter: PoseFilter) -> None:
        self._measure, self._filter = measure, pose_filter
        self._waiting: list[T] = []
        # Of each item that waits; None where it has no pose.
        self._links: list[Link | None] = []
        self._times_s: list[float] = []

    def run(self, items: Iterable[T]) -> Iterator[tuple[T, Fused | None]]:
        for item in items:
            self._take(item)
            ready_s = self._times_s[-1] - LOOK_AHEAD_S
            if self._times_s[0] < ready_s - _STRETCH_S:
                yield from self._give(sum(1 for time_s in self._times_s if time_s <= ready_s))
            elif len(self._waiting) > _MOST_WAITING:
                yield from self._give(len(self._waiting) // 2)
        yield from self._give(len(self._waiting))

    def _take(self, item: T) -> None:
        frame = self._measure(item)
        self._waiting.append(item)
        if frame is None:
            # It goes out with the frame before it.
            self._times_s.append(self._times_s[-1] if self._times_s else -math.inf)
            self._links.append(None)
            return
        self._times_s.append(frame.time_s)
        self._links.append(self._filter.link(frame))
        places = [place for place, link in enumerate(self._links[:-1]) if link is not None]
        revised = self._filter.revised
        for place, link in zip(places[len(places) - len(revised) :], revised, strict=False):
            self._links[place] = link

    def _give(self, count: int) -> Iterator[tuple[T, Fused | None]]:
        fused = smoothed(self._links)
        yield from zip(self._waiting[:count], fused[:count], strict=True)
        del self._waiting[:count], self._links[:count], self._times_s[:count]


def smoothed(links: Sequence[Link | None]) -> list[Fused | None]:
    """What a filter's links amount to with those after each."""
    out: list[Fused | None] = [None] * len(links)
    later: Link | None = None
    track: Track | None = None
    for place in range(len(links) - 1, -1, -1):
        link = links[place]
        if link is None:
            continue
        if later is None or later.ahead is None or track is None:
            out[place], track = link.fused, link.track
        else:
            track, shake, joint = kernel.stepped_back(
                link.track, link.joint, link.shake, later.step, later.ahead, track
            )
            out[place] = replace(link, track=track, shake=shake, joint=joint).fused
        later = link
    return out
