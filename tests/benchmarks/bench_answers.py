#!/usr/bin/env python3
"""How soon the server answers while flights are at work: milliseconds of each address.

    bench_answers.py [--seconds N] [--flights N] [--json FILE]

A server of its own, with worker processes, works on flights of the footage; one client asks for
what the page of a flight asks for, one address after the other. Other work on the machine counts.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import httpx
import numpy as np
from studio_server import LANDING, OPEN, order, serving

# So often a page looks while it follows a flight; others ask between.
PAUSE_S = 0.02


def measure(client: httpx.Client, flights: list[str], seconds: float) -> dict[str, list[float]]:
    """Milliseconds of each answer while the last of the flights is not over."""
    first = flights[0]
    while client.get(first).json()["frames_done"] == 0:
        time.sleep(0.1)
    addresses = {
        "page of a flight": f"/flights/{first.rsplit('/', 1)[1]}",
        "page of flights": "/flights",
        "flights": "/api/v1/flights",
        "flight": first,
        "frames, a page of 25": f"{first}/frames?limit=25",
        "frame": f"{first}/frames/3",
        "timeline": f"{first}/timeline?columns=800",
        "figures": f"{first}/figures",
        "summary": f"{first}/summary",
    }
    taken: dict[str, list[float]] = {name: [] for name in addresses}
    end = time.monotonic() + seconds
    while time.monotonic() < end and client.get(flights[-1]).json()["state"] in OPEN:
        for name, address in addresses.items():
            start = time.perf_counter()
            client.get(address).raise_for_status()
            taken[name].append(1e3 * (time.perf_counter() - start))
            time.sleep(PAUSE_S)
    return taken


def main() -> None:
    parser = argparse.ArgumentParser(description="Answers of the server while flights are at work.")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--flights", type=int, default=20, help="enough to last that long")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, serving(Path(folder) / "data") as (client, _):
        flights = order(client, LANDING, given.flights)
        taken = measure(client, flights, given.seconds)
    taken["all"] = [ms for each in taken.values() for ms in each]
    report: dict[str, Any] = {}
    for name, ms in taken.items():
        p50, p95, p99, most = np.percentile(ms, [50, 95, 99, 100])
        report[name] = {"p50_ms": p50, "p95_ms": p95, "p99_ms": p99, "max_ms": most}
        print(f"{name:22}{len(ms):5} answers{p50:8.1f}{p95:8.1f}{p99:8.1f}{most:8.1f} ms")
    if given.json:
        given.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
