"""Flights by a real server: what detect writes, once, whatever breaks on the way."""

from __future__ import annotations

import json
import re
import signal
import struct
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from breaking_proxy import between
from command_line import assert_one_line_error, run
from places import SAMPLES
from web_server import PAD_FILE, running, settings_for, wait_until

from padstudio.cli.remote.following import follow
from padstudio.cli.remote.ordering import Flight
from padstudio.cli.remote.server import Server

LANDING = SAMPLES / "flight" / "landing.mp4"
GIVEN = ("--pad", SAMPLES / "pad.json", "--camera", SAMPLES / "flight" / "camera.yaml")
PROGRAM = "from padstudio.cli.program import main; main()"


@pytest.fixture(scope="module")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    values = settings_for(tmp_path_factory.mktemp("remote"), max_upload_bytes=5_000_000)
    with running(values) as client:
        yield client


def remote(studio: httpx.Client | str, *arguments: Any) -> Any:
    url = studio if isinstance(studio, str) else studio.base_url
    return run("remote", "--server", url, *arguments)


def plain(poses: str) -> str:
    """A poses file without the times that its making took, and the word for its run."""
    poses = re.sub(r', "run": "[0-9a-f]+"', "", poses)
    return re.sub(r'"elapsed_ms": \{[^}]*\}', '"elapsed_ms": {}', poses)


def flights(studio: httpx.Client) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = studio.get("/api/v1/flights").json()["items"]
    return found


def uploads(studio: httpx.Client) -> int:
    return int(studio.get("/api/v1/uploads").json()["total"])


def padded(path: Path, size_bytes: int) -> Path:
    """The landing with an empty box behind it (ISO/IEC 14496-12, 8.1.2): larger, and the same."""
    box = struct.pack(">I4s", size_bytes, b"free") + bytes(size_bytes - 8)
    path.write_bytes(LANDING.read_bytes() + box)
    return path


def test_a_video_gives_the_poses_file_of_detect(studio: httpx.Client, tmp_path: Path) -> None:
    asked = (*GIVEN, "--stride", 12, LANDING, "-o")
    here, there = tmp_path / "here.jsonl", tmp_path / "there.jsonl"
    assert run("detect", *asked, here, "-j", 1).exit_code == 0
    tum = tmp_path / "there.tum.txt"
    result = remote(studio, *asked, there, "--export", f"tum={tum}")
    assert (result.exit_code, result.stdout) == (0, ""), result.stderr
    assert plain(there.read_text()) == plain(here.read_text())
    [flight] = flights(studio)
    assert f"flight {flight['id']} ordered: {studio.base_url}" in result.stderr
    assert "pose by red" in result.stderr
    export = studio.get(f"/api/v1/flights/{flight['id']}/export/tum")
    assert tum.read_bytes() == export.content
    assert sorted(tmp_path.iterdir()) == [here, there, tum]

    before = uploads(studio)
    again = remote(studio, *asked, there, "--force", "-q")
    assert (again.exit_code, again.stderr.count("\n")) == (0, 1)
    assert "was ordered before" in again.stderr
    assert plain(there.read_text()) == plain(here.read_text())
    assert (len(flights(studio)), uploads(studio)) == (1, before)


def test_unfused_poses_of_stills_are_those_of_detect(studio: httpx.Client, tmp_path: Path) -> None:
    stills = [tmp_path / name for name in ("a10.jpg", "a9.jpg", "twin.jpg")]
    names = ("height_450mm.jpg", "another_pad.jpg", "height_450mm.jpg")
    for still, name in zip(stills, names, strict=True):
        still.write_bytes((SAMPLES / name).read_bytes())
    whole = stills[0].read_bytes()
    (tmp_path / "cut.jpg").write_bytes(whole[: len(whole) // 2])
    given = ("--pad", SAMPLES / "pad.json", "--camera", SAMPLES / "camera.yaml", tmp_path)
    here, there = run("detect", *given, "-j", 1), remote(studio, *given)
    assert here.exit_code == there.exit_code == 0, there.stderr
    assert plain(there.stdout) == plain(here.stdout)
    lines = [json.loads(line) for line in there.stdout.splitlines()]
    assert [Path(line["source"]).name for line in lines] == [
        "a9.jpg",
        "a10.jpg",
        "cut.jpg",
        "twin.jpg",
    ]
    assert [line["status"] for line in lines] == ["failed", "ok", "failed", "ok"]
    assert f"error: {tmp_path / 'cut.jpg'}: " in there.stderr


def test_without_any_pose_the_exit_code_is_that_of_detect(studio: httpx.Client) -> None:
    given = ("--pad", SAMPLES / "pad.json", "--camera", SAMPLES / "camera.yaml")
    result = remote(studio, *given, SAMPLES / "another_pad.jpg")
    assert (result.exit_code, json.loads(result.stdout)["status"]) == (1, "failed")


def test_a_client_that_was_killed_goes_on_where_it_was(
    studio: httpx.Client, tmp_path: Path
) -> None:
    video = padded(tmp_path / "large.mp4", 6_000_000)
    size = video.stat().st_size
    output = tmp_path / "poses.jsonl"
    asked = [str(a) for a in (*GIVEN, "--stride", 60, video, "-o", output)]
    known = uploads(studio)

    def unfinished() -> dict[str, Any]:
        return dict(studio.get("/api/v1/uploads").json()["items"][0])

    with between(studio.base_url.port or 0) as proxy:
        proxy.stop_after = 3_500_000
        command = [sys.executable, "-c", PROGRAM, "remote", "--server", proxy.url, *asked]
        with subprocess.Popen(command, stderr=subprocess.DEVNULL) as client:
            wait_until(lambda: uploads(studio) > known and unfinished()["offset"] > 0)
            client.send_signal(signal.SIGKILL)
    begun = unfinished()
    assert 0 < begun["offset"] < size
    assert not output.exists()
    with between(studio.base_url.port or 0) as proxy:
        result = remote(proxy.url, *asked)
        assert result.exit_code == 0, result.stderr
        assert proxy.sent < size - begun["offset"] + 100_000
    assert uploads(studio) == known + 1
    assert unfinished()["id"] == begun["id"]
    assert len(output.read_text().splitlines()) == 2


def test_broken_connections_are_gone_on_from(studio: httpx.Client, tmp_path: Path) -> None:
    video = padded(tmp_path / "broken.mp4", 3_000_000)
    known = uploads(studio)
    with between(studio.base_url.port or 0) as proxy:
        proxy.break_after = 2_000_000
        result = remote(proxy.url, *GIVEN, "--stride", 60, video, "-q")
        assert result.exit_code == 0, result.stderr
        assert proxy.break_after is None
    assert uploads(studio) == known + 1


def test_a_flight_is_ordered_anew_only_where_that_is_said(studio: httpx.Client) -> None:
    asked = (*GIVEN, "--stride", 60, LANDING, "-q")
    known = len(flights(studio))
    assert remote(studio, *asked, "--name", "once").exit_code == 0
    assert remote(studio, *asked, "--name", "once").exit_code == 0
    assert len(flights(studio)) == known + 1
    assert flights(studio)[0]["name"] == "once"
    assert remote(studio, *asked, "--name", "once", "--anew").exit_code == 0
    assert len(flights(studio)) == known + 2
    assert (
        remote(studio, *asked, "--name", "once", "--param", "search.least_step=0.4").exit_code == 0
    )
    assert len(flights(studio)) == known + 3


def test_a_cancelled_flight_is_told_and_tried_again(
    studio: httpx.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "poses.jsonl"
    asked = (*GIVEN, LANDING, "--name", "stopped", "-o", output)

    def cancel_first(server: Server, flight: Flight) -> Flight:
        # A second of work is left when the order has just been answered.
        studio.post(f"/api/v1/flights/{flight['id']}/cancel").raise_for_status()
        return follow(server, flight)

    with monkeypatch.context() as patch:
        patch.setattr("padstudio.cli.remote.remote.follow", cancel_first)
        result = remote(studio, *asked)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.endswith("run this again to try what is missing (cancelled)\n")
    assert not output.exists()
    again = remote(studio, *asked)
    assert again.exit_code == 0, again.stderr
    assert len(output.read_text().splitlines()) == 72
    assert flights(studio)[0]["name"] == "stopped"
    assert sum(flight["name"] == "stopped" for flight in flights(studio)) == 1


def test_pads_and_cameras_are_named(studio: httpx.Client) -> None:
    given = {"file": ("pad.json", (SAMPLES / "pad.json").read_bytes())}
    pad = studio.post("/api/v1/pads/import", files=given).json()["id"]
    studio.patch(f"/api/v1/pads/{pad}", json={"name": "roof pad"}).raise_for_status()
    files = {"file": ("camera.yaml", GIVEN[3].read_bytes())}
    camera = studio.post("/api/v1/cameras", files=files).json()
    asked = ("--stride", 60, LANDING, "-q", "--camera", camera["name"])
    assert remote(studio, "--pad", "roof pad", *asked).exit_code == 0
    assert remote(studio, "--pad", pad, *asked).exit_code == 0
    assert_one_line_error(remote(studio, "--pad", "cellar pad", *asked), "not_found")
    other = json.loads(PAD_FILE) | {"name": "roof pad"}
    files = {"file": ("pad.json", json.dumps(other))}
    studio.post("/api/v1/pads/import", files=files).raise_for_status()
    assert_one_line_error(remote(studio, "--pad", "roof pad", *asked), "ambiguous_name")


def test_what_the_server_refuses_is_one_line(studio: httpx.Client, tmp_path: Path) -> None:
    junk = tmp_path / "junk.mp4"
    junk.write_bytes(b"no video")
    refused = remote(studio, *GIVEN, junk)
    assert_one_line_error(refused, "unknown_content")
    assert "junk.mp4: " in refused.stderr
    callback = remote(studio, *GIVEN, "--stride", 60, LANDING, "--callback", "https://a.example/")
    assert_one_line_error(callback, "callback_refused")
    wrong = remote(studio, *GIVEN, LANDING, "--param", "no.such=1")
    assert_one_line_error(wrong, "invalid_parameter")
    mixed = remote(studio, *GIVEN, LANDING, SAMPLES / "height_450mm.jpg")
    assert_one_line_error(mixed, "mixed_uploads")


def test_exports_are_looked_at_before_anything_is_sent(
    studio: httpx.Client, tmp_path: Path
) -> None:
    before = uploads(studio)
    still = tmp_path / "new.jpg"
    still.write_bytes((SAMPLES / "height_150mm.jpg").read_bytes() + b"new")
    file = tmp_path / "x"
    for code, *words in (
        ("unknown_export", f"dance={file}"),
        ("unknown_export", f"mcap={file}", "--export-option", "pictures=true"),
        ("vehicle_pose_required", f"px4={file}"),
    ):
        assert_one_line_error(remote(studio, *GIVEN, still, "--export", *words), code)
    assert uploads(studio) == before
    assert not file.exists()


def test_outputs_are_looked_at_before_anything_is_sent(tmp_path: Path) -> None:
    there = tmp_path / "there"
    there.touch()
    nowhere = "http://127.0.0.1:9"
    for words in (("-o", there), ("--export", f"tum={there}")):
        assert_one_line_error(remote(nowhere, *GIVEN, LANDING, *words), "file_exists")
    twice = ("-o", tmp_path / "a", "--export", f"tum={tmp_path / 'a'}")
    for words in (twice, ("--export", "tum"), ("--smooth", "--no-fuse")):
        assert_one_line_error(remote(nowhere, *GIVEN, LANDING, *words), "usage")
