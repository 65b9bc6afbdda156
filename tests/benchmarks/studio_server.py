"""A server of its own for benchmarks, and flights of the footage on it."""

from __future__ import annotations

import base64
import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import httpx
import psutil

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
LANDING = FOOTAGE / "flights" / "landing.mp4"
OPEN = ("queued", "running")
_PIECE_BYTES = 32_000_000
_TUS = {"Tus-Resumable": "1.0.0"}


@contextlib.contextmanager
def serving(
    data: Path, environment: Mapping[str, str] | None = None
) -> Iterator[tuple[httpx.Client, psutil.Process]]:
    """A client and the process of a server that is ended with the context."""
    program = Path(sys.executable).with_name("padstudio")
    command = [program, "serve", "--port", "0", "--data", data]
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, env={**os.environ, **(environment or {})}
    )
    try:
        assert process.stderr is not None
        address = process.stderr.readline().split()[2]
        with httpx.Client(base_url=address, timeout=60, trust_env=False) as client:
            yield client, psutil.Process(process.pid)
    finally:
        process.terminate()
        process.communicate(timeout=60)


def order(
    client: httpx.Client,
    video: Path,
    flights: int = 1,
    stride: int = 1,
    camera: str = "camera_drone_2k7.yaml",
) -> list[str]:
    """Addresses of flights of one video, with the footage's pad and a camera of it."""

    def store(address: str, path: Path) -> str:
        answer = client.post(address, files={"file": (path.name, path.read_bytes())})
        return str(answer.raise_for_status().json()["id"])

    wanted = {
        "uploads": [_upload(client, video)],
        "pad": store("/api/v1/pads/import", FOOTAGE / "pad_a.json"),
        "camera": store("/api/v1/cameras", FOOTAGE / camera),
        "stride": stride,
    }
    made = [client.post("/api/v1/flights", json=wanted).raise_for_status() for _ in range(flights)]
    return [answer.headers["Location"] for answer in made]


def _upload(client: httpx.Client, video: Path) -> str:
    name = base64.b64encode(video.name.encode()).decode()
    about = {
        "Upload-Length": str(video.stat().st_size),
        "Upload-Metadata": f"filename {name}",
    }
    made = client.post("/api/v1/uploads", headers=_TUS | about).raise_for_status()
    with video.open("rb") as file:
        while piece := file.read(_PIECE_BYTES):
            headers = _TUS | {
                "Upload-Offset": str(file.tell() - len(piece)),
                "Content-Type": "application/offset+octet-stream",
            }
            answer = client.patch(made.headers["Location"], headers=headers, content=piece)
            answer.raise_for_status()
    return str(made.json()["id"])
