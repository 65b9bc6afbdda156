"""A live session over HTTP."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from live_command import CAMERA, PAD, is_true, landing_at

from padstudio.geometry.camera import Camera
from padstudio.live.outputs.records import Records
from padstudio.live.outputs.watch import Watch
from padstudio.live.session import LiveSession
from padstudio.live.stats import stats_of
from padstudio.live.stream.addresses import parse_address
from padstudio.live.stream.live_stream import LiveStream
from padstudio.live.stream.options import StreamOptions
from padstudio.live.stream.packet_shelf import PacketShelf
from padstudio.pad.spec import Pad
from padstudio.vision.detector import Detector
from padstudio.web.monitor.serving import monitored

PATIENCE_S = 120.0


@contextmanager
def monitored_session(video: Path, host: str = "127.0.0.1") -> Iterator[tuple[str, LiveSession]]:
    """A session over a file in a loop, its address, and the session."""
    detector = Detector(Pad.load(PAD), Camera.load(CAMERA))
    watch, shelf = Watch(Records("camera")), PacketShelf(keep_s=600)
    options = StreamOptions(loop=True, late_s=600.0)
    stream = LiveStream(parse_address(str(video)), options, [shelf])
    session = LiveSession(detector, stream, [watch])
    thread = threading.Thread(target=session.run)
    with monitored((host, 0), watch, shelf, detector, lambda: stats_of(session, stream)) as address:
        thread.start()
        try:
            yield address, session
        finally:
            session.stop()
            thread.join()
            stream.close()


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    video = landing_at(tmp_path_factory.mktemp("landing") / "small.mp4", (640, 360))
    with monitored_session(video) as (address, session):
        limit_s = time.monotonic() + PATIENCE_S
        while session.counts.poses < 3:
            assert time.monotonic() < limit_s
            time.sleep(0.01)
        yield address


def events_of(address: str, count: int) -> list[tuple[str, dict[str, Any]]]:
    """The next events, of a connection of its own."""
    found: list[tuple[str, dict[str, Any]]] = []
    with httpx.stream("GET", f"{address}/events", timeout=PATIENCE_S) as response:
        assert response.status_code == 200
        assert response.headers["content-type"].startswith("text/event-stream")
        kind = ""
        for line in response.iter_lines():
            if line.startswith("event: "):
                kind = line.removeprefix("event: ")
            if line.startswith("data: "):
                found.append((kind, json.loads(line.removeprefix("data: "))))
            if len(found) >= count:
                return found
    return found


def test_poses_and_figures_come_as_events(address: str) -> None:
    found = events_of(address, 12)
    kinds = {kind for kind, _ in found}
    assert {"pose", "stats"} <= kinds
    poses = [record for kind, record in found if kind == "pose" and record["status"] == "ok"]
    assert poses
    assert all(is_true(record) for record in poses)
    (stats, *_) = [record for kind, record in found if kind == "stats"]
    assert stats["counts"]["frames"] >= 3


def test_many_watchers_are_told_the_same(address: str) -> None:
    found: list[dict[int, dict[str, Any]]] = []

    def watch() -> None:
        told = events_of(address, 15)
        found.append({r["frame"]: r for kind, r in told if kind == "pose"})

    threads = [threading.Thread(target=watch) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 6
    for a in found:
        for b in found:
            for number in a.keys() & b.keys():
                assert a[number] == b[number]


def test_a_frame_is_shown_and_looked_at_again(address: str) -> None:
    frames = httpx.get(f"{address}/frames", timeout=PATIENCE_S).json()
    number = [frame["number"] for frame in frames if frame["status"] == "ok"][-1]
    picture = httpx.get(f"{address}/frames/{number}/picture", timeout=PATIENCE_S)
    assert picture.headers["content-type"] == "image/jpeg"
    shown = cv2.imdecode(np.frombuffer(picture.content, np.uint8), cv2.IMREAD_COLOR)
    assert shown.shape == (360, 640, 3)
    trace = httpx.get(f"{address}/frames/{number}/trace", timeout=PATIENCE_S).json()
    assert is_true(trace["result"])
    names = {stage["name"] for stage in trace["stages"]}
    assert {"edges", "grid", "decode", "pose"} <= names
    stage = next(stage for stage in trace["stages"] if stage["picture"])
    url = f"{address}/frames/{number}/trace/{stage['picture']}"
    png = httpx.get(url, timeout=PATIENCE_S)
    assert png.content.startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("path", "status", "code"),
    [
        ("/frames/999999/picture", 404, "frame_gone"),
        ("/frames/999999/trace", 404, "frame_gone"),
        ("/frames/999999/trace/red-edges.png", 404, "not_found"),
        ("/frames/-1/picture", 422, "invalid_request"),
        ("/frames/1/trace/..%2f..%2fsecret.png", 404, "not_found"),
        ("/nothing", 404, "not_found"),
    ],
)
def test_what_is_not_there_is_refused_by_name(
    address: str, path: str, status: int, code: str
) -> None:
    answer = httpx.get(address + path, timeout=PATIENCE_S)
    assert answer.status_code == status
    assert answer.json()["error"]["code"] == code


def test_foreign_hosts_and_origins_are_refused(address: str) -> None:
    foreign = httpx.get(f"{address}/stats", headers={"Host": "evil.example"}, timeout=60)
    assert foreign.status_code == 403
    assert foreign.json()["error"]["code"] == "foreign_host"
    changing = httpx.post(
        f"{address}/stats", headers={"Origin": "https://evil.example"}, timeout=60
    )
    assert changing.status_code == 403


def test_the_network_is_served_with_a_token_alone(tmp_path: Path) -> None:
    video = landing_at(tmp_path / "small.mp4", (320, 180))
    with monitored_session(video, "0.0.0.0") as (address, _):
        url, _, token = address.partition("/?token=")
        assert httpx.get(f"{url}/stats", timeout=PATIENCE_S).status_code == 401
        allowed = {"Authorization": f"Bearer {token}"}
        assert httpx.get(f"{url}/stats", headers=allowed, timeout=PATIENCE_S).status_code == 200


def test_watchers_hear_the_end(tmp_path: Path) -> None:
    video = landing_at(tmp_path / "small.mp4", (320, 180))
    told: list[tuple[str, dict[str, Any]]] = []
    with monitored_session(video) as (address, session):
        thread = threading.Thread(target=lambda: told.extend(events_of(address, 10**9)))
        thread.start()
        limit_s = time.monotonic() + PATIENCE_S
        while not session.counts.frames:
            assert time.monotonic() < limit_s
            time.sleep(0.01)
    thread.join(PATIENCE_S)
    assert not thread.is_alive()
