"""``padstudio live`` from end to end, on a network camera that is not ours."""

from __future__ import annotations

import itertools
import json
import signal
import socket
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import assert_one_line_error, run
from live_command import CAMERA, PAD, is_true, landing_at, live

StartServer = Callable[..., object]
SIZE = (640, 360)


@pytest.fixture(scope="module")
def videos(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, Path]:
    folder = tmp_path_factory.mktemp("landings")
    return (
        landing_at(folder / "small.mp4", SIZE),
        landing_at(folder / "smaller.mp4", (480, 270)),
        landing_at(folder / "square.mp4", (360, 360), crop=True),
    )


def test_a_stream_is_read_and_ends_in_order_by_a_signal(videos, rtsp_server) -> None:
    server = rtsp_server(videos[0])
    with live(server.url, "--stats-json") as command:
        command.read_until(lambda: len(command.poses) >= 60)
        command.process.send_signal(signal.SIGTERM)
        code, errors = command.end()
    assert code == 0
    assert "Traceback" not in errors
    frames = [line for line in command.lines if "status" in line]
    assert len(command.poses) >= 0.98 * len(frames)
    assert all(is_true(pose) for pose in command.poses)
    assert command.events("found")
    figures = json.loads([line for line in errors.splitlines() if line.startswith("{")][-1])
    assert figures["counts"]["poses"] >= len(command.poses)
    assert figures["latency_ms"]["decoded_to_sent"]["frames"] == figures["counts"]["frames"]
    assert figures["outputs"]["json"]["written"] == len(frames)
    numbers = [line["live"]["number"] for line in frames]
    skipped = sum(b - a - 1 for a, b in itertools.pairwise(numbers))
    assert skipped == sum(line["live"]["dropped"] for line in frames[1:])


def test_a_pulled_stream_comes_back_and_another_size_is_followed(videos, rtsp_server) -> None:
    server = rtsp_server(*videos)
    with live(server.url) as command:
        command.read_until(lambda: len(command.poses) >= 5)
        server.stop()
        command.read_until(lambda: bool(command.events("no_stream")))
        server.start()
        before = len(command.poses)
        command.read_until(lambda: len(command.poses) >= before + 5)
        server.show(1)
        command.read_until(lambda: command.lines[-1].get("frame_px") == [480, 270])
        command.read_until(lambda: command.poses[-1]["frame_px"] == [480, 270])
        server.show(2)
        command.read_until(lambda: bool(command.events("frames_refused")))
        server.show(0)
        command.read_until(lambda: command.poses[-1]["frame_px"] == list(SIZE))
        command.process.send_signal(signal.SIGINT)
        code, errors = command.end()
    assert code == 0
    assert "Traceback" not in errors
    assert all(is_true(pose) for pose in command.poses)
    (refused,) = command.events("frames_refused")
    assert refused["code"] == "camera_size_mismatch"
    assert "360 x 360" in refused["detail"]


def test_a_reader_that_goes_away_ends_it_quietly(videos) -> None:
    with live(videos[0], "--loop") as command:
        command.read_until(lambda: len(command.poses) >= 3)
        command.process.stdout.close()
        command.process.stdout = None
        code, errors = command.end()
    assert code == 0
    assert "Traceback" not in errors
    assert "Broken" not in errors


def test_a_file_at_its_own_rate_by_udp_and_into_a_file(videos, tmp_path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(1)
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        port = receiver.getsockname()[1]
        lines = tmp_path / "poses.jsonl"
        with live(videos[0], "--realtime", "--udp", f"127.0.0.1:{port}", "--json", lines) as found:
            code, errors = found.end()
        assert code == 0, errors
        datagrams = []
        try:
            while True:
                datagrams.append(json.loads(receiver.recv(65536)))
        except TimeoutError:
            pass
    written = [json.loads(line) for line in lines.read_text(encoding="utf-8").splitlines()]
    poses = [line for line in written if line.get("status") == "ok"]
    assert all(is_true(pose) for pose in poses)
    sent = [item for item in datagrams if item.get("status") == "ok"]
    assert sent
    assert {item["frame"] for item in sent} >= {pose["frame"] for pose in poses}
    assert "ended" in errors


def test_a_stream_is_recorded(videos, tmp_path) -> None:
    with live(videos[0], "--record", tmp_path / "flights", "--json", "-") as command:
        code, errors = command.end()
    assert code == 0, errors
    (folder,) = (tmp_path / "flights").iterdir()
    assert str(folder) in errors
    assert list(folder.glob("*.jsonl"))


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("gopher://camera/stream",), "bad_address"),
        (("rtsp://camera/stream", "--loop"), "usage"),
        (("flight.mp4", "--udp", "5000"), "usage"),
        (("flight.mp4", "--size", "wide"), "usage"),
        (("flight.mp4", "--mavlink", "nowhere"), "invalid_mavlink_address"),
        (("flight.mp4", "--mavlink", "udpout:127.0.0.1:14550", "--max-age-ms", "nan"), "usage"),
        (("flight.mp4", "--param", "search.nothing=1"), "invalid_parameter"),
    ],
)
def test_what_makes_no_session_is_refused_by_name(arguments, code) -> None:
    result = run("live", *arguments, "--pad", PAD, "--camera", CAMERA)
    assert_one_line_error(result, code)


def test_no_file_is_written_over(tmp_path) -> None:
    kept = tmp_path / "poses.jsonl"
    kept.write_text("mine", encoding="utf-8")
    result = run("live", "flight.mp4", "--pad", PAD, "--camera", CAMERA, "--json", kept)
    assert_one_line_error(result, "file_exists")
    assert kept.read_text(encoding="utf-8") == "mine"


def test_a_source_that_is_not_there_is_told_by_name(tmp_path) -> None:
    with live(tmp_path / "nothing.mp4", "--json", "-") as command:
        code, errors = command.end()
    assert code == 2
    assert "nothing.mp4" in errors
    assert errors.splitlines()[-1].startswith("error: ")


def test_a_session_without_a_pose_says_so(tmp_path) -> None:
    import videos as made

    path = made.write(tmp_path / "grey.mp4", frames=10, paint=made.blank, size=SIZE)
    with live(path) as command:
        code, errors = command.end()
    assert code == 1
    assert not command.poses
    assert "without a pose" in errors


def test_no_web_server_is_loaded_without_one(tmp_path) -> None:
    import subprocess
    import sys

    told = subprocess.run(
        [
            sys.executable,
            "-c",
            "import sys, padstudio.cli.live.live as l; "
            "print([n for n in ('fastapi', 'uvicorn', 'sqlalchemy', 'pymavlink', 'pydantic') "
            "if n in sys.modules])",
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    assert told.stdout.strip() == "[]"
