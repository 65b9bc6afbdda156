#!/usr/bin/env python3
"""How often a picture without the pad is given a pose.

    bench_false_alarms.py [--count N] [--seed S] [--method dense|paper]

Bare grounds, pads of the same kind from other seeds, checkerboards, ArUco boards, printed text and
noise, each from any height, tilt and heading. Prints poses and the strongest evidence by kind;
exits with 1 if there is a pose. A pose on a foreign pad is as false as one on grass.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio import Camera, Detector, Pad
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.spec import Layer
from padstudio.simulate.radiance.scene import GROUND_KINDS, Scene
from padstudio.simulate.render import render

WIDTH, HEIGHT, FOCAL_PX = 960, 720, 660.0
Image = NDArray[np.uint8]
Rng = np.random.Generator


def camera() -> Camera:
    """A small camera, so that hundreds of pictures take minutes."""
    centre = ((WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    matrix = np.array([[FOCAL_PX, 0, centre[0]], [0, FOCAL_PX, centre[1]], [0, 0, 1]])
    return Camera(WIDTH, HEIGHT, matrix)


def random_pad(rng: Rng) -> Pad:
    """125 x 125 red cells of 10 mm, 25 x 25 blue ones of 50 mm, both at random."""
    return Pad(
        (
            Layer("red", 10.0, rng.integers(0, 2, (125, 125), np.uint8)),
            Layer("blue", 50.0, rng.integers(0, 2, (25, 25), np.uint8)),
        )
    )


def any_pose(rng: Rng) -> Pose:
    """From 8 cm to 8 m, tilted by up to 60 degrees."""
    return look_at_pad(
        float(np.exp(rng.uniform(np.log(80), np.log(8000)))),
        tilt_deg=rng.uniform(0, 60),
        heading_deg=rng.uniform(0, 360),
        tilt_towards_deg=rng.uniform(0, 360),
    )


def seen(rng: Rng, scene: Scene) -> Image:
    """A scene from any pose."""
    return render(scene, camera(), any_pose(rng), seed=int(rng.integers(2**31))).image


def ground(rng: Rng) -> Image:
    kind = GROUND_KINDS[int(rng.integers(len(GROUND_KINDS)))]
    return seen(rng, Scene(pad=None, ground=kind, ground_seed=int(rng.integers(1000))))


def foreign(rng: Rng) -> Image:
    return seen(rng, Scene(pad=random_pad(rng), ground_seed=int(rng.integers(1000))))


def checkerboard(rng: Rng) -> Image:
    cells = (np.add.outer(np.arange(25), np.arange(25)) % 2).astype(np.uint8)
    pad = Pad((Layer("red", 50.0, cells), Layer("blue", 50.0, cells)), window=3)
    return seen(rng, Scene(pad=pad))


def warped(rng: Rng, page: Image) -> Image:
    """A flat picture, seen at a slant."""
    h, w = page.shape[:2]
    corners = np.array([[0, 0], [w, 0], [w, h], [0, h]], np.float32)
    target = np.array([[0, 0], [WIDTH, 0], [WIDTH, HEIGHT], [0, HEIGHT]], float)
    there = (target + rng.uniform(-160, 160, (4, 2))).astype(np.float32)
    view = cv2.warpPerspective(
        page, cv2.getPerspectiveTransform(corners, there), (WIDTH, HEIGHT), borderValue=(90,) * 3
    )
    noise = rng.normal(0, 4, view.shape)
    return np.clip(view + noise, 0, 255).astype(np.uint8)


def aruco(rng: Rng) -> Image:
    side = int(rng.integers(3, 20))
    table = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_1000)
    page = np.full((1000, 1000), 255, np.uint8)
    step = 1000 // side
    for number in range(side * side):
        row, col = divmod(number, side)
        size = int(0.75 * step)
        marker = cv2.aruco.generateImageMarker(table, int(rng.integers(1000)), max(size, 7))
        page[row * step : row * step + size, col * step : col * step + size] = marker[:size, :size]
    return warped(rng, np.asarray(cv2.cvtColor(page, cv2.COLOR_GRAY2BGR), np.uint8))


def text(rng: Rng) -> Image:
    page = np.full((1000, 1000, 3), 245, np.uint8)
    letters = list("abcdefghijklmnopqrstuvwxyz ,.0123456789")
    scale = rng.uniform(0.4, 1.6)
    for y in range(30, 1000, int(36 * scale) + 4):
        line = "".join(rng.choice(letters, 90))
        cv2.putText(page, line, (10, y), cv2.FONT_HERSHEY_SIMPLEX, scale, (20, 20, 20), 1)
    return warped(rng, page)


def noise(rng: Rng) -> Image:
    """Random coloured squares of any size, from pixels to blocks."""
    size = int(rng.integers(1, 40))
    shape = (HEIGHT // size + 1, WIDTH // size + 1, 3)
    values = np.where(rng.random(shape) < 0.5, 40, 200).astype(np.uint8)
    values[:, :, 1] = 40 if rng.random() < 0.5 else values[:, :, 1]
    picture = np.repeat(np.repeat(values, size, axis=0), size, axis=1)
    return np.ascontiguousarray(picture[:HEIGHT, :WIDTH])


KINDS: dict[str, tuple[Callable[[Rng], Image], float]] = {
    "bare ground": (ground, 0.24),
    "foreign pad": (foreign, 0.36),
    "checkerboard": (checkerboard, 0.1),
    "ArUco board": (aruco, 0.1),
    "printed text": (text, 0.08),
    "noise": (noise, 0.12),
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--method", choices=("dense", "paper"), default="dense")
    args = parser.parse_args()
    cv2.setNumThreads(1)
    detector = Detector(random_pad(np.random.default_rng(0)), camera(), method=args.method)
    total = false = 0
    for number, (kind, (draw, share)) in enumerate(KINDS.items()):
        rng = np.random.default_rng([args.seed, number])
        count, poses = round(args.count * share), []
        for index in range(count):
            found = detector.detect(draw(rng))
            if found.ok:
                poses.append((index, found.layer, found.log10_false_alarm))
        total, false = total + count, false + len(poses)
        print(f"{kind:14s} {len(poses):3d} of {count:4d}  {poses or ''}", flush=True)
    # With none in N the rate is below 3/N at 95 % confidence.
    bound = f"below {100 * 3 / total:.2f} % at 95 % confidence" if not false else ""
    print(f"{'all':14s} {false:3d} of {total:4d}  {100 * false / total:.2f} % {bound}")
    return int(false > 0)


if __name__ == "__main__":
    sys.exit(main())
