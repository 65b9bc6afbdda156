"""UDP datagrams: one a report, small enough for any network."""

from __future__ import annotations

import json
import socket
import time
from dataclasses import replace

import pytest
from live_frames import live_frame, sample_pad, small_camera, still_view

from padstudio.errors import StudioError
from padstudio.live.outputs.datagrams import Datagrams
from padstudio.live.outputs.records import LEFT_OUT_OF_DATAGRAMS, LONGEST_DATAGRAM, Records
from padstudio.live.reports.report import LiveReport
from padstudio.vision.detector import Detector
from padstudio.vision.follower import Follower
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Reason, StageFailure


@pytest.fixture
def receiver():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
        found.bind(("127.0.0.1", 0))
        found.settimeout(60)
        yield found


def report(detection: Detection, number: int = 7) -> LiveReport:
    return LiveReport(live_frame(number, still_view()[0]), detection, time.monotonic())


def test_a_datagram_a_report_holds_the_pose_and_stays_small(receiver) -> None:
    output = Datagrams(*receiver.getsockname(), Records("rtsp://camera.local:8554/a/long/path"))
    detection = Follower(Detector(sample_pad(), small_camera())).take(still_view()[0], 0.0)
    output.take(report(detection))
    data = receiver.recv(65536)
    assert len(data) < LONGEST_DATAGRAM
    record = json.loads(data)
    assert record["position_mm"] == detection.pose.position_mm.tolist()
    assert record["quality"] == "full"
    assert record["live"]["number"] == 7
    assert not set(LEFT_OUT_OF_DATAGRAMS) & set(record)
    output.close()
    assert (output.sent, output.failed) == (1, 0)


def test_the_longest_sentence_still_fits(receiver) -> None:
    long = StageFailure("decode", Reason.UNKNOWN_CODE, "ü" * 5000, "a" * 5000)
    output = Datagrams(*receiver.getsockname(), Records("s" * 5000))
    output.take(report(replace(Detection(None, long), frame_px=(1920, 1080))))
    assert len(receiver.recv(65536)) < LONGEST_DATAGRAM
    output.sight_changed("lost", "ü" * 5000)
    assert len(receiver.recv(65536)) < LONGEST_DATAGRAM
    output.stream_changed("lost", "x" * 5000, "stream_lost")
    assert json.loads(receiver.recv(65536))["code"] == "stream_lost"
    output.close()


def test_nobody_who_listens_is_counted_and_not_fatal() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as gone:
        gone.bind(("127.0.0.1", 0))
        address = gone.getsockname()
    output = Datagrams(*address, Records("camera"))
    failure = Detection(None, StageFailure("decode", Reason.UNKNOWN_CODE, ""))
    for _ in range(5):
        output.take(report(failure))
    assert output.sent + output.failed == 5
    output.close()


def test_an_unknown_host_is_refused_by_name() -> None:
    with pytest.raises(StudioError, match=r"no-such-host\.invalid"):
        Datagrams("no-such-host.invalid", 5000, Records("camera"))
