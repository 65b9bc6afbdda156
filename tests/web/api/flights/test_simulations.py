"""Simulated flights through the interface: frames, truth, uploads, analyses, limits."""

from __future__ import annotations

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
from web_server import running, settings_for, wait_until

ADDRESS = "/api/v1/simulations"
SPEC = {"rows": 40, "cols": 40, "ratio": 4, "cell_mm": 10.0, "distance": 1, "seed": 3}
SMALL_CAMERA = """
image_width: 480
image_height: 270
camera_name: small
camera_matrix: {rows: 3, cols: 3, data: [330, 0, 239.5, 0, 330, 134.5, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}
"""
Refused = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """A server that simulates and analyses."""
    settings = settings_for(tmp_path_factory.mktemp("data"), max_flight_frames=60)
    with running(settings) as client:
        yield client


@pytest.fixture(scope="module")
def scene(server: httpx.Client) -> dict[str, str]:
    """Ids of a pad and of a small camera."""
    pad = server.post("/api/v1/pads", json=SPEC).raise_for_status().json()["id"]
    file = {"file": ("small.yaml", SMALL_CAMERA)}
    camera = server.post("/api/v1/cameras", files=file).raise_for_status().json()["id"]
    return {"pad": pad, "camera": camera}


def _done(server: httpx.Client, spec: dict[str, Any]) -> dict[str, Any]:
    answer = server.post(ADDRESS, json=spec)
    assert answer.status_code == 202, answer.text
    made: dict[str, Any] = answer.json()
    assert (made["state"], made["frames_done"]) == ("queued", 0)
    address = answer.headers["Location"]
    wait_until(lambda: server.get(address).json()["state"] not in ("queued", "running"))
    job: dict[str, Any] = server.get(address).json()
    assert job["state"] == "done", job
    assert job["frames_done"] == job["frames_total"]
    return job


def _archive(server: httpx.Client, job: dict[str, Any]) -> zipfile.ZipFile:
    answer = server.get(f"{ADDRESS}/{job['id']}/files/flight.zip").raise_for_status()
    return zipfile.ZipFile(io.BytesIO(answer.content))


def test_a_landing_is_analysed_and_agrees_with_its_truth(
    server: httpx.Client, scene: dict[str, str]
) -> None:
    spec = scene | {"frames": 6, "from_mm": 350, "to_mm": 200, "analyze": "dense", "seed": 2}
    job = _done(server, spec)
    assert (job["name"], job["video"]) == ("simulated landing, clear", True)
    upload = server.get(f"/api/v1/uploads/{job['upload']}").json()
    assert (upload["name"], upload["kind"]) == ("simulated landing, clear.mp4", "video")
    flight = f"/api/v1/flights/{job['flight']}"
    wait_until(lambda: server.get(flight).json()["state"] in ("done", "failed"))
    assert server.get(flight).json()["request"]["pad_id"] == scene["pad"]
    frames = server.get(f"{flight}/frames").json()["items"]
    with _archive(server, job) as pack:
        truth = json.loads(pack.read("flights/landing.truth.json"))["frames"]
        assert {"pad.json", "camera.yaml", "flights/landing.mp4"} <= set(pack.namelist())
    assert len(frames) == len(truth) == 6
    assert [frame["status"] for frame in frames] == ["ok"] * 6
    for frame, true in zip(frames, truth, strict=True):
        off = np.subtract(frame["position_mm"], true["position_mm"])
        assert np.linalg.norm(off) < 0.02 * true["position_mm"][2]


def test_stills_are_a_zip_of_pictures_with_truth_beside_them(
    server: httpx.Client, scene: dict[str, str]
) -> None:
    job = _done(server, scene | {"flight": "tilts", "frames": 3, "from_mm": 300, "name": "sweep"})
    assert (job["name"], job["video"], job["flight"]) == ("sweep", False, None)
    upload = server.get(f"/api/v1/uploads/{job['upload']}").json()
    assert (upload["name"], upload["kind"]) == ("sweep.zip", "stills")
    with _archive(server, job) as pack:
        truth = json.loads(pack.read("stills/truth.json"))
        data = pack.read(truth[0]["file"])
    assert [record["group"] for record in truth] == ["tilt0", "tilt35", "tilt70"]
    assert cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR).shape == (270, 480, 3)


def test_the_same_request_gives_the_same_footage(
    server: httpx.Client, scene: dict[str, str]
) -> None:
    spec = scene | {"flight": "hover", "frames": 2, "from_mm": 300, "look": "shadow"}
    hashes = {
        server.get(f"/api/v1/uploads/{_done(server, asked)['upload']}").json()["sha256"]
        for asked in (spec, spec, spec | {"seed": 9})
    }
    assert len(hashes) == 2


def test_a_flight_can_be_stopped_and_forgotten(
    server: httpx.Client, scene: dict[str, str], refused: Refused
) -> None:
    spec = scene | {"frames": 50, "analyze": "dense"}
    first, second = (server.post(ADDRESS, json=spec).json()["id"] for _ in range(2))
    error = server.get(f"{ADDRESS}/{second}/files/flight.zip")
    refused(error, 409, "not_done")
    for job in (second, first):
        assert server.delete(f"{ADDRESS}/{job}").status_code == 204
        assert server.get(f"{ADDRESS}/{job}").json()["state"] == "cancelled"
    later = _done(server, scene | {"frames": 1})
    for job in (first, second):
        stopped = server.get(f"{ADDRESS}/{job}").json()
        assert (stopped["upload"], stopped["flight"], stopped["error"]) == (None, None, None)
    assert server.delete(f"{ADDRESS}/{later['id']}").status_code == 204
    refused(server.get(f"{ADDRESS}/{later['id']}"), 404, "not_found")
    assert server.get(f"/api/v1/uploads/{later['upload']}").json()["complete"]


@pytest.mark.parametrize(
    ("spec", "status", "code"),
    [
        ({"frames": 100_000}, 413, "too_many_frames"),
        ({"frames": 0}, 422, "invalid_request"),
        ({"to_mm": -20}, 422, "invalid_request"),
        ({"from_mm": 1e12}, 422, "invalid_request"),
        ({"look": "hail"}, 422, "invalid_spec"),
        ({"disturbances": ["hail=1"]}, 422, "invalid_spec"),
        ({"disturbances": ["vibration=2000:1", "exposure=100"]}, 413, "vibration_too_fast"),
        ({"disturbances": ["waves=9:10"]}, 422, "paper_too_steep"),
        ({"flight": "loop"}, 422, "invalid_request"),
        ({"pad": None, "analyze": "dense"}, 422, "invalid_spec"),
        ({"pad": "none"}, 404, "not_found"),
        ({"camera": "preset-none"}, 404, "not_found"),
    ],
)
def test_what_cannot_be_is_refused_at_once(
    server: httpx.Client,
    scene: dict[str, str],
    refused: Refused,
    spec: dict[str, Any],
    status: int,
    code: str,
) -> None:
    refused(server.post(ADDRESS, json=scene | spec), status, code)


def test_what_only_shows_on_the_way_is_told_by_the_job(
    server: httpx.Client, scene: dict[str, str]
) -> None:
    # Video has colours of half the resolution.
    odd = SMALL_CAMERA.replace("image_width: 480", "image_width: 481")
    camera = server.post("/api/v1/cameras", files={"file": ("odd.yaml", odd)}).json()["id"]
    spec = scene | {"camera": camera, "frames": 1}
    assert not _done(server, spec)["video"]
    job = server.post(ADDRESS, json=spec | {"stills": False}).json()["id"]
    wait_until(lambda: server.get(f"{ADDRESS}/{job}").json()["state"] == "failed")
    assert server.get(f"{ADDRESS}/{job}").json()["error"]["code"] == "odd_video_size"


def test_jobs_that_wait_are_limited(tmp_path: Path, refused: Refused) -> None:
    from padstudio.web.server.folder_jobs import MAX_OPEN

    with running(settings_for(tmp_path)) as client:
        spec = {"camera": "preset-webcam-c270", "frames": 100}
        for _ in range(MAX_OPEN):
            assert client.post(ADDRESS, json=spec).status_code == 202
        refused(client.post(ADDRESS, json=spec), 413, "too_many_flights")
    assert not list((tmp_path / "work").iterdir())
