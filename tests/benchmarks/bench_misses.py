#!/usr/bin/env python3
"""What a frame without a pad costs, by ground and size, beside stills of that size with one.

    bench_misses.py [--frames N] [--against TREE]

CPU time of `Detector.detect`, milliseconds, median and worst of N frames from 1 to 4 m: bare
grounds, a plaid of lines at right angles, and a foreign pad. TREE is another copy of the project,
whose detector is measured with the same frames in a process of its own. Exits with 1 where a frame
without the pad gets a pose.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from padstudio import Camera, Detector, Pad
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Layer
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render

Image = NDArray[np.uint8]
SIZES = {1: (1152, 864), 4: (2304, 1728), 12: (4000, 3000)}
GROUNDS = ("gravel", "grass", "bricks", "concrete")


def camera(megapixels: int) -> Camera:
    """A camera of 66 degrees across, whatever its size."""
    width, height = SIZES[megapixels]
    matrix = [[0.77 * width, 0, (width - 1) / 2], [0, 0.77 * width, (height - 1) / 2], [0, 0, 1]]
    return Camera(width, height, np.array(matrix))


def pad(seed: int) -> Pad:
    """125 x 125 red cells of 10 mm, 25 x 25 blue ones of 50 mm, both at random."""
    rng = np.random.default_rng(seed)
    fine, coarse = (rng.integers(0, 2, (count, count)) for count in (125, 25))
    return Pad((Layer("red", 10.0, fine), Layer("blue", 50.0, coarse)))


def seen(scene: Callable[[int], Scene], megapixels: int, number: int) -> Image:
    rng = np.random.default_rng(number)
    pose = look_at_pad(
        float(rng.uniform(1000, 4000)), tilt_deg=rng.uniform(0, 35), heading_deg=rng.uniform(0, 360)
    )
    return render(scene(number), camera(megapixels), pose, seed=number).image


def plaid(megapixels: int, number: int) -> Image:
    width, height = SIZES[megapixels]
    rng = np.random.default_rng(number)
    y, x = np.mgrid[:height, :width].astype(np.float32)
    turn = rng.uniform(0, 1.5)
    u, v = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
    picture = np.full((height, width, 3), 130.0, np.float32)
    for period in rng.uniform(12, 60, 3):
        for along in (u, v):
            color = rng.uniform(-40, 40, 3).astype(np.float32)
            picture += color * ((along / period) % 1 < 0.4)[..., None]
    picture += rng.normal(0, 3, picture.shape).astype(np.float32)
    return np.clip(picture, 0, 255).astype(np.uint8)


def kinds() -> dict[str, Callable[[int, int], Image]]:
    """Makers of frames by megapixels and number; the first one's show the pad."""

    def of(scene: Callable[[int], Scene]) -> Callable[[int, int], Image]:
        return lambda megapixels, number: seen(scene, megapixels, number)

    found = {"with the pad": of(lambda number: Scene(pad=pad(1), ground_seed=number))}
    for kind in GROUNDS:
        found[kind] = of(lambda number, kind=kind: Scene(pad=None, ground=kind, ground_seed=number))
    found["plaid"] = plaid
    found["foreign pad"] = of(lambda number: Scene(pad=pad(100 + number), ground_seed=number))
    return found


def measured(frames: int) -> Iterator[tuple[str, int, list[float], int]]:
    """Kind, megapixels, CPU times in ms and the number of poses."""
    for megapixels in SIZES:
        detector = Detector(pad(1), camera(megapixels))
        for kind, make in kinds().items():
            times, poses = [], 0
            for number in range(frames):
                image = make(megapixels, number)
                # The first look at a size loads and makes what all others find ready.
                for _ in range(2 if not times else 1):
                    begin = time.thread_time()
                    poses += detector.detect(image).ok
                    elapsed = 1e3 * (time.thread_time() - begin)
                times.append(elapsed)
            yield kind, megapixels, times, poses


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=6)
    parser.add_argument("--against", type=Path)
    args = parser.parse_args()
    if args.against is not None:
        print(f"{args.against}:")
        environment = {**os.environ, "PYTHONPATH": str(args.against / "backend")}
        command = [sys.executable, __file__, "--frames", str(args.frames)]
        subprocess.run(command, env=environment, check=False)
        print("this tree:")
    false, base = 0, {}
    print(f"{'':14} {'Mpx':>4} {'median':>8} {'worst':>8} {'of a still':>11}")
    for kind, megapixels, times, poses in measured(args.frames):
        median = float(np.median(times))
        base.setdefault(megapixels, median)
        share = f"{median / base[megapixels]:5.1f} {max(times) / base[megapixels]:5.1f}"
        print(f"{kind:14} {megapixels:4} {median:8.1f} {max(times):8.1f} {share:>11}", flush=True)
        false += poses if kind != "with the pad" else 0
    return bool(false)


if __name__ == "__main__":
    sys.exit(main())
