"""Bins tell the same as their frames, however the frames came in."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.flights.results.bins import BIN_FRAMES, add_up, bins_of, pose_gaps


def frame(number: int, *, ok: bool) -> dict[str, Any]:
    return {
        "flight": 1,
        "number": number,
        "time_s": number / 30,
        "status": "ok" if ok else "failed",
        "stage": None if ok else ("lines", "grid")[number % 2],
        "reason": None if ok else "no_lattice",
        "layer": "red" if ok else None,
        "x_mm": None,
        "y_mm": None,
        "z_mm": 1000.0 + number if ok else None,
    }


def binned(frames: Sequence[dict[str, Any]], cuts: set[int], request: dict[str, int]) -> list[Any]:
    """Bins of frames that came in parts."""
    ends = [0, *sorted(cut for cut in cuts if cut < len(frames)), len(frames)]
    parts = [frames[a:b] for a, b in pairwise(ends)]
    return [SimpleNamespace(**row) for part in parts for row in bins_of(part, request)]


@given(
    outcomes=st.lists(st.booleans(), min_size=1, max_size=400),
    cuts=st.sets(st.integers(1, 399), max_size=5),
    first=st.integers(0, 50),
    stride=st.integers(1, 7),
)
def test_bins_add_up_to_their_frames(
    outcomes: list[bool], cuts: set[int], first: int, stride: int
) -> None:
    frames = [frame(first + stride * place, ok=ok) for place, ok in enumerate(outcomes)]
    bins = binned(frames, cuts, {"first_frame": first, "stride": stride})
    assert sum(row.frames for row in bins) == len(frames)
    assert sum(row.ok for row in bins) == sum(outcomes)
    stages: dict[str, int] = {}
    for row in bins:
        add_up(stages, row.body["stages"])
    assert stages == Counter(f["stage"] for f in frames if f["stage"])
    poses = [f["number"] for f in frames if f["status"] == "ok"]
    gaps = list(pose_gaps(row.body["poses"] for row in bins))
    steps = [after - before for before, after in gaps if None not in (before, after)]
    assert max(steps, default=0) == max((b - a for a, b in pairwise(poses)), default=0)
    ends = (poses[0], poses[-1]) if poses else (None, None)
    assert (gaps[0][1], gaps[-1][0]) == ends
    width = BIN_FRAMES * stride
    for row in bins:
        assert (row.first_frame - first) // width == (row.last_frame - first) // width


def test_a_bin_without_poses_has_no_heights() -> None:
    (row,) = bins_of([frame(n, ok=False) for n in range(5)], {})
    assert (row["z_min_mm"], row["z_max_mm"], row["body"]["poses"]) == (None, None, [])
    assert row["time_s"] == pytest.approx(0)
