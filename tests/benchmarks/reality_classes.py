"""What happens to prints and cameras, one class of simulated frames after the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from padstudio import Camera, Pad
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.spec import Layer
from padstudio.simulate.lay.relief import Fold, Lift, Relief, Wave
from padstudio.simulate.lay.tiles import Tiles
from padstudio.simulate.looks import LOOKS, dress
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.fog import Fog
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.litter import Litter, LitterKind
from padstudio.simulate.radiance.scene import (
    GROUND_KINDS,
    Light,
    Neighbour,
    Occluder,
    Scene,
    Shadow,
)
from padstudio.simulate.response import RESPONSES
from padstudio.simulate.sensor import Glare, Imaging
from padstudio.simulate.vibration import Vibration

Rng = np.random.Generator


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


@dataclass(frozen=True)
class RealityClass:
    """A kind of frames.

    Attributes
    ----------
    change : callable
        Puts the disturbance on a plain shot; gets the pad's shorter side, mm.
    heights : (low, high)
        In shorter sides of the pad.
    tilt_deg : float
        At most.
    after : callable or None
        Changes the picture, so that any pose of it is false.
    camera : str
        The only one of `CAMERAS`; empty for the usual ones in turn.
    """

    change: Callable[[Rng, Shot, float], Shot]
    heights: tuple[float, float] = (0.12, 1.5)
    tilt_deg: float = 20.0
    after: Callable[[np.ndarray], np.ndarray] | None = None
    camera: str = ""


def _camera(width: int, height: int, focal: float, bends: tuple[float, ...], **more) -> Camera:
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


def _scene(**changes) -> Callable[[Rng, Shot, float], Shot]:
    return lambda rng, shot, side: replace(shot, scene=replace(shot.scene, **changes))


def _imaging(**changes) -> Callable[[Rng, Shot, float], Shot]:
    return lambda rng, shot, side: replace(shot, imaging=shot.imaging.with_changes(**changes))


def _look(name: str) -> Callable[[Rng, Shot, float], Shot]:
    def change(rng: Rng, shot: Shot, side: float) -> Shot:
        scene, imaging = dress(shot.scene, name, seed=int(rng.integers(1000)))
        height = float(shot.pose.position_mm[2])
        speed, turn = rng.uniform(-0.3, 0.3, 3) * height, rng.uniform(-8, 8, 3)
        motion = Motion(velocity_mm_s=tuple(speed), angular_deg_s=tuple(turn))
        return replace(shot, scene=scene, imaging=imaging, motion=motion)

    return change


def _fog(contrast: float) -> Callable[[Rng, Shot, float], Shot]:
    def change(rng: Rng, shot: Shot, side: float) -> Shot:
        height_m = float(shot.pose.position_mm[2]) / 1000
        visibility = height_m * np.log(20) / -np.log(contrast)
        return replace(shot, scene=replace(shot.scene, fog=Fog(visibility_m=float(visibility))))

    return change


def _vibrating(rng: Rng, shot: Shot, side: float) -> Shot:
    shakes = tuple(
        Vibration.drawn(rng, float(rng.uniform(50, 150)), float(rng.uniform(0.05, 0.2)))
        for _ in range(1 + int(rng.integers(2)))
    )
    imaging = shot.imaging.with_changes(exposure_ms=2.0, readout_ms=float(rng.uniform(12, 30)))
    return replace(shot, imaging=imaging, motion=Motion(vibrations=shakes))


def _litter(kind: LitterKind, share: float) -> Callable[[Rng, Shot, float], Shot]:
    def change(rng: Rng, shot: Shot, side: float) -> Shot:
        usual = {"leaves": 0.05, "snow": 0.21, "mud": 0.18}[kind] * side
        litter = Litter(kind=kind, share=share, size_mm=usual, seed=int(rng.integers(1000)))
        return replace(shot, scene=replace(shot.scene, litter=litter))

    return change


def _bent(name: str) -> Callable[[Rng, Shot, float], Shot]:
    def change(rng: Rng, shot: Shot, side: float) -> Shot:
        toward = float(rng.uniform(0, 360))
        bends = {
            "waves": Wave(
                amplitude_mm=float(rng.uniform(0.5, 3)),
                length_mm=side * float(rng.uniform(0.12, 0.4)),
                toward_deg=toward,
                phase_deg=float(rng.uniform(0, 360)),
            ),
            "fold": Fold(
                height_mm=float(rng.uniform(3, 12)),
                reach_mm=side * float(rng.uniform(0.05, 0.12)),
                toward_deg=90.0 * int(rng.integers(4)),
                offset_mm=side * float(rng.uniform(-0.2, 0.2)),
                radius_mm=side * 0.02,
            ),
            "lifted": Lift(
                height_mm=float(rng.uniform(10, 35)),
                reach_mm=side * 0.3,
                toward_deg=45.0 + 90.0 * int(rng.integers(4)),
                offset_mm=side * 0.3,
            ),
        }
        return replace(shot, scene=replace(shot.scene, lay=Relief((bends[name],))))

    return change


def _tiled(swaps: int = 0, turn_deg: float = 0.2, gap_mm: float = 1.5):
    def change(rng: Rng, shot: Shot, side: float) -> Shot:
        lay = Tiles(
            columns=6,
            rows=5,
            gap_mm=gap_mm,
            offset_mm=1.0,
            turn_deg=turn_deg,
            swaps=swaps,
            seed=int(rng.integers(1000)),
        )
        return replace(shot, scene=replace(shot.scene, lay=lay))

    return change


def _two(copy: bool) -> Callable[[Rng, Shot, float], Shot]:
    def change(rng: Rng, shot: Shot, side: float) -> Shot:
        pad = shot.scene.pad
        if not copy:
            layers = tuple(
                replace(layer, field=rng.integers(0, pad.levels, layer.field.shape, np.uint8))
                for layer in pad.layers
            )
            pad = replace(pad, layers=layers)
        width, height = pad.size_mm
        away = (width + 0.04 * side, 0.0) if rng.random() < 0.5 else (0.0, height + 0.04 * side)
        turn = float(rng.uniform(-6, 6))
        beside = Neighbour(pad=pad, x_mm=away[0] * 1.08, y_mm=away[1] * 1.08, turn_deg=turn)
        middle = Pose(shot.pose.position_mm + np.array([*away, 0]) / 2, shot.pose.rotation)
        return replace(shot, scene=replace(shot.scene, neighbours=(beside,)), pose=middle)

    return change


def _occluded(rng: Rng, shot: Shot, side: float) -> Shot:
    """A third of the pad under one opaque thing."""
    x, y = rng.uniform(-0.35, 0.35, 2) * side
    disc = Occluder(x_mm=float(x), y_mm=float(y), radius_mm=0.36 * side, color=(92, 96, 84))
    return replace(shot, scene=replace(shot.scene, occluders=(disc,)))


def _hard_light(rng: Rng, shot: Shot, side: float) -> Shot:
    shadow = Shadow(toward_deg=float(rng.uniform(0, 360)), softness_mm=8.0, density=0.93)
    return replace(shot, scene=replace(shot.scene, light=Light(shadows=(shadow,))))


def _reversed(image: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(image[..., ::-1])


def _mirrored(image: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(image[:, ::-1])


def _inverted(image: np.ndarray) -> np.ndarray:
    return 255 - image


_NOTHING = _scene()
_DARK = {"brightness": 0.02, "full_well_e": 4000.0}

CLASSES: dict[str, RealityClass] = {
    "plain": RealityClass(_NOTHING),
    "near": RealityClass(_NOTHING, heights=(0.06, 0.12)),
    "far": RealityClass(_NOTHING, heights=(4.0, 10.0), tilt_deg=10.0),
    "tilted": RealityClass(_NOTHING, heights=(0.3, 0.7), tilt_deg=65.0),
    "mono": RealityClass(_imaging(response=RESPONSES["mono"])),
    "luma": RealityClass(_imaging(response=RESPONSES["luma"])),
    "nir": RealityClass(_imaging(response=RESPONSES["nir"])),
    "no-ir-filter": RealityClass(_imaging(response=RESPONSES["no-ir-filter"])),
    "sodium": RealityClass(_imaging(response=RESPONSES["sodium"])),
    "violet": RealityClass(_imaging(response=RESPONSES["violet"])),
    "fisheye160": RealityClass(_NOTHING, heights=(0.07, 0.9), camera="fisheye160"),
    "fisheye190": RealityClass(_NOTHING, heights=(0.07, 0.7), camera="fisheye190"),
    "thin-fog": RealityClass(_fog(0.25)),
    "fog": RealityClass(_fog(0.06)),
    "vibrating": RealityClass(_vibrating),
    "leaves-20": RealityClass(_litter("leaves", 0.2), heights=(0.3, 1.5)),
    "leaves-40": RealityClass(_litter("leaves", 0.4), heights=(0.3, 1.5)),
    "snow": RealityClass(_litter("snow", 0.3), heights=(0.3, 1.5)),
    "mud": RealityClass(_litter("mud", 0.3), heights=(0.3, 1.5)),
    "occluded": RealityClass(_occluded, heights=(1.5, 3.0)),
    "faded": RealityClass(_scene(inks=Inks().faded(0.75))),
    "gloss": RealityClass(_imaging(glare=Glare(x=0.55, y=0.45, radius=0.22, strength=12.0))),
    "strong-glare": RealityClass(_imaging(glare=Glare(x=0.4, y=0.5, radius=0.5, strength=2.0))),
    "very-dark": RealityClass(_imaging(**_DARK)),
    "hard-shadow": RealityClass(_hard_light),
    "waves": RealityClass(_bent("waves")),
    "fold": RealityClass(_bent("fold")),
    "lifted": RealityClass(_bent("lifted")),
    "gaps": RealityClass(_tiled()),
    "turned-sheets": RealityClass(_tiled(turn_deg=0.5, gap_mm=0.5)),
    "swapped-sheets": RealityClass(_tiled(swaps=2)),
    "two-copies": RealityClass(_two(copy=True), heights=(0.8, 2.0)),
    "two-pads": RealityClass(_two(copy=False), heights=(0.8, 2.0)),
    **{f"look-{name}": RealityClass(_look(name)) for name in LOOKS if name != "clear"},
    "exchanged": RealityClass(_NOTHING, after=_reversed),
    "mirrored": RealityClass(_NOTHING, after=_mirrored),
    "inverted": RealityClass(_NOTHING, after=_inverted),
}
