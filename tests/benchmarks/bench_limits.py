#!/usr/bin/env python3
"""Where a lone layer begins and ends to read, on simulated daylight: the figures of METHOD_LIMITS.

    bench_limits.py [--method dense|paper …] [--count N]

Each layer of the pad of the footage alone, seen by a camera of 1360 x 765 pixels (f = 943 px),
at heights chosen by the cells across the picture and by the pixels of a cell, straight down and
tilted. Prints the share of frames read by the layer's cells, and the place where it crosses a half.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from padstudio import Camera, Detector, Pad
from padstudio.geometry.pose import Pose
from padstudio.pad.coverage import METHOD_LIMITS, Method
from padstudio.simulate.coverage import only, success_map, view_of
from padstudio.simulate.scene import Scene

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
HALF = Camera(1360, 765, np.array([[943.0, 0, 679.5], [0, 943.0, 382.0], [0, 0, 1]]))
TILTS_DEG = (0.0, 30.0, 55.0)
CELLS_ACROSS = {"dense": (3.0, 3.4, 3.8, 4.2, 4.6, 5.0), "paper": (3.5, 4.5, 5.5, 6.5, 7.5)}
CELL_PX = {"dense": (3.0, 3.5, 4.0, 4.5, 5.0, 6.0), "paper": (18.0, 24.0, 30.0, 36.0, 45.0)}


def crossing(at: tuple[float, ...], share: np.ndarray) -> float:
    """Where the share first stays at a half or more, between the values tried."""
    low = max((k for k, part in enumerate(share) if part < 0.5), default=-1)
    if low < 0 or low + 1 == len(at):
        return at[0] if low < 0 else np.inf
    step = (0.5 - share[low]) / (share[low + 1] - share[low])
    return float(at[low] + step * (at[low + 1] - at[low]))


def shares(
    pad: Pad, method: Method, heights_mm: list[float], tilt_deg: float, count: int
) -> np.ndarray:
    """Share of frames read by the layer's cells, at each height."""
    detector = Detector(pad, HALF, method=method)

    def by_cells(bgr: np.ndarray) -> Pose | None:
        detection = detector.detect(bgr)
        return None if detection.layer == "outline" else detection.pose

    return success_map(
        Scene(pad=pad), HALF, by_cells, heights_mm=heights_mm, values=[tilt_deg], trials=count
    ).share[:, 0]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--method", nargs="+", default=["dense", "paper"])
    parser.add_argument("--count", type=int, default=8, help="frames a place")
    arguments = parser.parse_args()
    whole = Pad.load(FOOTAGE / "pad_a.json")
    view, focal = view_of(HALF), float(HALF.matrix[0, 0])
    for method in arguments.method:
        print(f"\n{method}: the chart has {METHOD_LIMITS[method]}\n")
        print("| layer | tilt | of | share read at | half at |\n|---|---|---|---|---|")
        for channel in ("blue", "red"):
            pad = only(whole, channel)
            cell = pad.layers[0].cell_mm
            for tilt in TILTS_DEG:
                extent = view.extent_per_height(tilt)
                shorter = focal * cell * np.cos(np.radians(tilt)) ** 1.5
                for what, at, heights in (
                    (
                        "cells across",
                        CELLS_ACROSS[method],
                        [a * cell / extent for a in CELLS_ACROSS[method]],
                    ),
                    ("pixels a cell", CELL_PX[method], [shorter / p for p in CELL_PX[method]]),
                ):
                    share = shares(pad, method, heights, tilt, arguments.count)
                    read = ", ".join(f"{a:g}: {s:.2f}" for a, s in zip(at, share, strict=True))
                    half = crossing(at, share)
                    print(f"| {channel} | {tilt:g}° | {what} | {read} | {half:.1f} |", flush=True)


if __name__ == "__main__":
    main()
