"""A flight's poses in every form, over HTTP."""

from __future__ import annotations

import base64
import csv
import io
import json
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
import vehicle_logs
from mcap.reader import make_reader
from places import FOOTAGE, SAMPLES
from web_server import running, settings_for, wait_until

FRAMES = 4
Refused = Callable[..., dict[str, Any]]


def _upload(server: httpx.Client, path: Path) -> str:
    data = path.read_bytes()
    headers = {
        "Tus-Resumable": "1.0.0",
        "Upload-Length": str(len(data)),
        "Content-Type": "application/offset+octet-stream",
    }
    answer = server.post("/api/v1/uploads", headers=headers, content=data)
    return str(answer.raise_for_status().json()["id"])


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    with running(
        settings_for(tmp_path_factory.mktemp("data"), max_image_pixels=5_000_000)
    ) as client:
        yield client


def _fly(server: httpx.Client, folder: Path, uploads: list[str], **order: Any) -> str:
    """The address of a finished flight; the folder holds its pad and camera."""
    ids = {
        kind: server.post(f"/api/v1/{where}", files={"file": (path.name, path.read_bytes())})
        .raise_for_status()
        .json()["id"]
        for kind, where, path in (
            ("pad", "pads/import", next(folder.glob("pad*.json"))),
            ("camera", "cameras", next(folder.glob("camera*2k7.yaml"), folder / "camera.yaml")),
        )
    }
    made = server.post("/api/v1/flights", json={"uploads": uploads} | ids | order)
    address = str(made.raise_for_status().headers["location"])
    wait_until(lambda: server.get(address).json()["state"] not in ("queued", "running"))
    state = server.get(address).json()
    assert (state["state"], state["frames_ok"]) == ("done", state["frames_total"]), state
    return address


@pytest.fixture(scope="module")
def flight(server: httpx.Client) -> str:
    """The address of a flight of a few frames."""
    landing = _upload(server, FOOTAGE / "flights" / "landing.mp4")
    return _fly(server, FOOTAGE, [landing], end_frame=FRAMES, name="die Landung")


@pytest.fixture(scope="module")
def frames(server: httpx.Client, flight: str) -> list[dict[str, Any]]:
    return list(server.get(f"{flight}/frames").json()["items"])


def test_tables(server: httpx.Client, flight: str, frames: list[dict[str, Any]]) -> None:
    answer = server.get(f"{flight}/export/csv")
    assert "die%20Landung.csv" in answer.headers["content-disposition"]
    assert answer.headers["content-type"].startswith("text/csv")
    rows = list(csv.DictReader(io.StringIO(answer.text, newline="")))
    assert [float(row["camera_in_pad_z_mm"]) for row in rows] == [
        frame["position_mm"][2] for frame in frames
    ]
    lines = server.get(f"{flight}/export/jsonl").text.splitlines()
    assert [json.loads(line)["position_mm"] for line in lines] == [
        frame["position_mm"] for frame in frames
    ]


def test_trajectories(server: httpx.Client, flight: str, frames: list[dict[str, Any]]) -> None:
    answer = server.get(f"{flight}/export/tum", params={"start_unix_s": 1e9})
    table = np.loadtxt(io.StringIO(answer.text))
    assert table[:, 0] == pytest.approx([1e9 + frame["time_s"] for frame in frames], abs=1e-6)
    assert table[:, 1:4] * 1000 == pytest.approx(
        np.array([frame["position_mm"] for frame in frames]), abs=1e-5
    )


def test_models(server: httpx.Client, flight: str) -> None:
    data = server.get(f"{flight}/export/colmap").content
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert "1 PINHOLE 2720 1530" in archive.read("cameras.txt").decode()
        assert "landing" not in archive.read("images.txt").decode().partition("\n1 ")[0]


@pytest.mark.parametrize("images", [False, True])
def test_logs_with_and_without_images(server: httpx.Client, flight: str, images: bool) -> None:
    data = server.get(f"{flight}/export/mcap", params={"images": images}).content
    reader = make_reader(io.BytesIO(data))
    topics = [channel.topic for _, channel, _ in reader.iter_messages()]
    assert topics.count("/camera/pose") == FRAMES
    assert topics.count("/camera/image") == (FRAMES if images else 0)


def test_landing_targets(server: httpx.Client, flight: str, refused: Refused) -> None:
    address = f"{flight}/export/ardupilot"
    ahead = {"forward_m": 0.1, "turned_deg": 90}
    assert server.get(address).content != server.get(address, params=ahead).content
    refused(server.get(f"{flight}/export/px4"), 422, "vehicle_pose_required")
    track = "time_s,north_m,east_m,down_m,qw,qx,qy,qz\n-0.1,0,0,-1,1,0,0,0\n0.3,0,0,-1,1,0,0,0\n"
    found = server.post(f"{flight}/export/px4", files={"vehicle": ("v.csv", track)})
    log = vehicle_logs.tlog(vehicle_logs.wandering(8.0))
    unmatched = server.post(f"{flight}/export/px4", files={"vehicle": ("v.tlog", log)})
    refused(unmatched, 422, "clock_not_matched")
    # A message of text and one for each frame.
    assert found.content.count(b"\xfd") >= FRAMES + 1


@pytest.mark.parametrize("track", [b"\xff\xfe\x00", b"time_s\n0\n"])
def test_ill_formed_tracks(
    server: httpx.Client, flight: str, refused: Refused, track: bytes
) -> None:
    answer = server.post(f"{flight}/export/px4", files={"vehicle": ("v.csv", track)})
    refused(answer, 422, "invalid_vehicle_track")


def test_a_track_with_too_few_rows_writes_nothing(
    server: httpx.Client, flight: str, refused: Refused
) -> None:
    track = "time_s,north_m,east_m,down_m,qw,qx,qy,qz\n0.01,0,0,-3,1,0,0,0\n1.01,10,0,-3,1,0,0,0\n"
    answer = server.post(f"{flight}/export/px4", files={"vehicle": ("v.csv", track)})
    message = refused(answer, 422, "empty_export")["message"]
    assert message.startswith(f"no LANDING_TARGET was written: {FRAMES} frames have a pose, but")
    assert "with 1 s between rows" in message


def test_what_there_is_not(server: httpx.Client, flight: str, refused: Refused) -> None:
    refused(server.get(f"{flight}/export/kml"), 422, "invalid_request")
    refused(server.get("/api/v1/flights/none/export/csv"), 404, "not_found")
    params = {"start_unix_s": "nan"}
    refused(server.get(f"{flight}/export/tum", params=params), 422, "invalid_request")


def test_an_upload_that_a_flight_needs_stays(
    server: httpx.Client, flight: str, refused: Refused
) -> None:
    upload = server.get(flight).json()["sources"][0]["upload"]
    refused(server.delete(f"/api/v1/uploads/{upload}"), 409, "upload_in_use")
    assert server.get(f"/api/v1/uploads/{upload}").json()["complete"] is True


def test_stills_and_zips_of_them(server: httpx.Client, tmp_path: Path) -> None:
    stills = [SAMPLES / f"height_{height}mm.jpg" for height in (1300, 450)]
    with zipfile.ZipFile(tmp_path / "more.zip", "w") as archive:
        archive.write(stills[1], "descent/0001.jpg")
    uploads = [_upload(server, stills[0]), _upload(server, tmp_path / "more.zip")]
    address = _fly(server, SAMPLES, uploads)
    data = server.get(f"{address}/export/mcap", params={"images": True}).content
    reader = make_reader(io.BytesIO(data))
    pictures = [
        cv2.imdecode(np.frombuffer(base64.b64decode(json.loads(m.data)["data"]), np.uint8), 1)
        for _, _, m in reader.iter_messages(topics=["/camera/image"])
    ]
    for picture, path in zip(pictures, stills, strict=True):
        difference = np.abs(picture.astype(float) - cv2.imread(str(path)))
        assert difference.mean() < 3
    calibration = next(reader.iter_messages(topics=["/camera/calibration"]))[2]
    size = json.loads(calibration.data)
    assert (size["height"], size["width"]) == pictures[0].shape[:2]
    model = server.get(f"{address}/export/colmap").content
    with zipfile.ZipFile(io.BytesIO(model)) as archive:
        assert "descent/0001.jpg" in archive.read("images.txt").decode()
