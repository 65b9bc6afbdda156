"""Calibrations through the interface: from uploads to a stored camera."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Iterator
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from calibration_shots import LENSES, lens_error_px, poses_about, shots
from dense_frames import random_pad
from web_server import running, settings_for, wait_until

from padstudio.geometry.camera import Camera
from padstudio.pad import files as pad_files

ADDRESS = "/api/v1/calibrations"
PAD = random_pad(3, cells=(60, 12), cell_mm=(20.0, 100.0))
CAMERA = LENSES["straight"]
Refused = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    with running(settings_for(tmp_path_factory.mktemp("data"))) as client:
        yield client


def _upload(server: httpx.Client, name: str, data: bytes) -> str:
    head = {"Tus-Resumable": "1.0.0", "Upload-Length": str(len(data))}
    word = b64encode(name.encode()).decode()
    made = server.post("/api/v1/uploads", headers=head | {"Upload-Metadata": f"filename {word}"})
    address = made.raise_for_status().headers["Location"]
    head = {
        "Tus-Resumable": "1.0.0",
        "Upload-Offset": "0",
        "Content-Type": "application/offset+octet-stream",
    }
    server.patch(address, headers=head, content=data).raise_for_status()
    return address.rsplit("/", 1)[1]


@pytest.fixture(scope="module")
def order(server: httpx.Client) -> dict[str, Any]:
    """A stored pad and eight uploaded stills, one of them without the pad."""
    file = {"file": ("pad.json", pad_files.to_text(PAD))}
    pad = server.post("/api/v1/pads/import", files=file).raise_for_status().json()["id"]
    pictures = shots(PAD, CAMERA, poses_about(1200.0, CAMERA, 7, seed=1))
    pictures.append(np.full_like(pictures[0], 90))
    uploads = [
        _upload(server, f"{k}.jpg", cv2.imencode(".jpg", picture)[1].tobytes())
        for k, picture in enumerate(pictures)
    ]
    return {"pad": pad, "uploads": uploads, "lens": "radtan"}


@pytest.fixture(scope="module")
def made(server: httpx.Client, order: dict[str, Any]) -> dict[str, Any]:
    answer = server.post(ADDRESS, json=order | {"name": "drone"})
    assert answer.status_code == 202, answer.text
    address = answer.headers["Location"]
    seen: list[int] = []

    def is_over() -> bool:
        job = server.get(address).json()
        seen.append(job["steps_done"])
        return job["state"] not in ("queued", "running")

    wait_until(is_over)
    assert seen == sorted(seen)
    job: dict[str, Any] = server.get(address).json()
    assert job["state"] == "done", job
    return job


def test_a_calibration_says_what_it_found(made: dict[str, Any]) -> None:
    result = made["result"]
    assert made["steps_done"] == made["steps_total"] > 0
    assert (result["width"], result["height"], result["model"]) == (960, 540, "radtan")
    assert [each["name"] for each in result["intrinsics"]] == ["fx", "fy", "cx", "cy"]
    for each, true in zip(result["intrinsics"], (675.0, 676.0, 484.0, 264.0), strict=True):
        assert abs(each["value"] - true) < 4 * each["sigma"]
    assert [each["state"] for each in result["pictures"]][-1] == "not_read"
    assert sum(each["used"] for each in result["pictures"]) == 7
    assert [each["name"] for each in result["pictures"]] == [f"{k}.jpg" for k in range(8)]
    assert np.sum(result["coverage"]) == sum(each["patches"] for each in result["pictures"])
    assert np.shape(result["sigma_px"]) == np.shape(result["coverage"])
    assert {"few_pictures"} <= {each["code"] for each in result["findings"]}


def test_each_picture_shows_its_residuals(server: httpx.Client, made: dict[str, Any]) -> None:
    address = f"{ADDRESS}/{made['id']}/pictures"
    answer = server.get(f"{address}/0.webp").raise_for_status()
    assert answer.headers["content-type"] == "image/webp"
    picture = cv2.imdecode(np.frombuffer(answer.content, np.uint8), cv2.IMREAD_COLOR)
    assert picture.shape == (540, 960, 3)
    green = (picture[..., 1].astype(int) - picture[..., [0, 2]].max(axis=-1)) > 60
    assert green.sum() > 100
    assert server.get(f"{address}/8.webp").status_code == 404


def test_the_camera_is_stored_when_asked_for(server: httpx.Client, made: dict[str, Any]) -> None:
    before = server.get("/api/v1/cameras").json()["total"]
    wanted = {"name": "drone, zoom 1", "readout_ms": 12.5}
    answer = server.post(f"{ADDRESS}/{made['id']}/camera", json=wanted)
    assert answer.status_code == 201
    assert answer.json()["name"] == "drone, zoom 1"
    assert answer.json()["nominal"] is False
    again = server.post(f"{ADDRESS}/{made['id']}/camera", json=wanted)
    assert (again.status_code, again.json()["id"]) == (200, answer.json()["id"])
    assert server.get("/api/v1/cameras").json()["total"] == before + 1
    text = server.get(f"/api/v1/cameras/{answer.json()['id']}/files/camera.yaml").text
    camera = Camera.loads(text)
    assert camera.readout_ms == 12.5
    assert np.sqrt(np.mean(lens_error_px(camera, CAMERA) ** 2)) < 0.5


def test_wrong_orders_are_refused_by_name(
    server: httpx.Client, order: dict[str, Any], refused: Refused
) -> None:
    def post(**change: Any) -> httpx.Response:
        return server.post(ADDRESS, json=order | change)

    refused(post(pad="nothing"), 404, "not_found")
    refused(post(uploads=["0" * 16]), 404, "not_found")
    refused(post(uploads=[]), 422, "invalid_request")
    refused(post(lens="round"), 422, "invalid_request")
    telemetry = _upload(server, "a.srt", b"1\n00:00:00,000 --> 00:00:01,000\n[latitude: 1]\n\n")
    refused(post(uploads=[telemetry]), 422, "no_pictures")


def test_pictures_that_tell_no_camera_fail_by_name(
    server: httpx.Client, order: dict[str, Any], refused: Refused
) -> None:
    answer = server.post(ADDRESS, json=order | {"uploads": order["uploads"][-1:] * 3})
    address = answer.raise_for_status().headers["Location"]
    refused(server.post(f"{address}/camera", json={}), 409, "not_done")
    wait_until(lambda: server.get(address).json()["state"] == "failed")
    error = server.get(address).json()["error"]
    assert error["code"] == "no_calibration"
    assert "read in 0 of 3 pictures" in error["message"]


def test_a_calibration_that_runs_can_be_stopped(
    server: httpx.Client, order: dict[str, Any], refused: Refused
) -> None:
    address = server.post(ADDRESS, json=order).raise_for_status().headers["Location"]
    assert server.delete(address).status_code == 204
    assert server.get(address).json()["state"] == "cancelled"
    assert server.delete(address).status_code == 204
    refused(server.get(address), 404, "not_found")
