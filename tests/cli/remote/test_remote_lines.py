"""Frames of a flight as lines of the files that they are from."""

from __future__ import annotations

import json
from typing import Any

from padstudio.cli.remote.lines import lines_of

FAILED = {"status": "failed", "stage": "read", "reason": "frame_lost", "detail": "", "advice": ""}


def line(frame: int, time_s: float | None, source: str = "as the server calls it") -> bytes:
    record: dict[str, Any] = {"elapsed_ms": {}, "frame": frame, "time_s": time_s, "source": source}
    return json.dumps(record | FAILED).encode()


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
        ("b.zip/member 1", 1, None),
        ("b.zip/member 2", 2, None),
        ("c.jpg", 3, None),
    ]


def test_videos_of_one_name_are_told_apart() -> None:
    sources = [{"kind": "video", "first_frame": 0}, {"kind": "video", "first_frame": 2}]
    found = list(lines_of([line(k, k / 4) for k in range(4)], sources, ["a/x", "b/x"], "filter"))
    assert [each["source"] for each in found] == ["a/x", "a/x", "b/x", "b/x"]
    assert list(found[0]) == ["source", "frame", "time_s", *FAILED, "elapsed_ms"]
