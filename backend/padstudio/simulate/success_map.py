"""Maps of success from simulated pictures: height against tilt, height against blur."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from padstudio.arrays import Array, Image
from padstudio.errors import LimitError, SpecError, shown
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad, rotation_angle_deg
from padstudio.pad.coverage.pinhole import View
from padstudio.pad.spec import Channel, Pad
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.trajectories import MAX_FRAMES

Axis = Literal["tilt_deg", "blur_px"]

#: Reads a frame: a pose, or None where there is none.
Reader = Callable[[Image], Pose | None]


@dataclass(frozen=True)
class MapGrid:
    """The places of a map, and the frames at each.

    Attributes
    ----------
    heights_mm : sequence of float
        Of the camera's centre over the ground.
    axis : {"tilt_deg", "blur_px"}
    values : sequence of float
        Tilts, or lengths of the motion's path during the exposure in pixels.
    trials : int
        Frames a place, each with its own heading, place over the pad and noise.
    seed : int

    Raises
    ------
    LimitError
        If the map asks for more than `padstudio.simulate.trajectories.MAX_FRAMES` frames.
    SpecError
        If a value is out of range.
    """

    heights_mm: Sequence[float]
    axis: Axis = "tilt_deg"
    values: Sequence[float] = (0.0,)
    trials: int = 3
    seed: int = 0

    def __post_init__(self) -> None:
        if self.axis not in ("tilt_deg", "blur_px"):
            raise SpecError(f"no axis {shown(self.axis)}; use tilt_deg or blur_px")
        if self.frames > MAX_FRAMES:
            raise LimitError(
                f"the map asks for {self.frames} frames; the limit is {MAX_FRAMES}, take fewer "
                "heights, columns or trials",
                code="too_many_frames",
            )
        if self.frames < 1 or not all(h > 1 for h in self.heights_mm):
            raise SpecError("give heights above 1 mm, at least one column and one trial")
        highest = 89.0 if self.axis == "tilt_deg" else 500.0
        if not all(0 <= value <= highest for value in self.values):
            raise SpecError(f"{self.axis} lies within 0 … {highest:g}")

    @property
    def frames(self) -> int:
        """How many frames are simulated."""
        return len(self.heights_mm) * len(self.values) * self.trials


@dataclass(frozen=True, eq=False)
class SuccessMap:
    """Share of simulated frames that were read rightly.

    Attributes
    ----------
    axis : {"tilt_deg", "blur_px"}
        What the columns vary.
    heights_mm : (H,) float64
    values : (C,) float64
        Tilts in degrees or blurs in pixels.
    share : (H, C) float64
        0 … 1.
    wrong : (H, C) float64
        Share of frames whose pose is false: worse than none.
    trials : int
        Frames a place of the map.
    """

    axis: Axis
    heights_mm: Array
    values: Array
    share: Array
    wrong: Array
    trials: int

    def as_dict(self) -> dict[str, Any]:
        """Plain values, as REST and the command line give them."""
        return {
            "axis": self.axis,
            "heights_mm": self.heights_mm.tolist(),
            "values": self.values.tolist(),
            "success": self.share.tolist(),
            "wrong": self.wrong.tolist(),
            "trials": self.trials,
        }


def success_map(
    scene: Scene,
    camera: Camera,
    read: Reader,
    grid: MapGrid,
    *,
    imaging: Imaging | None = None,
    progress: Callable[[int], None] | None = None,
) -> SuccessMap:
    """Simulate frames over a grid of conditions and have them read.

    A frame counts as read where the position is within 2 % of the height (and 1 mm) and the
    attitude within 2 degrees of the truth; as wrong beyond 10 % (and 5 mm) or 10 degrees.

    Parameters
    ----------
    scene : Scene
    camera : Camera
    read : callable
        Takes (H, W, 3) uint8 BGR, gives a `Pose` or None.
    grid : MapGrid
    imaging : Imaging, optional
    progress : callable, optional
        Called with the number of frames done.

    Raises
    ------
    SpecError
        If the scene has no pad.
    """
    if scene.pad is None:
        raise SpecError("the scene has no pad to read; give one")
    imaging = imaging or Imaging()
    share = np.zeros((len(grid.heights_mm), len(grid.values)))
    wrong = np.zeros_like(share)
    done = 0
    for row, height in enumerate(grid.heights_mm):
        for col, value in enumerate(grid.values):
            for trial in range(grid.trials):
                rng = np.random.default_rng([grid.seed, row, col, trial])
                tilt, blur = (value, 0.0) if grid.axis == "tilt_deg" else (0.0, value)
                pose = _pose_over(rng, scene.pad, camera, height, tilt)
                motion, shot = _blurring(rng, camera, imaging, height, blur)
                noise = int(rng.integers(2**31))
                frame = render(scene, camera, pose, shot, noise, motion=motion)
                verdict = judge(read(frame.image), pose)
                share[row, col] += verdict == "good"
                wrong[row, col] += verdict == "wrong"
                done += 1
                if progress:
                    progress(done)
    return SuccessMap(
        grid.axis,
        np.array(grid.heights_mm, float),
        np.array(grid.values, float),
        share / grid.trials,
        wrong / grid.trials,
        grid.trials,
    )


def judge(found: Pose | None, truth: Pose) -> Literal["good", "poor", "wrong", "none"]:
    """How near a pose is to the truth, by the limits of `success_map`."""
    if found is None:
        return "none"
    height = float(truth.position_mm[2])
    distance = float(np.linalg.norm(found.position_mm - truth.position_mm))
    angle = rotation_angle_deg(found.rotation, truth.rotation)
    if distance <= 0.02 * height + 1 and angle <= 2:
        return "good"
    return "wrong" if distance > 0.10 * height + 5 or angle > 10 else "poor"


def only(pad: Pad, channel: Channel) -> Pad:
    """The pad with one layer alone, whose reading is then that layer's.

    Raises
    ------
    SpecError
        If the pad has no such layer.
    """
    layer = pad.layer(channel)
    if layer is None:
        raise SpecError(f"the pad has no {channel} layer")
    return replace(pad, layers=(layer,))


def view_of(camera: Camera) -> View:
    """The camera as the plain numbers that `padstudio.pad.coverage.spans` works with."""
    return View(width_px=camera.width, height_px=camera.height, focal_px=camera.focal_px)


def _pose_over(
    rng: np.random.Generator, pad: Pad, camera: Camera, height_mm: float, tilt_deg: float
) -> Pose:
    seen = height_mm / camera.focal_px * math.hypot(camera.width, camera.height)
    # As far from the centre as the picture stays on the pad, where the pad is the larger.
    reach = np.clip((np.array(pad.size_mm) - seen) / 2, 0, None)
    x, y = (float(v) for v in rng.uniform(-1, 1, 2) * reach)
    toward, heading = (float(v) for v in rng.uniform(0, 360, 2))
    return look_at_pad(
        height_mm,
        tilt_deg=tilt_deg,
        heading_deg=heading,
        tilt_towards_deg=toward,
        target_mm=(x, y),
    )


def _blurring(
    rng: np.random.Generator, camera: Camera, imaging: Imaging, height_mm: float, blur_px: float
) -> tuple[Motion, Imaging]:
    exposure_ms = imaging.exposure_ms or 1.0
    speed = blur_px * height_mm / camera.focal_px / (exposure_ms / 1000.0)
    angle = float(rng.uniform(0, 2 * math.pi))
    motion = Motion(velocity_mm_s=(speed * math.cos(angle), speed * math.sin(angle), 0.0))
    return motion, imaging.with_changes(exposure_ms=exposure_ms)
