#!/usr/bin/env python3
"""The pad against other boards of 1250 mm: what is read, how exactly, how fast.

    bench_shootout.py [--full] [--json FILE]

The same poses, light and camera settings are simulated over every board: descents, tilts, looks,
a flight; then frames without the reader's own board. Verdicts are those of ``score.py``. Times are
of pictures already decoded, after a warm-up, in a process of each reader's own: with one thread on
all frames, with two on the descent and the flight. Exits with 1 if the detector gives a false pose.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import os
import platform
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import score
import shootout_frames as frames
import shootout_measure as measure
import shootout_tables
from shootout_readers import BOARDS, READERS

from padstudio import Camera, Pad, Pose

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
OURS = ("dense", "dense, tracked", "paper")
TWO_THREADS = ("descent", "flight")
DEFAULT_LEFT_OUT = ("PuzzleBoard 10 mm",)
Shots = dict[str, list[frames.Shot]]


def take(pad: Pad, camera: Camera, full: bool) -> Shots:
    """All frames by board."""
    planned = frames.views(full)
    prints: dict[str, Callable[[], Any]] = {"pad": lambda: pad, **BOARDS}
    taken: Shots = {}
    for board, make in prints.items():
        if not full and board in DEFAULT_LEFT_OUT:
            continue
        start = time.perf_counter()
        try:
            sheet = make()
        except ImportError:
            print(f"{board} is left out: calib-targets is not installed (pip install .[bench])")
            continue
        taken[board] = list(frames.shots(board, sheet, camera, planned))
        print(f"{board}: {len(planned)} frames in {time.perf_counter() - start:.0f} s", flush=True)
    taken["bare ground"] = list(frames.bare_ground(camera, 3))
    return taken


def shots_for(name: str, taken: Shots) -> list[frames.Shot]:
    """A reader's frames: its own board's, then those without it."""
    reader = READERS[name]
    own = [
        shot for shot in taken[reader.board] if reader.groups is None or shot.group in reader.groups
    ]
    if reader.groups is not None:
        return own
    others = [shot for board in taken if board != reader.board for shot in _samples(taken[board])]
    return own + [frames.Shot(o.board, "foreign", o.jpeg, None) for o in others]


def _samples(board: list[frames.Shot]) -> list[frames.Shot]:
    """Three frames of a board's descent, or of bare ground."""
    descent = [shot for shot in board if shot.group in ("descent", "foreign")]
    return descent[len(descent) // 6 :: max(len(descent) // 3, 1)][:3]


def judged(shot: frames.Shot, pose: Pose | None) -> dict[str, Any]:
    """A frame's verdict and errors."""
    truth = {"group": shot.group} | (_record(shot.pose) if shot.pose else {})
    found = {"status": "ok", **_record(pose)} if pose else None
    outcome = score.judge(truth, found, (shot.board, 0))
    return {
        "group": shot.group,
        "board": shot.board,
        "height_mm": round(float(shot.pose.position_mm[2]), 1) if shot.pose else None,
        "verdict": outcome.verdict,
        "position_percent": outcome.position_percent,
        "attitude_deg": outcome.attitude_deg,
    }


def _record(pose: Pose) -> dict[str, Any]:
    return {"position_mm": pose.position_mm.tolist(), "rotation": pose.rotation.tolist()}


def compete(name: str, pad: Pad, camera: Camera, taken: Shots) -> dict[str, Any]:
    """A reader's figures."""
    chosen = shots_for(name, taken)
    found = measure.readings(name, pad, camera, [shot.jpeg for shot in chosen], 1)
    rows = [judged(shot, reading.pose) for shot, reading in zip(chosen, found, strict=True)]
    for row, reading in zip(rows, found, strict=True):
        row |= {"wall_ms": round(reading.wall_ms, 2), "cpu_ms": round(reading.cpu_ms, 2)}
    some = [shot.jpeg for shot in chosen if shot.group in TWO_THREADS]
    two = measure.readings(name, pad, camera, some, 2)
    own = [row for row in rows if row["group"] != "foreign"]
    groups = {group: summary([r for r in rows if r["group"] == group]) for group in _groups(rows)}
    return {
        "total": summary(own),
        "groups": groups,
        "heights_mm": _range(rows),
        "one_thread": measure.times(found),
        "two_threads": measure.times(two),
        "frames": rows,
    }


def _groups(rows: list[dict[str, Any]]) -> list[str]:
    return list(dict.fromkeys(row["group"] for row in rows))


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Counts of verdicts, and the errors of the poses that are not false, percent of the height."""
    verdicts = Counter(row["verdict"] for row in rows)
    known = [
        row["position_percent"]
        for row in rows
        if row["verdict"] in ("good", "poor") and row["position_percent"] is not None
    ]
    return {
        "frames": len(rows),
        **{verdict: verdicts[verdict] for verdict in score.VERDICTS},
        "median_percent": float(np.median(known)) if known else None,
        "p95_percent": float(np.percentile(known, 95)) if known else None,
    }


def _range(rows: list[dict[str, Any]]) -> list[float] | None:
    """Lowest and highest height of the descents' good frames."""
    heights = [
        row["height_mm"]
        for row in rows
        if row["verdict"] == "good" and row["group"] in ("far", "descent", "near")
    ]
    return [min(heights), max(heights)] if heights else None


def footage(pad: Pad) -> dict[str, Any]:
    """Times of our detector on the footage's largest stills and on its flight."""
    camera = Camera.load(FOOTAGE / "camera_drone_2k7.yaml")
    truth = json.loads((FOOTAGE / "stills/truth.json").read_text(encoding="utf-8"))
    files = [FOOTAGE / t["file"] for t in truth if t["camera"] == "camera_drone_2k7.yaml"]
    stills = [file.read_bytes() for file in files]
    flight = FOOTAGE / "flights/landing.mp4"
    out: dict[str, Any] = {}
    for name, kind, source in (
        ("dense", "stills", stills),
        ("dense", "flight", flight),
        ("dense, tracked", "flight", flight),
    ):
        figures = {}
        for threads, word in ((1, "one_thread"), (2, "two_threads")):
            figures[word] = measure.times(measure.readings(name, pad, camera, source, threads))
        out[f"{name}: {kind}"] = figures
    return out


def machine() -> dict[str, Any]:
    """What the figures were measured with."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        lines = cpuinfo.read_text(encoding="utf-8").splitlines()
        model = next(
            (li.split(":")[1].strip() for li in lines if li.startswith("model name")), model
        )
    versions = {}
    for package in ("padstudio", "numpy", "numba", "opencv-python-headless", "calib-targets"):
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = "not installed"
    return {
        "date": time.strftime("%Y-%m-%d", time.gmtime()),
        "cpu": model,
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0],
        "python": platform.python_version(),
        "versions": versions,
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--full", action="store_true", help="three times the frames, a fifth board")
    parser.add_argument("--json", type=Path, help="write all figures to this file")
    given = parser.parse_args()
    pad = Pad.load(FOOTAGE / "pad_a.json")
    camera = Camera.load(FOOTAGE / "camera_drone_2k7.yaml")
    report: dict[str, Any] = {"machine": machine(), "seed": frames.SEED, "readers": {}}
    print(json.dumps(report["machine"]))
    taken = take(pad, camera, given.full)
    for name, reader in READERS.items():
        if reader.board in taken:
            report["readers"][name] = compete(name, pad, camera, taken)
            print(f"{name}: {report['readers'][name]['total']}", flush=True)
            _save(given.json, report)
    report["footage"] = footage(pad)
    shootout_tables.show(report)
    _save(given.json, report)
    ours = [report["readers"][name] for name in OURS]
    return int(any(g["false"] for figures in ours for g in figures["groups"].values()))


def _save(path: Path | None, report: dict[str, Any]) -> None:
    """Write what is known so far: a long run that is cut short is not lost."""
    if path:
        path.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
