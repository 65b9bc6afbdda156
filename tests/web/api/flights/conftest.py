"""A served studio with real workers."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest
from flight_api import Api
from web_server import running, settings_for


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    settings = settings_for(
        tmp_path_factory.mktemp("flights"),
        workers=1,
        max_image_pixels=8_000_000,
        max_upload_bytes=5_000_000,
        detect_seconds=60,
        chunk_frames=30,
    )
    with running(settings) as client:
        client.timeout = httpx.Timeout(90)
        yield Api(client, settings.data)
