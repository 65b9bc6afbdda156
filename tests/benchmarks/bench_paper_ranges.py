#!/usr/bin/env python3
"""At which heights the paper's method reads which layer, on simulated frames with known poses.

    bench_paper_ranges.py [--count N] [--height MM …] [--method paper|dense]

The paper's camera (f = 1886 px, 2720 x 1530) over a pad of 125 x 125 cells of 10 mm and 25 x 25 of
50 mm, on grass, without motion: any heading, tilts of 0 to 40 degrees, the optical axis on the pad.
Prints a table in Markdown. Exits with 1 if any pose is false (10 % of the height, 10 degrees).
"""

from __future__ import annotations

import argparse
import statistics
import sys
from collections import Counter
from pathlib import Path

import cv2
import numpy as np

from padstudio import Camera, Detection, Detector, Pad
from padstudio.geometry.pose import Pose, look_at_pad, rotation_angle_deg
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
HEIGHTS_MM = (
    *(65, 80, 100, 120, 150, 180, 220, 260, 300, 350, 500, 700, 1000, 1300, 1540),
    *(2000, 3000, 5000, 8000, 12000),
)
TILTS_DEG = (0.0, 10.0, 20.0, 30.0, 40.0)


def poses(height_mm: float, count: int, half_mm: float) -> list[Pose]:
    """Poses that look at the pad from a height, the same at every run."""
    rng = np.random.default_rng(round(height_mm))
    # The whole sign must stay in view where it fits; from near, the picture stays on the pad.
    reach = max(0.0, half_mm - 0.6 * height_mm)
    return [
        look_at_pad(
            height_mm,
            tilt_deg=TILTS_DEG[k % len(TILTS_DEG)],
            heading_deg=rng.uniform(0, 360),
            tilt_towards_deg=rng.uniform(0, 360),
            target_mm=(rng.uniform(-reach, reach), rng.uniform(-reach, reach)),
        )
        for k in range(count)
    ]


def errors(found: Pose, true: Pose) -> tuple[float, float]:
    """Of position in percent of the height, and of attitude in degrees."""
    off = float(np.linalg.norm(found.position_mm - true.position_mm))
    return 100 * off / true.position_mm[2], rotation_angle_deg(found.rotation, true.rotation)


def row(height_mm: float, results: list[tuple[Pose, Detection]]) -> tuple[str, int]:
    """A line of the table, and the number of false poses."""
    count = len(results)
    layers = Counter(found.layer for _, found in results)
    off = [errors(found.pose, true) for true, found in results if found.pose]
    good = sum(p <= 2 and a <= 2 for p, a in off)
    false = sum(p > 10 or a > 10 for p, a in off)
    shares = " | ".join(f"{100 * layers[k] / count:.0f} %" for k in ("red", "blue", "outline"))
    middle = f"{statistics.median(p for p, _ in off):.3f} %" if off else "–"
    worst = f"{max(p for p, _ in off):.2f} %" if off else "–"
    times = statistics.median(found.elapsed_ms["total"] for _, found in results)
    return (
        f"| {height_mm / 1000:g} m | {shares} | {100 * good / count:.0f} % | {false} | {middle} | "
        f"{worst} | {times:.0f} ms |",
        false,
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--count", type=int, default=25)
    parser.add_argument("--height", type=float, nargs="+", default=HEIGHTS_MM)
    parser.add_argument("--method", choices=("paper", "dense"), default="paper")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    pad = Pad.load(FOOTAGE / "pad_a.json")
    camera = Camera.load(FOOTAGE / "camera_drone_2k7.yaml")
    detector = Detector(pad, camera, method=options.method)
    print("| height | red | blue | outline | good | false | median error | worst | time |")
    print("|---|---|---|---|---|---|---|---|---|")
    all_false = 0
    for height_mm in options.height:
        results = []
        for seed, pose in enumerate(poses(height_mm, options.count, pad.width_mm / 2)):
            frame = render(Scene(pad=pad), camera, pose, seed=seed)
            results.append((pose, detector.detect(frame.image)))
        line, false = row(height_mm, results)
        all_false += false
        print(line, flush=True)
    return bool(all_false)


if __name__ == "__main__":
    sys.exit(main())
