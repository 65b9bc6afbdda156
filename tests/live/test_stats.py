"""Figures of a session, for programs and for people."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from padstudio.live.counts import SessionCounts
from padstudio.live.latency import LatencyMeter
from padstudio.live.reports.source import StreamState
from padstudio.live.stats import line_for_people, stats_of


def _stats(state: StreamState) -> dict[str, Any]:
    counts = SessionCounts(frames=10, poses=9, dropped=2)
    session: Any = SimpleNamespace(sight="found", counts=counts, latency=LatencyMeter())
    source: Any = SimpleNamespace(state=state)
    return stats_of(session, source)


@pytest.mark.parametrize(
    ("state", "said"),
    [
        (StreamState("open"), "found · 10 frames, 90.0 % read, 2 dropped"),
        (
            StreamState("open", skipped=7),
            "found · 10 frames, 90.0 % read, 2 dropped, 7 skipped before decoding",
        ),
        (StreamState("lost"), "lost · 10 frames, 90.0 % read, 2 dropped"),
    ],
)
def test_a_line_tells_all_that_was_not_looked_at(state: StreamState, said: str) -> None:
    assert line_for_people(_stats(state)) == said


def test_programs_get_every_figure_of_the_stream() -> None:
    told = _stats(StreamState("open", frames=12, dropped=2, skipped=7, size_px=(64, 48)))["stream"]
    assert told.keys() == vars(StreamState()).keys()
    assert (told["skipped"], told["size_px"]) == (7, [64, 48])
