#!/usr/bin/env python3
"""Prints pads and measures: time, size, memory, and where an independent renderer puts the edges.

    bench_print.py [--json FILE]

Each document is made in a process of its own, five times after a warm-up (the largest once); memory
is the process's peak. Edges are located in pages rendered by poppler. Exits with 1 if an edge is
0.05 mm or more off at 150 dpi or finer.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import platform
import resource
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from measure_print import document, edge_errors_mm, make_pad, pages

import padstudio
from padstudio.pad.layout import layout
from padstudio.pad.sheets.tiling import SheetOptions
from padstudio.render import documents
from padstudio.render.painters import raster
from padstudio.render.painters.options import PrintOptions

MOST_MM = 0.05
A4 = PrintOptions(sheets=SheetOptions(paper="A4"))
# Name, form, cells a side, cell mm, options, runs.
CASES: list[tuple[str, documents.Form, int, float, PrintOptions, int]] = [
    ("125 x 125, 10 mm, 35 sheets A4", "pdf", 125, 10.0, A4, 5),
    ("125 x 125, 1.4 mm, one sheet A4", "pdf", 125, 1.4, A4, 5),
    ("125 x 125, 10 mm, one page", "pdf", 125, 10.0, PrintOptions(), 5),
    ("1000 x 1000, 1 mm, one page", "pdf", 1000, 1.0, PrintOptions(), 1),
    ("1000 x 1000, 10 mm, one page", "pdf", 1000, 10.0, PrintOptions(), 1),
    ("125 x 125, PNG 300 dpi", "png", 125, 10.0, PrintOptions(dpi=300), 1),
    ("125 x 125, SVG", "svg", 125, 10.0, PrintOptions(), 5),
    ("125 x 125, DXF", "dxf", 125, 10.0, PrintOptions(), 5),
    ("1000 x 1000, DXF", "dxf", 1000, 10.0, PrintOptions(), 1),
]


def make(case: int) -> dict[str, Any]:
    """Make one document; runs in a process of its own."""
    name, form, cells, cell_mm, options, runs = CASES[case]
    pad = make_pad(cells, cells, cell_mm=cell_mm)
    if runs > 1:
        _size(pad, form, options)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    times, size = [], 0
    for _ in range(runs):
        start = time.perf_counter()
        size = _size(pad, form, options)
        times.append(time.perf_counter() - start)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {
        "name": name,
        "median_s": statistics.median(times),
        "spread_s": max(times) - min(times),
        "bytes": size,
        "peak_mb": peak / 1024,
        "grown_mb": (peak - before) / 1024,
    }


def _size(pad: padstudio.Pad, form: documents.Form, options: PrintOptions) -> int:
    return sum(map(len, documents.make(pad, form, options)[0]))


def edges(dpi: float) -> dict[str, Any]:
    """Errors of all cell edges of a 125 x 125 pad, mm, in poppler's and in our own picture."""
    pad = make_pad(125, 125)
    page = layout(pad)
    with tempfile.TemporaryDirectory() as folder:
        (image,) = pages(document(pad, "pdf"), Path(folder), dpi)
    errors = np.abs(edge_errors_mm(image, page, dpi / 25.4))
    own = np.abs(edge_errors_mm(raster.paint(pad, dpi / 25.4), page, dpi / 25.4))
    return {
        "dpi": dpi,
        "edges": len(errors),
        "most_mm": float(errors.max()),
        "rms_mm": float(np.sqrt(np.mean(errors**2))),
        "png_most_mm": float(own.max()),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    result: dict[str, Any] = {
        "version": padstudio.__version__,
        "python": platform.python_version(),
        "machine": platform.machine(),
        "documents": [],
        "edges": [],
    }
    processes = multiprocessing.get_context("spawn")
    for case in range(len(CASES)):
        with processes.Pool(1) as pool:
            done = pool.apply(make, (case,))
        result["documents"].append(done)
        print(
            f"{done['name']:34} {done['median_s']:7.2f} s ± {done['spread_s']:.2f}"
            f"  {done['bytes'] / 1e6:7.2f} MB  peak {done['peak_mb']:5.0f} MB"
        )
    for dpi in (72, 150, 203):
        found = edges(dpi)
        result["edges"].append(found)
        print(
            f"{dpi:4} dpi  {found['edges']} edges: PDF at most {found['most_mm']:.4f} mm, rms "
            f"{found['rms_mm']:.4f} mm; PNG at most {found['png_most_mm']:.4f} mm"
        )
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=1) + "\n")
    return int(any(e["most_mm"] >= MOST_MM for e in result["edges"] if e["dpi"] >= 150))


if __name__ == "__main__":
    sys.exit(main())
