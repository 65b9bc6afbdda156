"""A server for all tests of this folder, and a picture to send to it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import cv2
import fake_analysis
import httpx
import numpy as np
import pytest
from web_server import PRESET_SIZE, SMALL_SPEC, running, settings_for


@pytest.fixture(scope="package")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """A server whose detector is `fake_analysis`; its pads and cameras add up over the tests."""
    data = tmp_path_factory.mktemp("data")
    with running(settings_for(data), analyze=fake_analysis.analyze) as client:
        yield client


@pytest.fixture(scope="package")
def pad_id(studio: httpx.Client) -> str:
    """A stored pad's id."""
    return str(studio.post("/api/v1/pads", json=SMALL_SPEC).raise_for_status().json()["id"])


@pytest.fixture(scope="package")
def picture() -> bytes:
    """A PNG of the size of the preset camera."""
    width, height = PRESET_SIZE
    image = np.zeros((height, width, 3), np.uint8)
    image[100:200, 300:500] = (10, 20, 250)
    return cv2.imencode(".png", image)[1].tobytes()


@pytest.fixture
def refused() -> Callable[..., dict[str, Any]]:
    """Asserts the one error shape, and gives what stands in it."""

    def check(response: httpx.Response, status: int, code: str) -> dict[str, Any]:
        body = response.json()
        assert response.status_code == status, body
        assert set(body) == {"error"}
        assert set(body["error"]) == {"code", "message", "detail"}
        assert body["error"]["code"] == code
        assert len(body["error"]["message"]) > 15
        return dict(body["error"])

    return check
