"""A simulated frame through the interface: the picture, its truth, its limits."""

from __future__ import annotations

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from web_server import PRESET, PRESET_SIZE, running, settings_for, store_pad

from padstudio.geometry import presets
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.spec import Pad
from padstudio.simulate.disturbances import WORDS
from padstudio.simulate.looks import LOOKS
from padstudio.simulate.render import corners_px

ADDRESS = "/api/v1/simulate"
Refused = Callable[..., dict[str, Any]]


def _frame(studio: httpx.Client, **spec: Any) -> tuple[dict[str, Any], np.ndarray]:
    body = studio.post(ADDRESS, json={"camera": PRESET} | spec).raise_for_status().json()
    data = base64.b64decode(body["picture"]["base64"])
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    return body, image


def test_the_picture_shows_the_pad_where_the_truth_says(studio: httpx.Client) -> None:
    stored = store_pad(studio)["id"]
    body, image = _frame(
        studio, pad=stored, height_mm=60, tilt_deg=20, heading_deg=35, ground="plain", seed=4
    )
    assert (body["width"], body["height"]) == PRESET_SIZE == image.shape[1::-1]
    truth = Pose(np.array(body["truth"]["position_mm"]), np.array(body["truth"]["rotation"]))
    asked = look_at_pad(60, tilt_deg=20, heading_deg=35)
    assert np.allclose(truth.position_mm, asked.position_mm)
    assert np.allclose(truth.rotation, asked.rotation)
    assert body["truth"]["tilt_deg"] == pytest.approx(20)
    pad = Pad.from_dict(studio.get(f"/api/v1/pads/{stored}").json()["pad"])
    corners = corners_px(presets.get(PRESET).camera, truth, pad, "red")
    middles = (corners[:-1, :-1] + corners[1:, 1:]) / 2
    red = np.array([image[round(y), round(x), 2] for x, y in middles.reshape(-1, 2)], float)
    levels = pad.layers[0].field.ravel()
    assert red[levels == 1].min() > 2 * red[levels == 0].max()


def test_the_same_request_gives_the_same_picture(studio: httpx.Client) -> None:
    asked = {"height_mm": 300, "look": "shadow", "seed": 5}
    assert _frame(studio, **asked)[0] == _frame(studio, **asked)[0]
    assert not np.array_equal(_frame(studio, **asked)[1], _frame(studio, **asked | {"seed": 6})[1])


def test_disturbances_are_put_on(studio: httpx.Client) -> None:
    _, image = _frame(studio, height_mm=500, disturbances=["sensor=mono", "fog=3"])
    assert np.abs(image[..., 0].astype(int) - image[..., 2]).max() <= 2


def test_the_truth_can_be_sent_back_as_a_pose(studio: httpx.Client) -> None:
    first, image = _frame(studio, height_mm=400, tilt_deg=12, tilt_towards_deg=70)
    pose = {key: first["truth"][key] for key in ("position_mm", "rotation")}
    second, again = _frame(studio, pose=pose)
    assert np.allclose(second["truth"]["rotation"], first["truth"]["rotation"])
    assert np.abs(again.astype(int) - image).mean() < 0.5


@pytest.mark.parametrize(
    ("spec", "status", "code"),
    [
        ({"height_mm": 0}, 422, "pose_below_ground"),
        ({"height_mm": -100}, 422, "pose_below_ground"),
        ({"tilt_deg": 95}, 422, "invalid_request"),
        ({"height_mm": 5, "velocity_mm_s": [0, 0, -1e7]}, 422, "pose_below_ground"),
        (
            {"pose": {"position_mm": [0, 0, 500], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}},
            422,
            "camera_sees_no_ground",
        ),
        (
            {"pose": {"position_mm": [0, 0, 500], "rotation": [[2, 0, 0], [0, 1, 0], [0, 0, 1]]}},
            422,
            "invalid_spec",
        ),
        ({"look": "hail"}, 422, "invalid_spec"),
        ({"disturbances": ["rain=1"]}, 422, "invalid_spec"),
        ({"disturbances": ["vibration=2000:1", "exposure=100"]}, 413, "vibration_too_fast"),
        ({"disturbances": "fog=1"}, 422, "invalid_request"),
        ({"ground": "lava"}, 422, "invalid_request"),
        ({"pad": "none"}, 404, "not_found"),
        ({"camera": "preset-none"}, 404, "not_found"),
    ],
)
def test_what_cannot_be_is_refused_by_name(
    studio: httpx.Client, refused: Refused, spec: dict[str, Any], status: int, code: str
) -> None:
    refused(studio.post(ADDRESS, json={"camera": PRESET} | spec), status, code)


def test_cameras_beyond_the_limit_are_refused(tmp_path: Path, refused: Refused) -> None:
    with running(settings_for(tmp_path, max_simulated_pixels=10_000)) as client:
        error = refused(client.post(ADDRESS, json={"camera": PRESET}), 413, "too_many_pixels")
    assert "1280 x 720" in error["message"]


def test_looks_are_listed(studio: httpx.Client) -> None:
    body = studio.get(f"{ADDRESS}/looks").raise_for_status().json()
    assert [item["name"] for item in body["items"]] == list(LOOKS)
    assert "grass" in body["grounds"]
    assert [item["name"] for item in body["disturbances"]] == list(WORDS)
