#!/usr/bin/env python3
"""How far and how fast fields are generated, verified and indexed, on one core.

    bench_coding.py [--quick] [--json FILE]

Every row is one call of `generate_field`, verification included, in a warm process; ``reached``
is the number of rows where the budget ended first. Without --quick the rows of a minute run too.
Pads follow, with independent layers and with the paper's, in turns.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numba
import numpy as np

from padstudio.pad.coding.generate import (
    FieldSearchError,
    FieldSpec,
    PadSpec,
    generate_field,
    generate_pad,
)
from padstudio.pad.coding.search.bounds import bounds
from padstudio.pad.coding.verify import verify_field
from padstudio.pad.coding.window_index import WindowIndex

PLAIN: dict[str, Any] = {"unique": "plain", "distance": 1}
# (spec, side, budget in seconds)
QUICK: list[tuple[dict[str, Any], int, float]] = [
    ({"distance": 1}, 125, 0.1),
    ({"distance": 1}, 1000, 1),
    ({"distance": 1}, 1850, 5),
    ({"window": 4, "distance": 1}, 90, 0.1),
    ({"window": 3, "distance": 1}, 12, 1),
    ({"distance": 3}, 125, 0.5),
    ({"distance": 4}, 50, 1),
    ({"distance": 2}, 400, 1),
    (PLAIN, 3000, 5),
    ({"window": 3, "levels": 3, "distance": 1}, 52, 5),
    ({"window": 3, "levels": 4, "distance": 1}, 183, 5),
    ({"window": 4, "levels": 3, "distance": 1}, 2323, 60),
    ({"window": 2, "levels": 4, "distance": 1}, 6, 1),
    ({"window": 6, "distance": 1}, 500, 5),
    ({"window": 7, "levels": 9, "distance": 1}, 500, 5),
    ({"window": 8, "levels": 16, "distance": 1}, 500, 5),
]
PADS: list[tuple[dict[str, Any], int]] = [
    ({"distance": 3}, 125),
    ({"distance": 2}, 250),
    ({"distance": 1}, 1000),
    ({"window": 6, "distance": 3}, 250),
    ({"window": 4, "levels": 3, "distance": 2}, 125),
    (PLAIN, 1000),
]
LONG: list[tuple[dict[str, Any], int, float]] = [
    ({"distance": 1}, 1900, 60),
    ({"window": 4, "distance": 1}, 100, 60),
    ({"window": 4, "distance": 1}, 101, 60),
    ({"distance": 3}, 140, 60),
    ({"distance": 4}, 55, 60),
    (PLAIN, 5000, 60),
    (PLAIN, 5796, 60),
]


def measure(kind: dict[str, Any], side: int, budget_s: float) -> dict[str, Any]:
    spec = FieldSpec(rows=side, cols=side, **kind)
    start, start_cpu = time.perf_counter(), time.process_time()
    try:
        # More time than asked for, so that a miss, or a busy machine, shows by how much.
        reached = len(generate_field(spec, budget_s=max(30, 2 * budget_s)))
    except FieldSearchError as error:
        reached = error.detail["rows"]
    return {
        "window": spec.window,
        "levels": spec.levels,
        "unique": spec.unique,
        "distance": spec.distance,
        "side": side,
        "bound": bounds(spec).largest_square,
        "reached": reached,
        "allowed_s": budget_s,
        "elapsed_s": time.perf_counter() - start,
        "cpu_s": time.process_time() - start_cpu,
    }


def measure_pads(kind: dict[str, Any], side: int, rounds: int = 5) -> dict[str, Any]:
    """Least CPU time of a pad with either kind of layers."""
    least = {"independent": float("inf"), "paper": float("inf")}
    for _ in range(rounds):
        for layers in least:
            start = time.process_time()
            generate_pad(PadSpec(rows=side, cols=side, layers=layers, **kind))
            least[layers] = min(least[layers], time.process_time() - start)
    return {"kind": kind, "side": side, **{f"{key}_s": value for key, value in least.items()}}


def measure_index(side: int) -> dict[str, Any]:
    field = generate_field(FieldSpec(rows=side, cols=side, window=6, distance=1), budget_s=200)
    start = time.perf_counter()
    index = WindowIndex(field, 6, 2)
    build_s = time.perf_counter() - start
    rng = np.random.default_rng(0)
    rows, cols = rng.integers(0, side - 5, (2, 20_000))
    read = np.stack([field[r : r + 6, c : c + 6] for r, c in zip(rows, cols, strict=True)])
    start = time.perf_counter()
    places = index.lookup(read)
    lookup_us = (time.perf_counter() - start) / len(read) * 1e6
    return {
        "side": side,
        "build_s": build_s,
        "lookup_us": lookup_us,
        "bytes_per_window": index.nbytes / (side - 5) ** 2,
        "right": bool((places.rows == rows).all() and (places.cols == cols).all()),
    }


def measure_verifier(side: int, distance_limit: int) -> dict[str, Any]:
    field = generate_field(FieldSpec(rows=side, cols=side, distance=1))
    start = time.perf_counter()
    verify_field(field, 5, 2, distance_limit=distance_limit)
    return {"side": side, "limit": distance_limit, "elapsed_s": time.perf_counter() - start}


def first_call_s() -> float:
    """Time of the first pad of a fresh process over the next one's, compiled code cached."""
    script = (
        "import time\nfrom padstudio.pad.coding.generate import generate_pad\n"
        "t = time.perf_counter()\n"
        "generate_pad()\nu = time.perf_counter()\ngenerate_pad()\n"
        "print(2 * u - t - time.perf_counter())"
    )
    done = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True)
    return float(done.stdout)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    generate_field(FieldSpec(rows=20, cols=20))
    generate_field(FieldSpec(rows=20, cols=20, window=6))
    report: dict[str, Any] = {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
        "cpus": os.cpu_count(),
        "fields": [],
    }
    print(" b  Y unique   d    n  bound  reached  allowed s  elapsed s    cpu s")
    for kind, side, budget_s in QUICK if given.quick else QUICK + LONG:
        row = measure(kind, side, budget_s)
        report["fields"].append(row)
        print(
            f"{row['window']:2d} {row['levels']:2d} {row['unique']:8s} {row['distance']:1d} "
            f"{side:4d} {row['bound']:6d} {row['reached']:8d} {budget_s:10.1f} "
            f"{row['elapsed_s']:10.3f} {row['cpu_s']:8.3f}",
            flush=True,
        )
    report["first_call_s"] = first_call_s()
    print(f"first call of a fresh process: {report['first_call_s']:.2f} s more than the next")
    report["index"] = [measure_index(side) for side in (125, 1000, 4000)]
    for row in report["index"]:
        print("index    ", *(f"{k} {v:.3g}" for k, v in row.items()))
    report["pads"] = [measure_pads(*case) for case in PADS]
    for row in report["pads"]:
        print("pads     ", *(f"{k} {v}" if k == "kind" else f"{k} {v:.3g}" for k, v in row.items()))
    report["verifier"] = [measure_verifier(*case) for case in ((125, 4), (1000, 1), (1850, 0))]
    for row in report["verifier"]:
        print("verifier ", *(f"{k} {v:.3g}" for k, v in row.items()))
    if given.json:
        given.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
