"""Frames that fail, or mislead, for exactly one cause, which grows until they do."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio import Camera, Detector, Pad
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.spec import Layer
from padstudio.simulate.lay.relief import Relief, Wave
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.litter import Litter
from padstudio.simulate.radiance.scene import GROUND_KINDS, Light, Occluder, Scene
from padstudio.simulate.render import render
from padstudio.simulate.response import RESPONSES, Response
from padstudio.simulate.sensor import Imaging

Rng = np.random.Generator
Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class Case:
    """A frame, and what it is read with, which the cause may have made wrong."""

    cause: str
    image: Picture
    pad: Pad
    camera: Camera


@dataclass(frozen=True)
class Shot:
    """A frame to be taken, before anything is wrong."""

    pad: Pad
    camera: Camera
    pose: Pose
    scene: Scene
    imaging: Imaging
    side_mm: float

    def taken(self, rng: Rng, **changes: Any) -> Picture:
        """The picture, with other values of the shot's or of the motion."""
        motion = changes.pop("motion", None)
        shot = replace(self, **changes)
        seed = int(rng.integers(2**31))
        return render(shot.scene, shot.camera, shot.pose, shot.imaging, seed, motion=motion).image


#: Makes a case of a shot; the hardness, 0 … 1, says how much is wrong.
Maker = Callable[[Rng, Shot, float], tuple[Picture, Pad, Camera]]


def _camera(width: int, height: int, focal: float, *bends: float) -> Camera:
    matrix = np.array([[focal, 0, width / 2 - 0.5], [0, focal, height / 2 - 0.5], [0, 0, 1]])
    return Camera(width, height, matrix, np.array(bends), name=f"{width} x {height}")


def _pad(seed: int, levels: int, cells: tuple[int, int], ratio: int, cell_mm: float) -> Pad:
    rng = np.random.default_rng(seed)
    shape = cells[0] // ratio, cells[1] // ratio
    fine, coarse = (rng.integers(0, levels, size).astype(np.uint8) for size in (cells, shape))
    layers = Layer("red", cell_mm, fine), Layer("blue", ratio * cell_mm, coarse)
    return Pad(layers, window=5 if levels == 2 else 4, levels=levels)


#: For tuning and for the table alike; frames differ by their seeds.
PADS = {
    "large": _pad(1, 2, (125, 125), 5, 10.0),
    "three levels": _pad(2, 3, (72, 96), 3, 9.0),
    "small": _pad(3, 2, (48, 48), 4, 12.0),
}
CAMERAS = {
    "drone": _camera(832, 468, 577.0, 0.01, -0.02, 0.0, 0.0, 0.0),
    "vga": _camera(640, 480, 500.0, -0.09, 0.03, 0.0, 0.0, 0.0),
    "square": _camera(560, 560, 450.0),
}


def plain(rng: Rng, pad: Pad, camera: Camera) -> Shot:
    """A pad that is seen well, from any side, on any ground."""
    side = min(pad.size_mm)
    least_px = min(camera.width, camera.height)
    pose = look_at_pad(
        side
        * float(np.exp(rng.uniform(math.log(0.5), math.log(1.6))))
        * camera.focal_px
        / least_px,
        tilt_deg=float(rng.uniform(0, 25)),
        heading_deg=float(rng.uniform(0, 360)),
        tilt_towards_deg=float(rng.uniform(0, 360)),
        target_mm=(float(rng.uniform(-0.15, 0.15) * side), float(rng.uniform(-0.15, 0.15) * side)),
    )
    ground = GROUND_KINDS[int(rng.integers(len(GROUND_KINDS) - 1))]
    scene = Scene(pad=pad, ground=ground, ground_seed=int(rng.integers(50)))
    return Shot(pad, camera, pose, scene, Imaging(), side)


def _imaging(change: Callable[[float], dict[str, Any]]) -> Maker:
    def make(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
        imaging = shot.imaging.with_changes(**change(hardness))
        return shot.taken(rng, imaging=imaging), shot.pad, shot.camera

    return make


def _picture(change: Callable[[Picture], Picture]) -> Maker:
    def make(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
        return np.ascontiguousarray(change(shot.taken(rng))), shot.pad, shot.camera

    return make


#: Snow, mud, grass cuttings; sRGB.
_COVERS = ((228.0, 231.0, 236.0), (96.0, 78.0, 58.0), (98.0, 112.0, 50.0))


def _capped(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    """A cap on the lens: next to no light."""
    scene = replace(shot.scene, light=Light(level=0.1))
    imaging = shot.imaging.with_changes(brightness=0.001)
    return shot.taken(rng, scene=scene, imaging=imaging), shot.pad, shot.camera


def _covered(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    """Leaves, heaps of something, or one cloth."""
    kind, side = ("leaves", "heaps", "cloth")[int(rng.integers(3))], shot.side_mm
    if kind == "leaves":
        size, seed = float(rng.uniform(0.06, 0.14)) * side, int(rng.integers(1000))
        litter = Litter(kind="leaves", share=0.78 + 0.169 * hardness, size_mm=size, seed=seed)
        return shot.taken(rng, scene=replace(shot.scene, litter=litter)), shot.pad, shot.camera
    spread, least, most, count = (0.5, 0.08, 0.16, 30 + int(50 * hardness))
    if kind == "cloth":
        # All of the pad is in view, its corners peep out.
        spread, least, most, count = 0.03, 0.5 + 0.13 * hardness, 0.52 + 0.13 * hardness, 1
        away = (
            1.7 * shot.side_mm * shot.camera.focal_px / min(shot.camera.width, shot.camera.height)
        )
        height = float(shot.pose.position_mm[2])
        shot = replace(
            shot, pose=Pose(shot.pose.position_mm * max(1.0, away / height), shot.pose.rotation)
        )
    color = _COVERS[int(rng.integers(3))]
    places = side * rng.uniform([-spread, -spread, least], [spread, spread, most], (count, 3))
    discs = [Occluder(x_mm=x, y_mm=y, radius_mm=radius, color=color) for x, y, radius in places]
    return shot.taken(rng, scene=replace(shot.scene, occluders=tuple(discs))), shot.pad, shot.camera


def _another_pad(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    layers = tuple(
        replace(layer, field=rng.integers(0, shot.pad.levels, layer.field.shape, np.uint8))
        for layer in shot.pad.layers
    )
    scene = replace(shot.scene, pad=replace(shot.pad, layers=layers))
    return shot.taken(rng, scene=scene), shot.pad, shot.camera


def _mirrored(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    picture = shot.taken(rng)
    flipped = picture[:, ::-1] if rng.random() < 0.5 else picture[::-1]
    return np.ascontiguousarray(flipped), shot.pad, shot.camera


def _turned(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    picture = np.rot90(shot.taken(rng), 1 + 2 * int(rng.integers(2)))
    return np.ascontiguousarray(picture), shot.pad, shot.camera


def _moving(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    toward, reach_px = rng.uniform(0, math.pi), 10 * 10**hardness
    speed = math.degrees(reach_px / shot.camera.focal_px / 0.02)
    turn = speed * math.cos(toward), speed * math.sin(toward), 0.0
    imaging = shot.imaging.with_changes(exposure_ms=20.0)
    motion = Motion(angular_deg_s=turn)
    return shot.taken(rng, imaging=imaging, motion=motion), shot.pad, shot.camera


def _at(rng: Rng, shot: Shot, height_mm: float, target: tuple[float, float]) -> Picture:
    pose = look_at_pad(
        height_mm,
        tilt_deg=float(rng.uniform(0, 10)),
        heading_deg=float(rng.uniform(0, 360)),
        tilt_towards_deg=float(rng.uniform(0, 360)),
        target_mm=target,
    )
    return shot.taken(rng, pose=pose)


def _far(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    side_px = 60 / 3**hardness
    height = shot.side_mm * shot.camera.focal_px / side_px
    return _at(rng, shot, height, (0.0, 0.0)), shot.pad, shot.camera


def _near(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    cells = 3.5 - 2 * hardness
    fine = min(layer.cell_mm for layer in shot.pad.layers)
    height = cells * fine * shot.camera.focal_px / shot.camera.width
    reach = 0.35 * shot.side_mm
    target = float(rng.uniform(-reach, reach)), float(rng.uniform(-reach, reach))
    return _at(rng, shot, height, target), shot.pad, shot.camera


def _cut_off(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    """The frame's middle lies beside the pad, of which so much of a strip or corner is left."""
    camera, pad = shot.camera, shot.pad
    fine = min(layer.cell_mm for layer in pad.layers)
    height = fine * camera.focal_px / float(rng.uniform(9, 16))
    pose = look_at_pad(height, heading_deg=float(rng.uniform(0, 360)))
    half = np.array([[x, y, camera.focal_px] for x in (-1, 1) for y in (-1, 1)], float)
    half[:, :2] *= np.array([camera.width, camera.height]) / 2
    # The frame's corner that reaches farthest toward the pad lies so far within it.
    seen = (half * height / camera.focal_px) @ pose.rotation.T
    corner = np.array([pad.size_mm[0] / 2, float(rng.uniform(-0.4, 0.4)) * pad.size_mm[1]])
    nearest = seen[int(np.argmin(seen[:, 0])), :2]
    target = corner - nearest - [fine * (5.5 - 3.5 * hardness), 0.0]
    position = pose.position_mm + np.array([*target, 0.0])
    return shot.taken(rng, pose=Pose(position, pose.rotation)), pad, camera


def _no_pad(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    kind = GROUND_KINDS[int(rng.integers(len(GROUND_KINDS)))]
    scene = Scene(pad=None, ground=kind, ground_seed=int(rng.integers(50)))
    return shot.taken(rng, scene=scene), shot.pad, shot.camera


def _leaning(rng: Rng, shot: Shot) -> Pose:
    """Lines run together, so that the focal length can be told."""
    return look_at_pad(
        float(rng.uniform(0.5, 1.0)) * shot.side_mm,
        tilt_deg=float(rng.uniform(25, 45)),
        heading_deg=float(rng.uniform(0, 360)),
        tilt_towards_deg=float(rng.uniform(0, 360)),
    )


def _focal(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    ratio = float(rng.uniform(1.12, 1.5)) ** rng.choice([-1, 1])
    camera = shot.camera
    matrix = camera.matrix.copy()
    matrix[:2, :2] *= ratio
    image = shot.taken(rng, pose=_leaning(rng, shot))
    return image, shot.pad, replace(camera, matrix=matrix, name="another focal length")


def _lens(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    bends = np.array([float(rng.uniform(-0.3, -0.12)), 0.05, 0.0, 0.0, 0.0])
    bent = replace(shot.camera, distortion=bends)
    return shot.taken(rng, camera=bent), shot.pad, replace(shot.camera, distortion=np.zeros(5))


def _print_scale(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    stretch = 1 + float(rng.uniform(0.01, 0.05)) * rng.choice([-1, 1])
    scale = (stretch, 1.0) if rng.random() < 0.5 else (1.0, stretch)
    scene = replace(shot.scene, pad=replace(shot.pad, scale=scale))
    return shot.taken(rng, scene=scene), shot.pad, shot.camera


def _crosstalk(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    share = float(rng.uniform(0.38, 0.47))
    rows = (1 - share, 0.0, share), (0.0, 1.0, 0.0), (share, 0.0, 1 - share)
    imaging = shot.imaging.with_changes(response=Response(matrix=rows))
    return shot.taken(rng, imaging=imaging), shot.pad, shot.camera


def _monochrome(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    kind = ("mono", "luma", "nir")[int(rng.integers(3))]
    imaging = shot.imaging.with_changes(response=RESPONSES[kind])
    return shot.taken(rng, imaging=imaging), shot.pad, shot.camera


def _warped(rng: Rng, shot: Shot, hardness: float) -> tuple[Picture, Pad, Camera]:
    length = float(rng.uniform(0.3, 0.8)) * shot.side_mm
    wave = Wave(
        amplitude_mm=length * float(rng.uniform(0.01, 0.05)),
        length_mm=length,
        toward_deg=float(rng.uniform(0, 360)),
        phase_deg=float(rng.uniform(0, 360)),
    )
    return shot.taken(rng, scene=replace(shot.scene, lay=Relief((wave,)))), shot.pad, shot.camera


@dataclass(frozen=True)
class Cause:
    """How frames of a cause are made.

    Attributes
    ----------
    make : Maker
    must_fail : bool
        Its frames are those without a pose; others may have one, with a warning.
    reason : str
        What should be said; empty for the cause's own name.
    """

    make: Maker
    must_fail: bool = True
    reason: str = ""


CAUSES: dict[str, Cause] = {
    "nothing": Cause(_picture(lambda image: image), must_fail=False),
    "covered": Cause(_covered),
    "another_pad": Cause(_another_pad),
    "mirrored": Cause(_mirrored),
    "channels_swapped": Cause(_picture(lambda image: image[..., ::-1])),
    "inverted": Cause(_picture(lambda image: 255 - image)),
    "turned": Cause(_turned),
    "motion_blur": Cause(_moving),
    "defocus": Cause(_imaging(lambda h: {"defocus_px": 5 * 4**h})),
    "underexposed": Cause(_imaging(lambda h: {"brightness": 0.01 / 2**h, "full_well_e": 4000.0})),
    "overexposed": Cause(_imaging(lambda h: {"brightness": 6 * 8**h})),
    "black_frame": Cause(_capped),
    "cells_too_small": Cause(_far),
    "cells_too_large": Cause(_near),
    "cut_off": Cause(_cut_off),
    "no_pad": Cause(_no_pad),
    "focal length": Cause(_focal, must_fail=False, reason="wrong_camera"),
    "lens": Cause(_lens, must_fail=False, reason="wrong_camera"),
    "print_scale": Cause(_print_scale, must_fail=False),
    "crosstalk": Cause(_crosstalk, must_fail=False),
    "monochrome": Cause(_monochrome, must_fail=False),
    "warped": Cause(_warped, must_fail=False),
}
#: How much is wrong, until a frame fails.
HARDER = (0.0, 0.35, 0.7, 1.0)


def cases(name: str, count: int, seed: int) -> Iterator[Case]:
    """Frames of a cause, pads and cameras in turn; those of which nothing fails are left out."""
    cause, pads, cameras = CAUSES[name], list(PADS.values()), list(CAMERAS.values())
    for number in range(count):
        rng = np.random.default_rng([seed, number, *name.encode()])
        pad, camera = pads[number % 3], cameras[(number // 3 + number) % 3]
        if name == "turned" and camera.width == camera.height:
            camera = cameras[0]
        shot = plain(rng, pad, camera)
        first = float(rng.uniform(0, 0.2))
        for hardness in HARDER if cause.must_fail else (0.5,):
            image, *reading = cause.make(rng, shot, min(1.0, hardness + first))
            case = Case(name, image, *reading)
            if not cause.must_fail or name == "turned" or not _read(case):
                yield case
                break


def _read(case: Case) -> bool:
    return Detector(case.pad, case.camera).detect(case.image).ok
