#!/usr/bin/env python3
"""Memory of the server and its workers over a long video: MB now and then, and the most.

    bench_memory.py [--minutes N] [--stride N] [--json FILE]

The video is the footage's landing over and over, its packets copied as they are. Every frame of it
is decoded; every n-th is looked at.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import tempfile
import time
from pathlib import Path

import httpx
import psutil
from looped import looped
from studio_server import LANDING, OPEN, order, serving

LINES = 12


def workers_mb(server: psutil.Process) -> list[float]:
    """Memory of the worker processes that are at work, the two largest."""
    found = []
    for child in server.children(recursive=True):
        with contextlib.suppress(psutil.Error):
            found.append(child.memory_info().rss / 1e6)
    return sorted(found)[-2:]


def watch(client: httpx.Client, server: psutil.Process, flight: str) -> list[dict[str, float]]:
    """Looks at memory once a second until the flight is over."""
    start, looks = time.monotonic(), []
    while True:
        state = client.get(flight).raise_for_status().json()
        largest = workers_mb(server)
        looks.append(
            {
                "seconds": time.monotonic() - start,
                "frames": state["frames_done"],
                "server_mb": server.memory_info().rss / 1e6,
                "worker_mb": largest[-1] if largest else 0.0,
            }
        )
        if state["state"] not in OPEN:
            assert state["state"] == "done", state["error"]
            return looks
        time.sleep(1)


def main() -> None:
    parser = argparse.ArgumentParser(description="Memory over a long video.")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--stride", type=int, default=20, help="look at every n-th frame")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    given = parser.parse_args()
    with (
        tempfile.TemporaryDirectory() as folder,
        serving(Path(folder) / "data") as (client, server),
    ):
        video = looped(LANDING, Path(folder) / "long.mp4", minutes=given.minutes)
        (flight,) = order(client, video, stride=given.stride)
        looks = watch(client, server, flight)
    largest = max(looks, key=lambda look: look["worker_mb"])
    for look in (*looks[:: max(1, len(looks) // LINES)], largest):
        print(
            f"{look['seconds']:6.0f} s {look['frames']:6} frames"
            f"   server {look['server_mb']:5.0f} MB   largest worker {look['worker_mb']:5.0f} MB"
        )
    if given.json:
        given.json.write_text(json.dumps(looks, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
