from __future__ import annotations

import json
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import pytest
from web_server import PRESET, running, settings_for

from padstudio.geometry.camera import Camera

CAMERAS = "/api/v1/cameras"
CALIBRATION = """\
image_width: 640
image_height: 480
camera_name: front
camera_matrix: {rows: 3, cols: 3, data: [500.0, 0, 320, 0, 502, 240, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0.1, -0.2, 0.001, 0.002, 0.05]}
"""
Refused = Callable[..., dict[str, Any]]


def _import(client: httpx.Client, content: str | bytes) -> httpx.Response:
    return client.post(CAMERAS, files={"file": ("cam.yaml", content)})


def test_presets_are_marked_as_nominal(studio: httpx.Client) -> None:
    body = studio.get(f"{CAMERAS}/presets").json()
    items = {item["id"]: item for item in body["items"]}
    paper = items["preset-dji-mini-27k"]
    assert (paper["width"], paper["height"]) == (2720, 1530)
    assert paper["focal_px"] == pytest.approx(1886, abs=1)
    assert body["total"] == len(items) >= 8
    assert all(item["nominal"] and "calibrate" in item["note"] for item in items.values())
    assert studio.get(f"{CAMERAS}/{PRESET}").json() == items[PRESET]


def test_import_list_get_file_delete(studio: httpx.Client, refused: Refused) -> None:
    answer = _import(studio, CALIBRATION)
    assert answer.status_code == 201
    made = answer.json()
    assert (made["name"], made["nominal"], made["model"]) == ("front", False, "radtan")
    assert made["distortion"] == [0.1, -0.2, 0.001, 0.002, 0.05]
    assert studio.get(CAMERAS).json()["items"][0] == made
    assert studio.get(f"{CAMERAS}/{made['id']}").json() == made
    file = studio.get(f"{CAMERAS}/{made['id']}/files/camera.yaml")
    assert 'filename="front.yaml"' in file.headers["content-disposition"]
    assert Camera.loads(file.content).matrix[1, 1] == 502
    assert studio.delete(f"{CAMERAS}/{made['id']}").status_code == 204
    refused(studio.get(f"{CAMERAS}/{made['id']}"), 404, "not_found")


def test_how_long_a_shutter_rolls_can_be_said(studio: httpx.Client, refused: Refused) -> None:
    made = _import(studio, CALIBRATION).json()
    address = f"{CAMERAS}/{made['id']}/readout"
    told = studio.put(address, json={"readout_ms": 18.5}).json()
    assert told == made | {"readout_ms": 18.5} == studio.get(f"{CAMERAS}/{made['id']}").json()
    file = studio.get(f"{CAMERAS}/{made['id']}/files/camera.yaml").content
    assert Camera.loads(file).readout_ms == 18.5
    assert studio.put(address, json={"readout_ms": None}).json()["readout_ms"] is None
    copy = studio.put(f"{CAMERAS}/{PRESET}/readout", json={"readout_ms": 0}).json()
    assert (copy["id"] != PRESET, copy["readout_ms"], copy["nominal"]) == (True, 0.0, True)
    assert studio.get(f"{CAMERAS}/{PRESET}").json()["readout_ms"] != 0.0
    for wrong in ({"readout_ms": -1}, {"readout_ms": 2000}, {}):
        refused(studio.put(address, json=wrong), 422, "invalid_request")


def test_a_name_can_be_given(studio: httpx.Client) -> None:
    answer = studio.post(CAMERAS, files={"file": ("x.yaml", CALIBRATION)}, data={"name": " Bay 2 "})
    assert answer.json()["name"] == "Bay 2"
    assert studio.get(CAMERAS).json()["items"][0]["name"] == "Bay 2"


def test_a_preset_has_a_file_and_stays(studio: httpx.Client, refused: Refused) -> None:
    file = studio.get(f"{CAMERAS}/{PRESET}/files/camera.yaml").raise_for_status()
    assert Camera.loads(file.content).nominal
    refused(studio.delete(f"{CAMERAS}/{PRESET}"), 409, "conflict")


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x89PNG\r\n\x1a\n\x00\x00",
        "just a text",
        "a: &a [x]\nb: [*a, *a]",
        CALIBRATION.replace("500.0", "-500.0"),
        CALIBRATION.replace("640", "0"),
        CALIBRATION.replace("500.0", ".nan"),
    ],
)
def test_ill_formed_files_are_refused(
    studio: httpx.Client, refused: Refused, content: str | bytes
) -> None:
    before = studio.get(CAMERAS).json()["total"]
    refused(_import(studio, content), 422, "invalid_camera_file")
    assert studio.get(CAMERAS).json()["total"] == before


def test_a_camera_file_beyond_the_limit_is_refused(tmp_path: Path, refused: Refused) -> None:
    with running(settings_for(tmp_path, max_camera_bytes=1000)) as client:
        refused(_import(client, b" " * 1001), 413, "limit_exceeded")


def test_no_distortion_is_said_by_the_file_or_the_user(
    studio: httpx.Client, refused: Refused
) -> None:
    silent = CALIBRATION[: CALIBRATION.index("distortion_model")]
    body = refused(_import(studio, silent), 422, "distortion_not_said")
    assert "no_distortion in REST" in body["message"]
    files = {"file": ("silent.yaml", silent)}
    made = studio.post(CAMERAS, files=files, data={"no_distortion": "true"}).raise_for_status()
    assert made.json()["distortion"] in ([], [0.0] * 5)
    files = {"file": ("cam.yaml", CALIBRATION)}
    answer = studio.post(CAMERAS, files=files, data={"no_distortion": "true"})
    refused(answer, 422, "invalid_camera_file")


def test_a_camera_of_several_is_chosen(studio: httpx.Client, refused: Refused) -> None:
    line = "PINHOLE 640 480 500 500 320.5 240.5"
    files = {"file": ("cameras.txt", f"3 {line}\n8 {line.replace('320', '310')}\n")}
    body = refused(studio.post(CAMERAS, files=files), 422, "several_cameras")
    assert body["detail"] == {"cameras": ["3", "8"]}
    made = studio.post(CAMERAS, files=files, data={"camera": "8"}).raise_for_status().json()
    file = studio.get(f"{CAMERAS}/{made['id']}/files/camera.yaml").content
    assert (made["name"], Camera.loads(file).matrix[0, 2]) == ("cameras 8", 310)


def test_snapshots_of_photonvision_pass(tmp_path: Path) -> None:
    content = {
        "resolution": {"width": 640, "height": 480},
        "cameraIntrinsics": {"data": [500, 0, 320, 0, 500, 240, 0, 0, 1]},
        "distCoeffs": {"data": [0.1, -0.2, 0.001, 0.002, 0.05]},
        "observations": [{"snapshotData": "A" * 5_000_000}],
    }
    with running(settings_for(tmp_path, max_upload_bytes=64_000_000)) as client:
        made = _import(client, json.dumps(content)).raise_for_status().json()
    assert made["distortion"] == [0.1, -0.2, 0.001, 0.002, 0.05]


def test_what_a_user_must_know_of_a_camera_is_told(studio: httpx.Client) -> None:
    region = "roi: {x_offset: 100, y_offset: 50, width: 480, height: 360}\n"
    folded = CALIBRATION.replace("[0.1, -0.2,", "[-0.9, 0.0,").replace("0.05]", "0]")
    made = _import(studio, folded + region).raise_for_status().json()
    assert made["note"].startswith("region of interest 480 x 360 applied: the camera is of frames")
    assert "; the lens folds back within" in made["note"]
    address = f"{CAMERAS}/{made['id']}"
    told = studio.put(f"{address}/readout", json={"readout_ms": 5}).raise_for_status().json()
    renamed = studio.patch(address, json={"name": "cut"}).raise_for_status().json()
    assert told["note"] == renamed["note"] == made["note"]


def test_the_forms_of_other_programs(studio: httpx.Client, refused: Refused) -> None:
    made = _import(studio, CALIBRATION.replace("0.05]", "0]")).raise_for_status().json()
    true = Camera.loads(CALIBRATION.replace("0.05]", "0]"))
    rays = [[0.1, 0.2, 1], [-0.3, 0.1, 1]]
    for file, ending in (
        ("camera.yaml", "front.yaml"),
        ("opencv.yaml", "front.opencv.yaml"),
        ("kalibr.yaml", "front.kalibr.yaml"),
        ("cameras.txt", "front.cameras.txt"),
    ):
        answer = studio.get(f"{CAMERAS}/{made['id']}/files/{file}").raise_for_status()
        assert f'filename="{ending}"' in answer.headers["content-disposition"]
        assert Camera.loads(answer.content).project(rays) == pytest.approx(true.project(rays))
    five = _import(studio, CALIBRATION).raise_for_status().json()
    answer = studio.get(f"{CAMERAS}/{five['id']}/files/kalibr.yaml")
    refused(answer, 422, "invalid_camera_file")
    refused(studio.get(f"{CAMERAS}/{five['id']}/files/x.yaml"), 422, "invalid_request")


@pytest.mark.parametrize("value", ['!!int ""', '!!bool "x"', "!!timestamp x", "!!binary x"])
def test_tags_are_refused_and_no_defect(studio: httpx.Client, refused: Refused, value: str) -> None:
    refused(_import(studio, CALIBRATION + f"notes: {value}\n"), 422, "invalid_camera_file")


def test_cameras_survive_a_restart(tmp_path: Path) -> None:
    with running(settings_for(tmp_path)) as client:
        made = _import(client, CALIBRATION).json()
    with running(settings_for(tmp_path)) as client:
        assert client.get(CAMERAS).json() == {"items": [made], "total": 1}


def test_costly_files_are_worked_beside_the_server(studio: httpx.Client) -> None:
    """Sixteen at a time cost the server itself little, and others are answered meanwhile."""
    lines = b"".join(b"k%d: {a: [1, 2]}\n" % number for number in range(6000))
    sends = {"file": ("a.yaml", lines)}
    studio.post("/api/v1/cameras", files={"file": ("a.yaml", b"a: 1")})
    used_s = time.process_time()
    with ThreadPoolExecutor(16) as senders:
        answers = [senders.submit(studio.post, "/api/v1/cameras", files=sends) for _ in range(16)]
        assert studio.get("/api/v1/health").status_code == 200
    assert {answer.result().status_code for answer in answers} <= {422, 503}
    # Read in this process, they would cost it more than a second.
    assert time.process_time() - used_s < 1.0
