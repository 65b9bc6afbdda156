"""Live sessions over REST: each in a process of its own."""

from __future__ import annotations

import contextlib
import json
import multiprocessing
import os
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from camera_server import StartServer
from flight_footage import FLIGHT_CAMERA, write_flight
from places import FOOTAGE
from web_server import running, settings_for, wait_until

STILL = FOOTAGE / "stills" / "a_cast0_1300.jpg"
TRUTH = FOOTAGE / "stills" / "truth.json"
Refused = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """A server with the footage's pad and camera, and room for two sessions."""
    with running(settings_for(tmp_path_factory.mktemp("live"))) as client:
        yield client


@pytest.fixture(scope="module")
def order(server: httpx.Client) -> dict[str, str]:
    """A session of the browser's camera."""
    pad = {"file": ("pad.json", (FOOTAGE / "pad_a.json").read_bytes())}
    camera = {"file": ("camera.yaml", (FOOTAGE / "camera_drone_half.yaml").read_bytes())}
    return {
        "source": "browser",
        "pad": server.post("/api/v1/pads/import", files=pad).raise_for_status().json()["id"],
        "camera": server.post("/api/v1/cameras", files=camera).raise_for_status().json()["id"],
    }


@pytest.fixture(scope="module")
def session(server: httpx.Client, order: dict[str, str]) -> Iterator[str]:
    """Address of a session that tests share."""
    yield from started(server, order)


@pytest.fixture
def fresh(server: httpx.Client, order: dict[str, str]) -> Iterator[str]:
    """Address of a session that ends with the test."""
    yield from started(server, order)


def started(server: httpx.Client, order: dict[str, str]) -> Iterator[str]:
    answer = server.post("/api/v1/live", json=order)
    assert answer.status_code == 201, answer.text
    address = answer.headers["Location"]
    yield address
    server.delete(address)


@pytest.fixture(scope="module")
def empty() -> bytes:
    """A picture of the camera's size without a pad."""
    grey = np.random.default_rng(1).integers(90, 110, (765, 1360, 3), np.uint8)
    return bytes(cv2.imencode(".png", grey)[1].tobytes())


def push(server: httpx.Client, session: str, data: bytes) -> httpx.Response:
    return server.post(f"{session}/frames", files={"image": ("frame.jpg", data)}, timeout=120)


def ids(server: httpx.Client) -> set[str]:
    return {item["id"] for item in server.get("/api/v1/live").json()["items"]}


def test_a_pushed_frame_is_answered_with_its_pose(server: httpx.Client, session: str) -> None:
    frame = push(server, session, STILL.read_bytes()).raise_for_status().json()
    truths = {item["file"]: item["position_mm"] for item in json.loads(TRUTH.read_text())}
    truth = truths[f"stills/{STILL.name}"]
    assert frame["record"]["status"] == "ok"
    assert frame["record"]["position_mm"] == pytest.approx(truth, abs=0.01 * truth[2])
    assert len(frame["marks"]["lines"]) > 20
    assert len(frame["marks"]["outlines"]) == 1
    width, height = frame["record"]["frame_px"]
    assert all(0 < x < width and 0 < y < height for x, y in frame["marks"]["axes"][:1])


def test_a_frame_without_the_pad_says_why(server: httpx.Client, session: str, empty: bytes) -> None:
    frame = push(server, session, empty).json()
    assert frame["record"]["status"] == "failed"
    assert frame["record"]["reason"]
    assert frame["record"]["detail"]
    assert frame["marks"]["lines"] == []
    assert frame["marks"]["axes"] is None


def test_the_last_frames_can_be_gone_back_to(server: httpx.Client, session: str) -> None:
    numbers = [push(server, session, STILL.read_bytes()).json()["number"] for _ in range(3)]
    listed = server.get(f"{session}/frames").json()["items"]
    assert [item["number"] for item in listed][-3:] == numbers
    frame = server.get(f"{session}/frames/{numbers[1]}").json()
    assert frame["number"] == numbers[1]
    picture = server.get(f"{session}/frames/{numbers[1]}/picture")
    assert picture.headers["Content-Type"] == "image/jpeg"
    assert picture.content == STILL.read_bytes()
    newest = server.get(f"{session}/newest", params={"after": -1}).json()
    assert newest["number"] == numbers[-1]


def test_any_of_them_opens_with_all_stages(server: httpx.Client, session: str) -> None:
    number = push(server, session, STILL.read_bytes()).json()["number"]
    answer = server.post(f"{session}/frames/{number}/trace", timeout=120).raise_for_status().json()
    again = server.get(f"/api/v1/detect/{answer['trace']['id']}").json()
    assert again["result"]["status"] == "ok"
    assert again["result"]["source"] == f"live-{number}.jpg"


def test_a_session_tells_how_it_fares(server: httpx.Client, fresh: str, empty: bytes) -> None:
    push(server, fresh, STILL.read_bytes())
    push(server, fresh, empty)

    def told() -> dict[str, Any]:
        return dict(server.get(fresh).json()["figures"] or {})

    wait_until(lambda: told().get("frames") == 2)
    assert told()["read"] == 1
    assert told()["recent_read"] == 1
    assert told()["latency_ms"]["median"] > 0
    info = server.get(fresh).json()
    assert info["state"] == "running"
    assert info["stream"]["size_px"]


def test_the_print_is_checked(server: httpx.Client, session: str) -> None:
    push(server, session, STILL.read_bytes())
    wait_until(lambda: bool(server.get(session).json()["print_check"]))
    items = {item["code"]: item for item in server.get(session).json()["print_check"]}
    assert {"contrast_red", "contrast_blue", "light", "sharpness", "cell_size"} <= set(items)
    assert all(item["text"] for item in items.values())
    assert all(item["advice"] for item in items.values() if item["verdict"] == "bad")


def test_events_have_the_session_and_its_poses(server: httpx.Client, session: str) -> None:
    push(server, session, STILL.read_bytes())
    names: dict[str, Any] = {}
    with server.stream("GET", f"{session}/events", timeout=60) as stream:
        name = ""
        for line in stream.iter_lines():
            if line.startswith("event: "):
                name = line[7:]
            elif line.startswith("data: "):
                names[name] = json.loads(line[6:])
            if {"session", "pose"} <= set(names) and names["session"]["figures"]:
                break
    assert names["pose"]["record"]["status"] == "ok"
    assert names["session"]["id"] == session.rsplit("/", 1)[-1]


def test_a_killed_process_is_told_and_leaves_nothing(
    server: httpx.Client, fresh: str, refused: Refused
) -> None:
    push(server, fresh, STILL.read_bytes())
    pid = pid_of(server, fresh)
    os.kill(pid, signal.SIGKILL)
    wait_until(lambda: server.get(fresh).json()["state"] == "failed")
    assert server.get(fresh).json()["error"]["code"] == "worker_crashed"
    refused(push(server, fresh, STILL.read_bytes()), 409, "live_over")
    wait_until(lambda: not is_running(pid))


def test_a_stopped_session_is_gone_with_its_process(
    server: httpx.Client, session: str, order: dict[str, str], refused: Refused
) -> None:
    address = server.post("/api/v1/live", json=order).headers["Location"]
    push(server, address, STILL.read_bytes())
    pid = pid_of(server, address)
    refused(server.post("/api/v1/live", json=order), 413, "too_many_live")
    assert server.delete(address).status_code == 204
    assert not is_running(pid)
    assert ids(server) == {session.rsplit("/", 1)[-1]}
    refused(server.get(address), 404, "not_found")
    refused(server.delete(address), 404, "not_found")


def test_one_frame_at_a_time(server: httpx.Client, session: str, empty: bytes) -> None:
    push(server, session, empty)
    answers: list[int] = []
    threads = [
        threading.Thread(target=lambda: answers.append(push(server, session, empty).status_code))
        for _ in range(6)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert 200 in answers
    assert set(answers) <= {200, 503}


def test_what_cannot_be_read_is_refused(
    server: httpx.Client, session: str, refused: Refused
) -> None:
    refused(push(server, session, b"no picture"), 422, "not_an_image")
    square = bytes(cv2.imencode(".png", np.zeros((400, 400, 3), np.uint8))[1].tobytes())
    refused(push(server, session, square), 422, "camera_size_mismatch")
    assert push(server, session, STILL.read_bytes()).json()["record"]["status"] == "ok"
    refused(server.get(f"{session}/frames/999999"), 404, "frame_not_kept")
    refused(server.post(f"{session}/frames/999999/trace"), 404, "frame_not_kept")


def test_wrong_orders_are_refused(
    server: httpx.Client, order: dict[str, str], refused: Refused
) -> None:
    refused(server.post("/api/v1/live", json=order | {"pad": "none"}), 404, "not_found")
    refused(server.post("/api/v1/live", json=order | {"camera": "none"}), 404, "not_found")
    refused(server.post("/api/v1/live", json=order | {"source": ""}), 422, "invalid_request")
    refused(server.post("/api/v1/live", json=order | {"more": 1}), 422, "invalid_request")
    for pad in ([], [""], [order["pad"]] * 17, ["\x00"]):
        refused(server.post("/api/v1/live", json=order | {"pad": pad}), 422, "invalid_request")


@pytest.mark.parametrize(
    ("kind", "fault"),
    [
        (threading.Thread, RuntimeError("can't start new thread")),
        (multiprocessing.process.BaseProcess, BlockingIOError(11, "no more processes")),
    ],
)
def test_a_session_for_which_there_is_no_room_is_refused_and_leaves_nothing(
    server: httpx.Client,
    order: dict[str, str],
    refused: Refused,
    monkeypatch: pytest.MonkeyPatch,
    kind: Any,
    fault: Exception,
) -> None:
    before, start = ids(server), kind.start

    def fail(each: Any) -> None:
        if each.name == "live":
            raise fault
        start(each)

    with monkeypatch.context() as patch:
        patch.setattr(kind, "start", fail)
        answer = server.post("/api/v1/live", json=order)
    refused(answer, 503, "no_worker")
    assert answer.headers["Retry-After"]
    assert ids(server) == before
    next(again := started(server, order))
    assert len(ids(server)) == len(before) + 1
    with contextlib.suppress(StopIteration):
        next(again)


def test_a_session_that_nobody_watches_ends(
    tmp_path: Any, order: dict[str, str], server: httpx.Client
) -> None:
    pad = server.get(f"/api/v1/pads/{order['pad']}").json()["pad"]
    with running(settings_for(tmp_path, live_idle_seconds=0.5)) as client:
        files = {"file": ("pad.json", json.dumps(pad))}
        stored = client.post("/api/v1/pads/import", files=files).raise_for_status().json()["id"]
        own = {"source": "browser", "pad": stored, "camera": "preset-webcam-c270"}
        address = client.post("/api/v1/live", json=own).headers["Location"]
        pid = pid_of(client, address)
        wait_until(lambda: client.get(address).json()["state"] == "idle")
        assert client.get(address).json()["error"]["code"] == "live_unwatched"
        wait_until(lambda: not is_running(pid))


def test_sessions_end_with_the_server(
    tmp_path: Any, order: dict[str, str], server: httpx.Client
) -> None:
    pad = server.get(f"/api/v1/pads/{order['pad']}").json()["pad"]
    with running(settings_for(tmp_path)) as client:
        files = {"file": ("pad.json", json.dumps(pad))}
        stored = client.post("/api/v1/pads/import", files=files).raise_for_status().json()["id"]
        own = {"source": "browser", "pad": stored, "camera": "preset-webcam-c270"}
        pid = pid_of(client, client.post("/api/v1/live", json=own).headers["Location"])
    assert not is_running(pid)


@pytest.fixture(scope="module")
def landing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small landing over the pad, as video."""
    return write_flight(tmp_path_factory.mktemp("footage"))[0]


@pytest.fixture
def streamed(
    server: httpx.Client, order: dict[str, str], landing: Path, rtsp_server: StartServer
) -> Iterator[str]:
    """Address of a session of an RTSP camera that asks for a password."""
    camera = {"file": ("camera.yaml", FLIGHT_CAMERA.read_bytes())}
    stored = server.post("/api/v1/cameras", files=camera).raise_for_status().json()["id"]
    source = rtsp_server(landing, password="mysecret").url_for("mysecret")
    yield from started(server, order | {"source": source, "camera": stored})


def test_a_stream_is_read_by_its_address(
    server: httpx.Client, streamed: str, refused: Refused
) -> None:
    wait_until(lambda: (server.get(streamed).json()["figures"] or {}).get("read", 0) > 5)
    told = server.get(streamed)
    assert "mysecret" not in told.text
    assert told.json()["source"].startswith("rtsp://")
    assert told.json()["stream"]["phase"] == "open"
    assert told.json()["stream"]["codec"] == "h264"
    first = server.get(f"{streamed}/newest").json()
    second = server.get(f"{streamed}/newest", params={"after": first["number"]}).json()
    assert second["number"] > first["number"]
    picture = server.get(f"{streamed}/frames/{second['number']}/picture")
    assert picture.headers["Content-Type"] == "image/jpeg"
    shape = cv2.imdecode(np.frombuffer(picture.content, np.uint8), cv2.IMREAD_COLOR).shape
    assert list(shape[1::-1]) == second["record"]["frame_px"]
    refused(push(server, streamed, STILL.read_bytes()), 409, "conflict")


def test_a_stream_is_recorded(server: httpx.Client, streamed: str, refused: Refused) -> None:
    refused(server.delete(f"{streamed}/recording"), 404, "not_recorded")
    wait_until(lambda: (server.get(streamed).json()["figures"] or {}).get("read", 0) > 2)
    begun = server.post(f"{streamed}/recording")
    assert begun.status_code == 201
    refused(server.post(f"{streamed}/recording"), 409, "conflict")
    wait_until(lambda: (server.get(streamed).json()["recording"] or {}).get("frames", 0) > 10)
    ended = server.delete(f"{streamed}/recording", timeout=60).json()
    assert ended["id"] == begun.json()["id"]
    assert not ended["is_on"]
    assert ended["phase"] == "closed"


def test_pushed_frames_are_recorded(server: httpx.Client, session: str) -> None:
    assert server.post(f"{session}/recording").status_code == 201
    for _ in range(4):
        push(server, session, STILL.read_bytes())
    ended = server.delete(f"{session}/recording", timeout=60).json()
    assert ended["frames"] == 4
    assert ended["bytes"] > 3 * STILL.stat().st_size


@pytest.mark.parametrize(
    ("source", "status", "code"),
    [
        ("rtsp://192.0.2.7/one", 403, "source_refused"),
        ("rtsp://pilot:mysecret@192.0.2.7/one", 403, "source_refused"),
        ("udp://0.0.0.0:5600", 403, "source_refused"),
        ("/dev/video0", 403, "source_refused"),
        ("/etc/passwd", 403, "source_refused"),
        ("gopher://127.0.0.1/", 422, "bad_address"),
        ("rtsp://", 422, "bad_address"),
    ],
)
def test_sources_that_the_settings_do_not_list_are_refused(
    server: httpx.Client,
    order: dict[str, str],
    refused: Refused,
    source: str,
    status: int,
    code: str,
) -> None:
    error = refused(server.post("/api/v1/live", json=order | {"source": source}), status, code)
    assert "mysecret" not in str(error)


def test_a_stream_that_does_not_answer_is_told_and_tried_again(
    server: httpx.Client, order: dict[str, str], session: str
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as closed:
        port = closed.getsockname()[1]
    source = f"rtsp://127.0.0.1:{port}/camera"
    address = server.post("/api/v1/live", json=order | {"source": source}).headers["Location"]
    wait_until(lambda: (server.get(address).json()["stream"] or {}).get("phase") == "lost")
    assert server.get(f"{address}/newest").status_code == 204
    stream = server.get(address).json()["stream"]
    assert stream["code"]
    assert str(port) in stream["detail"]
    server.delete(address)


def pid_of(server: httpx.Client, session: str) -> int:
    """The process of the session that was started last, a child of this one."""
    wait_until(lambda: server.get(session).json()["state"] == "running")
    children = [child for child in multiprocessing.active_children() if child.name == "live"]
    return max(children, key=lambda child: child._identity).pid or 0  # type: ignore[attr-defined]


def is_running(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True
