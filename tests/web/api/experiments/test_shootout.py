"""Shoot-outs through the interface: a worker process starts the readers' own processes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
import reader_in_worker
from places import ROOT

from padstudio.geometry.camera import Camera
from padstudio.workers.inside import Limits
from padstudio.workers.pool import WorkerPool

ADDRESS = "/api/v1/experiments"
Refused = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module")
def order(studio: httpx.Client, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The sample pad under a tiny camera, against one board, in one frame."""
    file = tmp_path_factory.mktemp("shootout") / "camera.yaml"
    Camera(160, 90, np.array([[111.0, 0, 79.5], [0, 111.0, 44.5], [0, 0, 1]])).save(file)
    return {
        "kind": "shootout",
        "pad": _stored(studio, "pads/import", ROOT / "samples" / "pad.json"),
        "camera": _stored(studio, "cameras", file),
        "frames": 1,
        "from_mm": 2500,
        "boards": ["charuco"],
    }


def _stored(studio: httpx.Client, where: str, file: Path) -> str:
    answer = studio.post(f"/api/v1/{where}", files={"file": file.read_bytes()})
    return str(answer.raise_for_status().json()["id"])


def test_an_order_waits_for_its_turn_and_is_stopped(
    studio: httpx.Client, order: dict[str, Any]
) -> None:
    answer = studio.post(ADDRESS, json=order | {"name": "mine"})
    assert answer.status_code == 202, answer.text
    job = answer.json()
    assert (job["kind"], job["name"], job["order"]["boards"]) == ("shootout", "mine", ["charuco"])
    assert studio.delete(answer.headers["Location"]).status_code == 204


def test_a_worker_process_may_start_readers() -> None:
    pool = WorkerPool(1, Limits(memory_bytes=2 << 30), max_waiting=1)
    try:
        assert pool.submit(reader_in_worker.root_of, 9.0, timeout_s=60).result() == 3.0
    finally:
        pool.close()


@pytest.mark.parametrize(
    ("change", "status", "code"),
    [
        ({"pad": "0123456789abcdef"}, 404, "not_found"),
        ({"camera": "nobody's"}, 404, "not_found"),
        ({"boards": ["qr"]}, 422, "invalid_spec"),
        ({"disturbances": ["copy=900:10"]}, 422, "invalid_spec"),
        ({"frames": 201}, 422, "invalid_request"),
        ({"flight": "dive"}, 422, "invalid_request"),
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
