#!/usr/bin/env python3
"""Where pads begin and end to read on simulated daylight, beside what the chart says.

    bench_limits.py [--method dense|paper …] [--scene NAME …] [--tilts DEG …] [--count N]

Each scene is a pad, a camera and the end of reading that it shows. Frames are simulated at heights
in even ratios about the chart's figure, each with its own heading, place and noise; those read
within 2 % of height and 2 degrees count, whatever of the pad they were read by. Printed are the
shares, and the height at which half are read over the chart's (low ends: cells too many or few).
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import cv2
import numpy as np

from padstudio import Camera, Detector, Pad
from padstudio.pad.coding.generate import PadSpec, generate_pad
from padstudio.pad.coverage.spans import METHOD_LIMITS, Method, coverage
from padstudio.pad.spec import Layer
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.success_map import MapGrid, only, success_map, view_of

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
# Ratios of heights about the chart's: even steps that leave room on both sides.
FACTORS = np.geomspace(0.68, 1.47, 9)


def camera(width: int, height: int, focal_px: float) -> Camera:
    """A pinhole."""
    return Camera(
        width, height, np.array([[focal_px, 0, width / 2], [0, focal_px, height / 2], [0, 0, 1]])
    )


CAMERAS = {
    "small": camera(640, 480, 500.0),
    "half": camera(1360, 765, 943.0),
    "tele": camera(800, 600, 2500.0),
}


@dataclass(frozen=True)
class Place:
    """A pad under a camera, and which end of which layer is looked at."""

    pad: Pad
    camera: str
    layer: str
    end: Literal["low", "high"]


def places() -> dict[str, Place]:
    """Lone layers and both together, three pads, three cameras."""
    footage = Pad.load(FOOTAGE / "pad_a.json")
    field = np.random.default_rng(3).integers(0, 2, (40, 40)).astype(np.uint8)
    forty = Pad((Layer("blue", 20.0, field),))
    two = Pad((Layer("red", 20.0, field), Layer("blue", 80.0, field[:10, :10])))
    dozen = Pad((Layer("red", 50.0, field[:12, :12]),))
    large = generate_pad(PadSpec(rows=250, cols=250, ratio=1, distance=2))
    coarse, fine = only(footage, "blue"), only(footage, "red")
    return {
        "cells of a fine layer": Place(large, "small", "red", "high"),
        "cells of a fine layer, half": Place(large, "half", "red", "high"),
        "coarse layer of the footage": Place(coarse, "small", "outline", "high"),
        "coarse layer of the footage, half": Place(coarse, "half", "outline", "high"),
        "coarse layer of the footage, tele": Place(coarse, "tele", "outline", "high"),
        "40 x 40 cells": Place(forty, "small", "outline", "high"),
        "40 x 40 cells, half": Place(forty, "half", "outline", "high"),
        "12 x 12 cells": Place(dozen, "small", "outline", "high"),
        "40 x 40 and 10 x 10 cells": Place(two, "small", "outline", "high"),
        "both layers of the footage": Place(footage, "half", "outline", "high"),
        "low end, coarse": Place(coarse, "small", "blue", "low"),
        "low end, fine": Place(fine, "half", "red", "low"),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--method", nargs="+", default=["dense"])
    parser.add_argument("--scene", nargs="+", help="names that begin so")
    parser.add_argument("--tilts", nargs="+", type=float, default=[0.0, 30.0, 55.0])
    parser.add_argument("--count", type=int, default=6, help="frames a height")
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    for method in arguments.method:
        print(f"\n{method}: {METHOD_LIMITS[method]}\n")
        print(
            "| pad | tilt | chart | found | share read, from low to high |\n|---|---|---|---|---|"
        )
        for name, place in places().items():
            if arguments.scene and not name.startswith(tuple(arguments.scene)):
                continue
            for tilt in arguments.tilts:
                compare(name, place, method, tilt, arguments.count)
    print(f"\n{time.process_time():.0f} s of processor time")


def compare(name: str, place: Place, method: Method, tilt_deg: float, count: int) -> None:
    """Print the chart's end of reading and the one found."""
    shot = CAMERAS[place.camera]
    spans = coverage(place.pad, view_of(shot), METHOD_LIMITS[method], (tilt_deg,))
    span = next(span for span in spans if span.layer == place.layer)
    chart = span.low_mm if place.end == "low" else span.high_mm
    detector = Detector(place.pad, shot, method=method)
    share = success_map(
        Scene(pad=place.pad),
        shot,
        lambda bgr: detector.detect(bgr).pose,
        MapGrid((chart * FACTORS).tolist(), values=[tilt_deg], trials=count),
    ).share[:, 0]
    # Spearman and Kärber's mean of the heights at which reading ends, in even ratios.
    part = share.mean() if place.end == "high" else 1 - share.mean()
    edges = np.log(FACTORS[[0, -1]]) + np.array([-0.5, 0.5]) * np.log(FACTORS[1] / FACTORS[0])
    found = float(np.exp(edges[0] + part * np.diff(edges)[0]))
    shares = " ".join(f"{each:.2f}" for each in share)
    print(f"| {name} | {tilt_deg:g}° | {chart:.0f} mm | {found:.2f} | {shares} |", flush=True)


if __name__ == "__main__":
    main()
