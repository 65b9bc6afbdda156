"""JSON lines: whole, in time, and no burden to the session."""

from __future__ import annotations

import contextlib
import json
import os
import threading
import time
from collections.abc import Iterator
from functools import cache

import numpy as np
import pytest
from live_frames import bare_ground, live_frame, sample_pad, small_camera, still_view

from padstudio.flights.results.poses_file import read_poses
from padstudio.live.outputs.json_lines import MOST_WAITING, JsonLines
from padstudio.live.outputs.records import Records
from padstudio.live.reports.report import LiveReport
from padstudio.vision.detector import Detector

PATIENCE_S = 60.0


@cache
def detection(of_pad: bool = True):
    picture = still_view()[0] if of_pad else bare_ground()
    return Detector(sample_pad(), small_camera()).detect(picture)


def report(number: int, *, of_pad: bool = True, dropped: int = 0) -> LiveReport:
    frame = live_frame(number, still_view()[0])
    return LiveReport(frame, detection(of_pad), time.monotonic(), dropped)


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    ends = os.pipe()
    yield ends
    for end in ends:
        with contextlib.suppress(OSError):
            os.close(end)


def wait_until(holds) -> None:
    limit_s = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < limit_s
        time.sleep(0.002)


def test_a_line_a_frame_is_a_poses_file_and_says_when(pipe, tmp_path) -> None:
    reader, writer = pipe
    lines = JsonLines(writer, Records("rtsp://camera/stream"))
    lines.stream_changed("open", "", "")
    lines.take(report(0))
    lines.take(report(3, dropped=2))
    lines.sight_changed("found", "the pad is in view")
    lines.take(report(4, of_pad=False))
    wait_until(lambda: lines.written == 3)
    lines.close()
    os.close(writer)
    with os.fdopen(reader, "rb") as stream:
        told = [json.loads(line) for line in stream.read().splitlines()]
    assert {t["event"] for t in told if "event" in t} == {"open", "found"}
    records = [t for t in told if "event" not in t]
    assert [r["frame"] for r in records] == [0, 3, 4]
    assert [r["status"] for r in records] == ["ok", "ok", "failed"]
    assert [r["live"]["dropped"] for r in records] == [0, 2, 0]
    for record in records:
        live = record["live"]
        assert live["taken_s"] <= live["decoded_s"] <= live["posed_s"]
        assert live["latency_ms"] == pytest.approx(
            1000 * (live["posed_s"] - live["taken_s"]), abs=0.01
        )
        assert abs(live["posed_s"] - time.time()) < PATIENCE_S
    assert records[1]["time_s"] == pytest.approx(0.1, abs=1e-6)
    np.testing.assert_allclose(records[0]["position_mm"], detection().pose.position_mm)
    # What lines hold is read as any poses file.
    path = tmp_path / "poses.jsonl"
    path.write_text("".join(json.dumps(record) + "\n" for record in records), encoding="utf-8")
    assert len(list(read_poses(path))) == 3


def test_a_slow_reader_delays_nothing_and_gets_the_newest(pipe) -> None:
    reader, writer = pipe
    lines = JsonLines(writer, Records("camera"))
    # Far more than a pipe holds; none of these calls may wait for the reader.
    count = 400
    for number in range(count):
        lines.take(report(number))
    assert lines.dropped > 0
    found: list[dict] = []

    def read() -> None:
        with os.fdopen(reader, "rb") as stream:
            found.extend(json.loads(line) for line in stream)

    thread = threading.Thread(target=read)
    thread.start()
    wait_until(lambda: lines.written + lines.dropped == count)
    lines.close()
    os.close(writer)
    thread.join()
    numbers = [record["frame"] for record in found]
    assert numbers == sorted(numbers)
    assert numbers[-MOST_WAITING:] == list(range(count - MOST_WAITING, count))
    assert sum(record["live"].get("not_written", 0) for record in found) == lines.dropped
    assert len(found) == lines.written


def test_a_reader_that_goes_away_is_noticed_once_and_raises_nothing(pipe) -> None:
    reader, writer = pipe
    broken = []
    lines = JsonLines(writer, Records("camera"), on_broken=lambda: broken.append(1))
    os.close(reader)
    lines.take(report(0))
    wait_until(lambda: broken)
    lines.take(report(1))
    lines.close()
    assert lines.is_broken
    assert broken == [1]


def test_a_reader_that_never_reads_does_not_keep_the_end_waiting(pipe) -> None:
    _, writer = pipe
    lines = JsonLines(writer, Records("camera"))
    for number in range(400):
        lines.take(report(number))
    lines.close()
