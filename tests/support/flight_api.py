"""A client of a served studio that orders flights and waits for them."""

from __future__ import annotations

import base64
import time
from pathlib import Path
from typing import Any

import httpx
from places import FOOTAGE

API = "/api/v1"
OVER = ("done", "failed", "cancelled")


class Api:
    """A client with a pad, a camera and a video uploaded."""

    def __init__(self, client: httpx.Client, data: Path) -> None:
        self.client, self.data = client, data
        pad = (FOOTAGE / "pad_a.json").read_bytes()
        camera = (FOOTAGE / "camera_drone_2k7.yaml").read_bytes()
        self.pad = self.post_file("/pads/import", "pad.json", pad)
        self.camera = self.post_file("/cameras", "camera.yaml", camera)
        self.video = self.upload((FOOTAGE / "flights" / "landing.mp4").read_bytes(), "landing.mp4")

    def post_file(self, path: str, name: str, content: bytes) -> str:
        answer = self.client.post(API + path, files={"file": (name, content)})
        return str(answer.raise_for_status().json()["id"])

    def upload(self, content: bytes, name: str = "file") -> str:
        headers = {
            "Tus-Resumable": "1.0.0",
            "Upload-Length": str(len(content)),
            "Upload-Metadata": "filename " + base64.b64encode(name.encode()).decode(),
            "Content-Type": "application/offset+octet-stream",
        }
        answer = self.client.post(f"{API}/uploads", content=content, headers=headers)
        return str(answer.raise_for_status().json()["id"])

    def order(self, *uploads: str, **values: Any) -> httpx.Response:
        ids = {"uploads": list(uploads) or [self.video], "pad": self.pad, "camera": self.camera}
        return self.client.post(f"{API}/flights", json=ids | values)

    def finished(self, flight: str) -> dict[str, Any]:
        """Wait until a flight is over."""
        end = time.monotonic() + 120
        while (found := self.get(flight))["state"] not in OVER:
            assert time.monotonic() < end
            time.sleep(0.1)
        return found

    def get(self, path: str) -> dict[str, Any]:
        return dict(self.client.get(f"{API}/flights/{path}").raise_for_status().json())
