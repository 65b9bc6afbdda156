"""A live session: what it does with frames, with none, and with outputs that fail."""

from __future__ import annotations

import logging
import threading
from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from dense_frames import errors
from live_frames import (
    HandedOut,
    Kept,
    bare_ground,
    live_frame,
    sample_pad,
    small_camera,
    still_view,
)

from padstudio.live.reports.source import StreamState
from padstudio.live.session import LiveSession, SessionOptions
from padstudio.live.sight import SightOptions
from padstudio.vision.detector import Detector

HASTY = SessionOptions(sight=SightOptions(found_after=2, lost_after=3, silent_s=0.0))


@cache
def detector() -> Detector:
    return Detector(sample_pad(), small_camera())


def session_of(items: Sequence[object], *outputs: object, options=HASTY) -> LiveSession:
    return LiveSession(detector(), HandedOut(items), outputs, options)


def pad_frames(*numbers: int, connection: int = 0) -> list[object]:
    return [live_frame(number, still_view()[0], connection) for number in numbers]


def bare_frames(*numbers: int) -> list[object]:
    return [live_frame(number, bare_ground()) for number in numbers]


def test_every_frame_is_reported_with_what_was_dropped_before_it() -> None:
    kept = Kept()
    counts = session_of(pad_frames(0, 1, 4, 5, 9), kept).run()
    assert [report.frame.number for report in kept.reports] == [0, 1, 4, 5, 9]
    assert [report.dropped for report in kept.reports] == [0, 0, 2, 0, 3]
    assert (counts.frames, counts.poses, counts.full, counts.dropped) == (5, 5, 5, 5)
    assert kept.is_closed
    assert kept.threads == {threading.get_ident()}
    for report in kept.reports:
        assert errors(report.detection.pose, still_view()[1])[0] < 0.5
        assert report.detection.estimate == "filtered"
        assert report.posed_s >= report.frame.decoded_s


def test_the_pad_is_lost_and_found_after_so_many_frames_in_a_row() -> None:
    kept = Kept()
    items = [*pad_frames(0, 1, 2), *bare_frames(3, 4), *pad_frames(5), *bare_frames(6, 7, 8, 9)]
    session = session_of([*items, *pad_frames(10, 11)], kept)
    session.run()
    assert [sight for sight, _ in kept.sights] == ["found", "lost", "found"]
    assert "3 frames without a pose" in kept.sights[1][1]
    assert session.sight == "found"
    assert [report.detection.ok for report in kept.reports].count(False) == 6


def test_a_frame_without_the_pad_never_gives_a_pose() -> None:
    kept = Kept()
    counts = session_of([*pad_frames(0, 1, 2, 3), *bare_frames(*range(4, 20))], kept).run()
    assert not any(report.detection.ok for report in kept.reports[4:])
    assert counts.poses == 4
    assert sum(counts.reasons.values()) == 16


def test_a_stream_that_gives_nothing_is_said_once_with_its_reason() -> None:
    kept = Kept()
    lost = StreamState("lost", "the camera closed the connection", "stream_lost")
    items = [*pad_frames(0, 1), lost, None, None, StreamState("open", connections=2)]
    session_of([*items, *pad_frames(2, 3, connection=1)], kept).run()
    assert [sight for sight, _ in kept.sights] == ["found", "no_stream", "found"]
    assert kept.sights[1][1] == "the camera closed the connection"
    assert [kind for kind, _, _ in kept.events] == ["open", "lost", "open", "ended"]


def test_times_of_another_connection_are_on_another_clock() -> None:
    kept = Kept()
    later = [live_frame(number, still_view()[0], 1) for number in (1002, 1003)]
    back = [live_frame(0, still_view()[0]), live_frame(1, still_view()[0])]
    # Times go back from the first connection to the second.
    session_of([*later, *[_with_connection(frame, 2) for frame in back]], kept).run()
    assert all(report.detection.ok for report in kept.reports)
    first = kept.reports[2].detection
    np.testing.assert_allclose(first.pose.position_mm, first.single.pose.position_mm)


def _with_connection(frame, connection):
    return live_frame(frame.number, frame.picture, connection)


def test_frames_of_another_aspect_are_refused_by_name_and_others_waited_for() -> None:
    kept = Kept()
    wide = np.zeros((360, 640, 3), np.uint8)
    half = np.ascontiguousarray(still_view()[0][::2, ::2])
    items = [*pad_frames(0), *[live_frame(k, wide) for k in (1, 2, 3)], *pad_frames(4)]
    counts = session_of([*items, live_frame(5, half)], kept).run()
    assert counts.refused == 3
    assert [report.frame.number for report in kept.reports] == [0, 4, 5]
    refused = [event for event in kept.events if event[0] == "frames_refused"]
    assert len(refused) == 1
    assert "640 x 360" in refused[0][1]
    assert refused[0][2] == "camera_size_mismatch"
    sizes = [detail for kind, detail, _ in kept.events if kind == "size"]
    assert len(sizes) == 3
    assert "320 x 240" in sizes[-1]
    assert kept.reports[-1].detection.ok


def test_a_defect_costs_its_frame_alone(caplog: pytest.LogCaptureFixture) -> None:
    kept = Kept()
    broken = live_frame(1, np.zeros((480, 640), np.uint8))
    with caplog.at_level(logging.CRITICAL, "padstudio.live.session"):
        counts = session_of([*pad_frames(0), broken, *pad_frames(2)], kept).run()
    assert [report.frame.number for report in kept.reports] == [0, 2]
    assert counts.defects + counts.refused == 1


class Failing(Kept):
    def take(self, report) -> None:
        raise RuntimeError("the port is gone")

    def close(self) -> None:
        raise RuntimeError("it is still gone")


def test_an_output_that_fails_costs_its_own_messages_alone(
    caplog: pytest.LogCaptureFixture,
) -> None:
    kept = Kept()
    counts = session_of(pad_frames(0, 1, 2), Failing(), kept).run()
    assert len(kept.reports) == 3
    assert kept.is_closed
    assert counts.output_errors == {"Failing": 4}
    # Said once, not at every frame.
    assert len([r for r in caplog.records if "goes on" in r.message]) == 1


def test_it_ends_after_the_frame_at_hand_when_stopped() -> None:
    class Stopping(Kept):
        def take(self, report) -> None:
            super().take(report)
            session.stop()

    output = Stopping()
    session = session_of(pad_frames(*range(100)), output)
    counts = session.run()
    assert counts.frames == 1
    assert output.is_closed


def test_it_ends_after_its_time() -> None:
    class Endless(HandedOut):
        def newest(self, timeout_s: float) -> None:
            return None

    session = LiveSession(detector(), Endless([]), (), SessionOptions(duration_s=0.0))
    assert session.run().frames == 0


def test_the_last_frame_of_a_file_is_not_lost_where_the_file_ends_meanwhile() -> None:
    kept = Kept()
    # Nothing was there when asked; then came the last frame and the end.
    items = [*pad_frames(0), StreamState("ended"), *pad_frames(1)]
    session_of(items, kept).run()
    assert [report.frame.number for report in kept.reports] == [0, 1]


def test_latencies_are_measured_from_stage_to_stage() -> None:
    session = session_of(pad_frames(0, 1, 2))
    session.run()
    stages = session.latency.to_dict()
    assert "captured_to_arrived" not in stages
    assert stages["decoded_to_sent"]["frames"] == 3
    assert stages["arrived_to_sent"]["median_ms"] >= stages["decoded_to_sent"]["median_ms"]
