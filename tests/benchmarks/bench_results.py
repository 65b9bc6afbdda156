#!/usr/bin/env python3
"""Queries over the frames of a long flight: milliseconds of each, 50th and 95th percentile.

    bench_results.py [--frames N] [--database URL] [--repeat N] [--json FILE]

The flight is made up: a camera that goes up and down over the pad, failures singly and in runs.
Places of pages and ends of ranges are drawn anew for each repetition. Nothing that the server keeps
is used: these are the figures of the first time that somebody asks.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from padstudio.flights.results.charts import FigureRows
from padstudio.flights.results.frames import FrameFilter, Results
from padstudio.flights.results.rows import insert_rows
from padstudio.flights.results.summaries import Summaries
from padstudio.store.database.engine import Sessions, open_database
from padstudio.store.database.flight_tables import FlightRow

FPS = 30
BLOCK = 20_000
LAYERS = ("red", "blue", "outline")
REASONS = (("decode", "unknown_code"), ("edges", "no_edges"), ("lines", "motion_blur"))


def rows(key: int, first: int, count: int) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Rows of both tables; one frame of fifty fails, and every ten minutes a minute of them."""
    for number in range(first, first + count):
        time_s = number / FPS
        ok = number % 50 != 7 and number % (600 * FPS) > 60 * FPS
        height = 10_000 * (1.01 - np.cos(time_s / 60))
        stage, reason = (None, None) if ok else REASONS[number // 50 % 3]
        frame = {
            "flight": key,
            "number": number,
            "time_s": time_s,
            "status": "ok" if ok else "failed",
            "stage": stage,
            "reason": reason,
            "layer": LAYERS[int(height > 3000) + int(height > 15_000)] if ok else None,
            "x_mm": 100.0 if ok else None,
            "y_mm": -50.0 if ok else None,
            "z_mm": float(height) if ok else None,
        }
        body: dict[str, Any] = {"source": "flight.mp4", "elapsed_ms": {"total": 9.87}}
        if ok:
            body |= {"quaternion_xyzw": [1.0, 0.0, 0.0, 0.0], "covariance": [0.0123] * 21}
            body |= {"heading_deg": 12.3, "tilt_deg": 4.5, "cells_read": 900, "cells_wrong": 3}
        else:
            body |= {"detail": "no window of the pad has the code that was read", "advice": ""}
        yield frame, {"flight": key, "number": number, "chunk": 1, "body": body}


def fill(sessions: Sessions, frames: int) -> FlightRow:
    """A flight with that many frames."""
    flight = FlightRow(
        id="long",
        created_at=datetime.now(UTC),
        name="long",
        state="done",
        request={"stride": 1},
        sources=[],
        frames_total=frames,
        frames_done=frames,
        frames_ok=0,
        pad="",
        camera="",
        telemetry=None,
    )
    with sessions.begin() as session:
        session.add(flight)
    for first in range(0, frames, BLOCK):
        pairs = list(rows(flight.key, first, min(BLOCK, frames - first)))
        with sessions.begin() as session:
            short, long = ([pair[place] for pair in pairs] for place in (0, 1))
            insert_rows(session, flight.request, short, long)
    return flight


def queries(sessions: Sessions, flight: FlightRow, frames: int) -> dict[str, Callable[[], Any]]:
    """What the page of a flight and scripts ask for, each at a place of its own."""
    random = np.random.default_rng(1)
    results = Results(sessions)

    def page(limit: int = 50, **wanted: Any) -> Callable[[], Any]:
        chosen = FrameFilter(**wanted)
        return lambda: results.page(flight, chosen, limit, int(random.integers(frames)))

    def back() -> Any:
        wanted = FrameFilter(status="failed")
        return results.page(flight, wanted, 50, None, int(random.integers(frames)))

    def within() -> Any:
        start = float(random.uniform(0, frames / FPS))
        return results.page(flight, FrameFilter(status="failed", from_s=start, to_s=start + 60), 50)

    def part() -> Any:
        first = int(random.integers(max(1, frames - 20_000)))
        return FigureRows(sessions).timeline(flight, 800, first, first + 20_000)

    return {
        "one frame": lambda: results.frame(flight, int(random.integers(frames))),
        "page of all": page(),
        "page of 1000": page(1000),
        "page by status": page(status="failed"),
        "page by reason": page(reason="motion_blur"),
        "page by stage": page(stage="edges"),
        "page by layer": page(layer="red"),
        "page by height": page(min_height=19_000.0),
        "page by rare height": page(min_height=1e6),
        "page by status and height": page(status="ok", max_height=200.0),
        "page by time": within,
        "page backwards": back,
        "timeline, a part": part,
        "timeline, whole": lambda: FigureRows(sessions).timeline(flight, 800),
        "figures": lambda: FigureRows(sessions).figures(flight),
        "summary": lambda: Summaries(sessions).of(flight),
    }


def measure(ask: Callable[[], Any], repeat: int) -> dict[str, float]:
    """Milliseconds by the clock, after one try to warm up."""
    ask()
    taken = []
    for _ in range(repeat):
        start = time.perf_counter()
        ask()
        taken.append(1e3 * (time.perf_counter() - start))
    return {"p50_ms": float(np.median(taken)), "p95_ms": float(np.percentile(taken, 95))}


def main() -> None:
    parser = argparse.ArgumentParser(description="Queries over the frames of a long flight.")
    parser.add_argument("--frames", type=int, default=1_000_000)
    parser.add_argument("--database", help="URL of an empty database; SQLite by default")
    parser.add_argument("--repeat", type=int, default=20)
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        engine = open_database(given.database or f"sqlite:///{folder}/studio.db")
        sessions = Sessions(engine)
        start = time.perf_counter()
        flight = fill(sessions, given.frames)
        print(f"{given.frames} frames stored in {time.perf_counter() - start:.0f} s")
        report = {}
        for name, ask in queries(sessions, flight, given.frames).items():
            report[name] = measure(ask, given.repeat)
            figures = report[name]
            print(f"{name:28}{figures['p50_ms']:9.1f} ms{figures['p95_ms']:9.1f} ms")
        engine.dispose()
    if given.json:
        given.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
