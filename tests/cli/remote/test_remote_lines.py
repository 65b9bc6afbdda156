"""Frames of a flight as lines of the files that they are from."""

from __future__ import annotations

import json
from fractions import Fraction
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from padstudio.cli.remote.lines import lines_of

FAILED = {"status": "failed", "stage": "read", "reason": "frame_lost", "detail": "", "advice": ""}


def line(frame: int, time_s: float | None, source: str = "as the server calls it") -> bytes:
    record: dict[str, Any] = {"elapsed_ms": {}, "frame": frame, "time_s": time_s, "source": source}
    return json.dumps(record | FAILED).encode()


@given(
    st.fractions(Fraction(1, 120_000), Fraction(1, 10), max_denominator=120_000),
    st.floats(0, 40_000),
    st.lists(st.integers(0, 10**7), min_size=1, max_size=9),
)
def test_times_are_those_of_the_video_to_the_last_digit(
    time_base: Fraction, start_s: float, ticks: list[int]
) -> None:
    unit_s = float(time_base)
    sources = [
        {"kind": "video", "first_frame": 0, "start_s": 0.0, "time_base_s": 0.04},
        {"kind": "video", "first_frame": 50, "start_s": start_s, "time_base_s": unit_s},
    ]
    export = [line(50 + k, start_s + tick * unit_s) for k, tick in enumerate(ticks)]
    found = list(lines_of(export, sources, ["a.mp4", "b.mp4"], "filter"))
    assert [each["time_s"] for each in found] == [tick * unit_s for tick in ticks]
    assert [each["frame"] for each in found] == list(range(len(ticks)))
    assert {each["source"] for each in found} == {"b.mp4"}
    assert list(found[0]) == ["source", "frame", "time_s", *FAILED, "elapsed_ms"]


def test_stills_and_zips_of_stills_are_named_here() -> None:
    sources = [
        {"kind": "still", "first_frame": 0},
        {"kind": "stills", "first_frame": 1},
        {"kind": "still", "first_frame": 3},
    ]
    export = [line(number, None, f"member {number}") for number in range(4)]
    found = list(lines_of(export, sources, ["x/a.jpg", "b.zip", "c.jpg"], "none"))
    assert [(each["source"], each["frame"], each["time_s"]) for each in found] == [
        ("x/a.jpg", 0, None),
        ("b.zip/member 1", 0, None),
        ("b.zip/member 2", 1, None),
        ("c.jpg", 0, None),
    ]
