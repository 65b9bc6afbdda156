#!/usr/bin/env python3
"""Simulated pictures: their time, and how they compare with independent ones of the same poses.

    bench_simulate.py

Time is of a 2720 x 1530 frame at rest and in motion, median and spread of five after a warm-up.
The comparison is with tests/footage: largest difference of a cell kind's median colour (of 255),
and the ratio, simulated over footage, of the noise within cells and of the gradient at cell edges.
"""

from __future__ import annotations

import json
import platform
import statistics
import time
from pathlib import Path

import cv2
import numpy as np

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.spec import Pad
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.lens import ray_map
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
# Stills in even light of a camera at rest, from which the cells are large enough to measure within.
GROUPS = ("tilt", "lens")


def cell_kinds(pad, camera, pose):
    """(H, W) int: red + 2 · blue of the cell at each pixel, −1 off the pad."""
    rays = ray_map(camera)[1:-1, 1:-1].astype(float)
    away = np.concatenate([rays, np.ones((*rays.shape[:2], 1))], axis=2) @ pose.rotation.T
    reach = np.where(away[..., 2] < 0, -pose.position_mm[2] / away[..., 2], np.nan)
    x = pose.position_mm[0] + reach * away[..., 0] + pad.width_mm / 2
    y = pad.height_mm / 2 - pose.position_mm[1] - reach * away[..., 1]
    inside = (x >= 0) & (x < pad.width_mm) & (y >= 0) & (y < pad.height_mm)
    kinds = np.full(x.shape, -1)
    kinds[inside] = 0
    for factor, channel in ((1, "red"), (2, "blue")):
        layer = pad.layer(channel)
        place = (y[inside] / layer.cell_mm).astype(int), (x[inside] / layer.cell_mm).astype(int)
        kinds[inside] += factor * layer.field[place]
    return kinds


def figures(picture, kinds):
    """Median colours (4, 3) and noise (4, 3) of the cell kinds, and the gradient at red edges."""
    values = picture.astype(float)
    rough = values - cv2.blur(values, (5, 5))
    middle = np.zeros(kinds.shape, bool)
    h, w = kinds.shape
    middle[h // 4 : -h // 4, w // 4 : -w // 4] = True
    colors, noise = np.full((4, 3), np.nan), np.full((4, 3), np.nan)
    for kind in range(4):
        core = cv2.erode((kinds == kind).astype(np.uint8), np.ones((9, 9))) > 0
        if (core & middle).sum() > 400:
            colors[kind] = np.median(values[core & middle], axis=0)
            noise[kind] = rough[core & middle].std(axis=0)
    red, near = (kinds % 2).astype(np.uint8), np.ones((3, 3))
    edges = (kinds >= 0) & (cv2.dilate(red, near) != cv2.erode(red, near))
    slope = np.hypot(cv2.Sobel(values[..., 2], -1, 1, 0), cv2.Sobel(values[..., 2], -1, 0, 1))
    return colors, noise, slope[edges].mean() / 8


def compare(pad):
    """Print a line for each still of the footage that only geometry distinguishes."""
    print("still      colour  noise  edges")
    for record in json.loads((FOOTAGE / "stills/truth.json").read_text()):
        if not record["group"].startswith(GROUPS):
            continue
        picture = cv2.imread(str(FOOTAGE / record["file"]))
        camera = Camera.load(FOOTAGE / record["camera"])
        pose = Pose(np.array(record["position_mm"]), np.array(record["rotation"]))
        kinds = cell_kinds(pad, camera, pose)
        frame = render(Scene(pad=pad, ground="gravel"), camera, pose, seed=1)
        theirs, ours = figures(picture, kinds), figures(frame.image, kinds)
        if np.isnan(theirs[0]).all():
            continue
        color = np.nanmax(np.abs(ours[0] - theirs[0]))
        print(
            f"{Path(record['file']).stem:10} {color:6.0f} {np.nanmean(ours[1] / theirs[1]):6.3f} "
            f"{ours[2] / theirs[2]:6.3f}"
        )


def clock(pad):
    """Print the time of a large frame, at rest and in motion."""
    camera = Camera.load(FOOTAGE / "camera_drone_2k7.yaml")
    pose = Pose(np.array([100.0, 50.0, 1000.0]), np.diag([1.0, -1.0, -1.0]))
    fast = Motion(velocity_mm_s=(500, 200, -700), angular_deg_s=(5, 5, 10))
    for name, motion in (("rest", Motion()), ("motion", fast)):
        times = []
        for _ in range(6):
            start = time.perf_counter()
            render(Scene(pad=pad), camera, pose, Imaging(readout_ms=20.0), motion=motion)
            times.append(time.perf_counter() - start)
        rest = times[1:]
        spread = max(rest) - min(rest)
        print(f"{name:8} median {statistics.median(rest):.2f} s, spread {spread:.2f} s")


def main() -> None:
    print(f"{platform.machine()}, Python {platform.python_version()}, OpenCV {cv2.__version__}")
    pad = Pad.load(FOOTAGE / "pad_a.json")
    clock(pad)
    compare(pad)


if __name__ == "__main__":
    main()
