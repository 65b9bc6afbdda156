#!/usr/bin/env python3
"""Cameras calibrated from pictures of a pad, against OpenCV's ChArUco board at the same poses.

    bench_calibration.py [--cases NAME,…] [--seeds N] [--jobs N] [--json FILE]

`ours` and `ChArUco` are root mean squares, over the picture, of how far directions are off after
the best turn, pixels; `sigma` is what the calibration says of itself. `max` is the largest error
of any part of the picture, or of fx, fy, cx, cy, in sigmas.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "support")]

from calibration_shots import charuco_board, charuco_camera, lens_error_px, poses_about  # noqa: E402
from dense_frames import random_pad  # noqa: E402

from padstudio.calibration.calibrate import calibrate  # noqa: E402
from padstudio.calibration.certainty import grid_pixels  # noqa: E402
from padstudio.errors import StudioError  # noqa: E402
from padstudio.geometry.camera import Camera  # noqa: E402
from padstudio.geometry.pose import Pose  # noqa: E402
from padstudio.pad.spec import Layer, Pad  # noqa: E402
from padstudio.simulate.lay.relief import Relief, Wave  # noqa: E402
from padstudio.simulate.motion import Motion  # noqa: E402
from padstudio.simulate.radiance.scene import Light, Occluder, Scene, Shadow  # noqa: E402
from padstudio.simulate.render import render  # noqa: E402
from padstudio.simulate.response import Response  # noqa: E402
from padstudio.simulate.sensor import Imaging  # noqa: E402

_MATRIX = [0, 1, 0, 1], [0, 1, 2, 2]


def _camera(
    width: int,
    height: int,
    widths: float,
    lens: tuple[float, ...] = (),
    *,
    model: str = "radtan",
    aspect: float = 1.0,
    centre: tuple[float, float] = (0.006, -0.004),
) -> Camera:
    """A camera by its focal length and its principal point's offset in widths of the picture."""
    focal = widths * width
    cx, cy = (width - 1) / 2 + centre[0] * width, (height - 1) / 2 + centre[1] * width
    matrix = [[focal, 0, cx], [0, focal * aspect, cy], [0, 0, 1]]
    return Camera(width, height, np.array(matrix), np.array(lens), model)


_BENT = (-0.2714, 0.0932, 0.0007, -0.0004, -0.0178)
_FISH = (-0.0312, 0.0087, -0.0041, 0.0006)
CAMERAS = {
    "straight": _camera(960, 540, 0.70),
    "bent": _camera(960, 540, 0.73, _BENT),
    "wide100": _camera(960, 540, 0.42, (-0.16, 0.03, 0.0004, -0.0003, -0.002)),
    "eight": _camera(960, 540, 0.55, (0.1, 0.0, 0.0003, -0.0006, 0.0, 0.35, 0.01, 0.0)),
    "fish160": _camera(960, 720, 0.358, _FISH, model="fisheye"),
    "fish180": _camera(960, 720, 0.318, (0.021, -0.004, 0.0, 0.0), model="fisheye"),
    "tele": _camera(960, 540, 4.0, (0.05, -0.2, 0, 0)),
    "oblong": _camera(960, 540, 0.75, (-0.1, 0.02, 0, 0), aspect=1.04),
    "off-centre": _camera(960, 540, 0.75, (-0.1, 0.02, 0, 0), centre=(0.05, -0.03)),
    "vga": _camera(640, 480, 0.85, (-0.12, 0.05, 0, 0)),
    "1080p": _camera(1920, 1080, 0.73, _BENT),
    "portrait": _camera(1080, 1920, 1.3, (0.03, -0.05, 0, 0)),
    "12mp": _camera(4000, 3000, 0.72, (0.04, -0.06, 0, 0, 0.02)),
}


def _single() -> Pad:
    field = np.random.default_rng(5).integers(0, 2, (50, 50))
    return Pad((Layer("red", 24.0, field),), levels=2)


PADS: dict[str, Callable[[], Pad]] = {
    "two": lambda: random_pad(3, cells=(60, 12), cell_mm=(20.0, 100.0)),
    "usual": lambda: random_pad(4),
    "small": lambda: random_pad(6, cells=(40, 8), cell_mm=(5.0, 25.0)),
    "three-levels": lambda: random_pad(7, levels=3),
    "single": _single,
    "shared": lambda: Pad.load(HERE.parent / "footage" / "pad_a.json"),
}

VIEWS = {"usual": (0.6, 1.1), "near": (1.3, 2.6), "far": (0.15, 0.3), "frontal": (0.6, 1.1)}


@dataclass(frozen=True)
class Case:
    """What is printed, seen through what, how."""

    camera: str = "straight"
    pad: str = "two"
    pictures: int = 12
    views: str = "usual"
    imaging: dict[str, Any] = field(default_factory=dict)
    scene: dict[str, Any] = field(default_factory=dict)
    moves_mm_s: float = 0.0


_MONO = Response(matrix=((0.3, 0.59, 0.11),))
_MIXED = Response(matrix=((0.9, 0.1, 0.02), (0.15, 0.8, 0.1), (0.03, 0.12, 0.85)))
_SHADOW = Light(shadows=(Shadow(toward_deg=70.0, x_mm=80.0), Shadow(x_mm=-300.0, radius_mm=200.0)))
_LEAVES = tuple(
    Occluder(x_mm=x, y_mm=y, radius_mm=r)
    for x, y, r in ((-300.0, 200.0, 130.0), (250.0, -120.0, 90.0), (100.0, 350.0, 150.0))
)


def _waves(size: float, mm: float) -> Relief:
    return Relief(
        bends=(
            Wave(amplitude_mm=mm, length_mm=0.8 * size, toward_deg=30.0, phase_deg=40.0),
            Wave(amplitude_mm=0.4 * mm, length_mm=0.37 * size, toward_deg=110.0, phase_deg=190.0),
        )
    )


CASES: dict[str, Case] = {
    **{name: Case(camera=name) for name in CAMERAS},
    **{f"pad-{name}": Case(camera="bent", pad=name) for name in PADS},
    **{f"n{n}": Case(camera="bent", pictures=n) for n in (3, 4, 6, 30)},
    **{f"{name}-{camera}": Case(camera=camera, views=name)
       for name in ("near", "far", "frontal") for camera in ("bent", "straight")},
    "near-usual-pad": Case(camera="bent", pad="usual", views="near"),
    "near-fish160": Case(camera="fish160", views="near"),
    "near-wide100": Case(camera="wide100", views="near"),
    "noise": Case(camera="bent", imaging={"full_well_e": 500.0, "read_noise_e": 12.0}),
    "defocus1": Case(camera="bent", imaging={"defocus_px": 1.0}),
    "defocus2": Case(camera="bent", imaging={"defocus_px": 2.0}),
    "motion": Case(camera="bent", imaging={"exposure_ms": 8.0}, moves_mm_s=400.0),
    "vignetting": Case(camera="bent", imaging={"vignetting": 0.6}),
    "jpeg60": Case(camera="bent", imaging={"jpeg_quality": 60}),
    "jpeg30": Case(camera="bent", imaging={"jpeg_quality": 30}),
    "sharpen": Case(camera="bent", imaging={"sharpen": 1.0}),
    "linear": Case(camera="bent", imaging={"tone": "linear"}),
    "shadows": Case(camera="bent", scene={"light": _SHADOW}),
    "occluders": Case(camera="bent", scene={"occluders": _LEAVES}),
    "grey": Case(camera="bent", imaging={"response": _MONO}),
    "mixed": Case(camera="bent", imaging={"response": _MIXED}),
    "bent-paper1": Case(camera="bent", scene={"lay": 1.0}),
    "bent-paper3": Case(camera="bent", scene={"lay": 3.0}),
    "bent-paper6": Case(camera="bent", scene={"lay": 6.0}),
    "rolling": Case(camera="bent", imaging={"readout_ms": 20.0}),
    "rolling-hand": Case(camera="bent", imaging={"readout_ms": 20.0}, moves_mm_s=30.0),
    "ideal": Case(camera="bent", imaging={"ideal": True}),
}  # fmt: skip


def _poses(case: Case, side_mm: float, camera: Camera, seed: int) -> list[Pose]:
    """As `poses_about`, nearer or further where the case says so."""
    tilt = 6.0 if case.views == "frontal" else 40.0
    poses = poses_about(side_mm, camera, case.pictures, seed=seed, tilt_deg=tilt)
    low, high = VIEWS[case.views]
    rng = np.random.default_rng(seed + 1000)
    out = []
    for pose in poses:
        if (low, high) == VIEWS["usual"]:
            out.append(pose)
            continue
        at = np.append(pose.position_mm[:2] * 0, 0)
        wanted = side_mm * camera.matrix[0, 0] / (camera.height * rng.uniform(low, high))
        factor = wanted / pose.range_mm
        out.append(Pose(at + (pose.position_mm - at) * factor, pose.rotation))
    return out


def _pictures(case: Case, shown: dict[str, Any], size: float, camera: Camera, poses: list[Pose]):
    changes, scene = dict(case.imaging), dict(case.scene)
    imaging = (Imaging.ideal() if changes.pop("ideal", False) else Imaging()).with_changes(
        **changes
    )
    if isinstance(scene.get("lay"), float):
        scene["lay"] = _waves(size, scene["lay"])
    moving = Motion()
    if case.moves_mm_s:
        moving = Motion(velocity_mm_s=(case.moves_mm_s, 0.6 * case.moves_mm_s, 0.0))
    where = Scene(**shown, **scene)
    return [
        render(where, camera, pose, imaging, seed=k, motion=moving).image
        for k, pose in enumerate(poses)
    ]


def measured(name: str, seed: int, peer: bool = True) -> dict[str, Any]:
    """One case with the poses of a seed."""
    case = CASES[name]
    pad, camera = PADS[case.pad](), CAMERAS[case.camera]
    side = max(pad.size_mm)
    poses = _poses(case, side, camera, seed)
    out: dict[str, Any] = {"case": name, "seed": seed, "pictures": case.pictures}
    if peer:
        board, sheet = charuco_board(side)
        pictures = _pictures(case, {"pad": None, "sheet": sheet}, side, camera, poses)
        out["charuco_px"] = _charuco(board, pictures, camera)
    pictures = _pictures(case, {"pad": pad}, side, camera, poses)
    began = time.perf_counter()
    try:
        found = calibrate(pad, pictures)
    except StudioError as error:
        return out | {"error": str(error), "s": time.perf_counter() - began}
    out["s"] = time.perf_counter() - began
    error = lens_error_px(found.camera, camera)
    sigma = found.sigma.picture_px
    pixels = grid_pixels(camera)
    away = _away(found.camera, camera, pixels).reshape(sigma.shape) / sigma
    off = (found.camera.matrix[_MATRIX] - camera.matrix[_MATRIX]) / found.sigma.matrix
    return out | {
        "ours_px": float(np.sqrt(np.mean(error**2))),
        "sigma_px": float(np.sqrt(np.nanmean(sigma**2))),
        "model": found.camera.model,
        "used": len(found.used),
        "max": float(np.nanmax(away)),
        "pulls": np.abs(off).round(2).tolist() if found.camera.model == camera.model else [],
        "rms_px": found.rms_px,
    }


def _charuco(board: Any, pictures: list[Any], camera: Camera) -> float | None:
    try:
        found = charuco_camera(board, pictures, camera.model)
    except Exception:
        return None
    return float(np.sqrt(np.mean(lens_error_px(found, camera) ** 2)))


def _away(found: Camera, true: Camera, pixels: Any) -> Any:
    """Errors at some pixels after the best turn of all that `lens_error_px` looks at."""
    inside = true.has_ray(pixels, true.normalize(pixels))
    out = np.full(len(pixels), np.nan)
    rays = []
    for camera in (found, true):
        ray = np.column_stack([camera.normalize(pixels), np.ones(len(pixels))])
        rays.append(ray / np.linalg.norm(ray, axis=1, keepdims=True))
    seen = inside & np.isfinite(rays[0]).all(axis=1) & np.isfinite(rays[1]).all(axis=1)
    a, b = rays[0][seen], rays[1][seen]
    u, _, v = np.linalg.svd(b.T @ a)
    turn = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    # As pixels, of which a fisheye has fewer a radian than a flat lens has to its rim.
    out[seen] = np.linalg.norm(found.denormalize(_flat(b @ turn)) - pixels[seen], axis=1)
    return out


def _flat(rays: Any) -> Any:
    return rays[:, :2] / rays[:, 2:]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--no-peer", action="store_true")
    parser.add_argument("--json", type=Path)
    args = parser.parse_args()
    print(f"{'case':16} seed  n used model    ours  ChArUco  ratio  sigma   max  fx fy cx cy     s")
    with ProcessPoolExecutor(args.jobs) as pool:
        waiting = [
            pool.submit(measured, name, seed, not args.no_peer)
            for name in args.cases.split(",")
            for seed in range(args.first, args.first + args.seeds)
        ]
        results = []
        for each in waiting:
            results.append(each.result())
            print(_line(results[-1]), flush=True)
    if args.json:
        args.json.write_text(json.dumps(results, indent=1), encoding="utf-8")
    return 0


def _line(one: dict[str, Any]) -> str:
    head = f"{one['case']:16} {one['seed']:4} {one['pictures']:2}"
    peer = one.get("charuco_px")
    told = f"{peer:7.3f}" if peer is not None else "      –"
    if "error" in one:
        return f"{head}  {told}  {one['error'][:110]} {one['s']:.1f}"
    ratio = f"{one['ours_px'] / peer:6.2f}" if peer else "     –"
    pulls = " ".join(f"{pull:.1f}" for pull in one["pulls"])
    return (
        f"{head}  {one['used']:2} {one['model']:7} {one['ours_px']:6.3f} {told} {ratio} "
        f"{one['sigma_px']:6.3f} {one['max']:5.1f}  {pulls:15} {one['s']:6.1f}"
    )


if __name__ == "__main__":
    sys.exit(main())
