"""Error budgets through the interface."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import httpx
import pytest
from small_budget import NOTHING, small_camera, small_pad

ADDRESS = "/api/v1/experiments"
Refused = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module")
def order(studio: httpx.Client) -> dict[str, Any]:
    """A small pad and camera, with a print that is off by one per cent."""
    files = {"pads/import": small_pad().dumps(), "cameras": small_camera().to_ros_yaml()}
    stored = [
        studio.post(f"/api/v1/{where}", files={"file": (name, text.encode())})
        for (where, text), name in zip(files.items(), ("pad.json", "camera.yaml"), strict=True)
    ]
    pad, camera = (answer.raise_for_status().json()["id"] for answer in stored)
    sizes = NOTHING | {"scale_percent": 1.0}
    return {
        "kind": "budget", "pad": pad, "camera": camera, "height_mm": 450, "conditions": sizes,
    }  # fmt: skip


def test_an_order_waits_for_its_turn_and_is_stopped(
    studio: httpx.Client, order: dict[str, Any]
) -> None:
    answer = studio.post(ADDRESS, json=order | {"name": "mine"})
    assert answer.status_code == 202, answer.text
    job = answer.json()
    assert (job["kind"], job["name"], job["order"]["height_mm"]) == ("budget", "mine", 450)
    assert studio.delete(answer.headers["Location"]).status_code == 204


@pytest.mark.parametrize(
    ("change", "status", "code"),
    [
        ({"pad": "0123456789abcdef"}, 404, "not_found"),
        ({"camera": "nobody's"}, 404, "not_found"),
        ({"conditions": {"exposure": 3}}, 422, "invalid_spec"),
        ({"conditions": {"exposure_ms": -1}}, 422, "invalid_spec"),
        ({"height_mm": 5}, 422, "invalid_spec"),
        ({"frames": 3}, 422, "invalid_request"),
        ({"frames": 65}, 422, "invalid_request"),
        ({"codec": "vp9"}, 422, "invalid_request"),
        ({"seeds": 3}, 422, "invalid_request"),
    ],
)
def test_a_wrong_order_is_refused_at_once(
    studio: httpx.Client,
    order: dict[str, Any],
    refused: Refused,
    change: dict[str, Any],
    status: int,
    code: str,
) -> None:
    refused(studio.post(ADDRESS, json=order | change), status, code)
