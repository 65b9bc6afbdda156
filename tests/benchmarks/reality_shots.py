"""Pads, cameras and plain shots, before anything happens to them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio import Camera, Pad
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.spec import Layer
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.scene import GROUND_KINDS, Scene
from padstudio.simulate.sensor import Imaging

Rng = np.random.Generator
Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class Shot:
    """One frame to be taken.

    Attributes
    ----------
    scene : Scene
    pose : Pose
    imaging, motion
        As of `padstudio.simulate.render.render`.
    camera : str
        Of `CAMERAS`.
    """

    scene: Scene
    pose: Pose
    imaging: Imaging = field(default_factory=Imaging)
    motion: Motion = field(default_factory=Motion)
    camera: str = ""


#: Puts a disturbance on a shot of a pad whose shorter side is given, mm.
Change = Callable[[Rng, Shot, float], Shot]


@dataclass(frozen=True)
class RealityClass:
    """A kind of frames.

    Attributes
    ----------
    change : callable
        As `Change`.
    heights : (low, high)
        In shorter sides of the pad.
    tilt_deg : float
        At most.
    after : callable or None
        Changes the picture, so that any pose of it is false.
    camera : str
        The only one of `CAMERAS`; empty for the usual ones in turn.
    """

    change: Change
    heights: tuple[float, float] = (0.12, 1.5)
    tilt_deg: float = 20.0
    after: Callable[[Picture], Picture] | None = None
    camera: str = ""


def _camera(width: int, height: int, focal: float, bends: tuple[float, ...], **more: Any) -> Camera:
    matrix = np.array([[focal, 0, width / 2 - 0.5], [0, focal, height / 2 - 0.5], [0, 0, 1]])
    return Camera(width, height, matrix, np.array(bends), **more)


CAMERAS = {
    "drone": _camera(1360, 765, 943.0, (0.01, -0.02, 0.0, 0.0, 0.0), name="drone"),
    "vga": _camera(640, 480, 500.0, (-0.09, 0.03, 0.0, 0.0, 0.0), name="vga"),
    "fisheye160": _camera(
        1280, 960, 455.0, (-0.02, 0.006, -0.003, 0.0005), model="fisheye", name="fisheye160"
    ),
    "fisheye190": _camera(
        1280, 960, 330.0, (0.02, -0.012, 0.004, -0.001), model="fisheye", name="fisheye190"
    ),
}
USUAL = ("drone", "vga")


def pads() -> dict[str, Pad]:
    """One as the paper's, the coarse layer a copy of the fine one's corner; one quite another."""
    rng = np.random.default_rng(20)
    fine = rng.integers(0, 2, (125, 125)).astype(np.uint8)
    paper = Pad((Layer("red", 10.0, fine), Layer("blue", 50.0, fine[:25, :25].copy())), window=5)
    other = Pad(
        (
            Layer("red", 9.0, rng.integers(0, 3, (72, 96)).astype(np.uint8)),
            Layer("blue", 27.0, rng.integers(0, 3, (24, 32)).astype(np.uint8)),
        ),
        window=4,
        levels=3,
    )
    return {"paper": paper, "other": other}


def plain_shot(rng: Rng, pad: Pad, kind: RealityClass, camera: str) -> Shot:
    """A shot of a pad on any ground, from any side, before anything happens to it."""
    side = min(pad.size_mm)
    height = side * float(np.exp(rng.uniform(*np.log(kind.heights))))
    # A third look at the top left, where a coarse layer that copies the fine one has its original.
    corner = 0.5 - 0.5 / 3
    middle = (-corner * pad.size_mm[0], corner * pad.size_mm[1]) if rng.random() < 1 / 3 else (0, 0)
    reach = (0.1 if any(middle) else 0.3) * side
    pose = look_at_pad(
        height,
        tilt_deg=float(rng.uniform(0, kind.tilt_deg)),
        heading_deg=float(rng.uniform(0, 360)),
        tilt_towards_deg=float(rng.uniform(0, 360)),
        target_mm=(
            middle[0] + float(rng.uniform(-reach, reach)),
            middle[1] + float(rng.uniform(-reach, reach)),
        ),
    )
    ground = GROUND_KINDS[int(rng.integers(len(GROUND_KINDS) - 1))]
    scene = Scene(pad=pad, ground=ground, ground_seed=int(rng.integers(50)))
    return Shot(scene, pose, camera=camera)
