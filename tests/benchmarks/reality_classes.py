"""What happens to prints and cameras, one class of simulated frames after the other."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from reality_shots import Change, Picture, RealityClass, Rng, Shot

from padstudio.geometry.pose import Pose
from padstudio.simulate.lay.relief import Fold, Lift, Relief, Wave
from padstudio.simulate.lay.tiles import Tiles
from padstudio.simulate.looks import LOOKS, dress
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.fog import Fog
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.litter import Litter, LitterKind
from padstudio.simulate.radiance.scene import (
    Light,
    Neighbour,
    Occluder,
    Shadow,
)
from padstudio.simulate.response import RESPONSES
from padstudio.simulate.sensor import Glare
from padstudio.simulate.vibration import Vibration


def _scene(**changes: Any) -> Change:
    return lambda rng, shot, side: replace(shot, scene=replace(shot.scene, **changes))


def _imaging(**changes: Any) -> Change:
    return lambda rng, shot, side: replace(shot, imaging=shot.imaging.with_changes(**changes))


def _look(name: str) -> Change:
    def change(rng: Rng, shot: Shot, side: float) -> Shot:
        scene, imaging = dress(shot.scene, name, seed=int(rng.integers(1000)))
        height = float(shot.pose.position_mm[2])
        speed, turn = rng.uniform(-0.3, 0.3, 3) * height, rng.uniform(-8, 8, 3)
        motion = Motion(velocity_mm_s=tuple(speed), angular_deg_s=tuple(turn))
        return replace(shot, scene=scene, imaging=imaging, motion=motion)

    return change


def _fog(contrast: float) -> Change:
    def change(rng: Rng, shot: Shot, side: float) -> Shot:
        height_m = float(shot.pose.position_mm[2]) / 1000
        # No fog is thicker than that, whatever the height.
        visibility = max(float(height_m * np.log(20) / -np.log(contrast)), 0.1)
        return replace(shot, scene=replace(shot.scene, fog=Fog(visibility_m=visibility)))

    return change


def _vibrating(rng: Rng, shot: Shot, side: float) -> Shot:
    shakes = tuple(
        Vibration.drawn(rng, float(rng.uniform(50, 150)), float(rng.uniform(0.05, 0.2)))
        for _ in range(1 + int(rng.integers(2)))
    )
    imaging = shot.imaging.with_changes(exposure_ms=2.0, readout_ms=float(rng.uniform(12, 30)))
    return replace(shot, imaging=imaging, motion=Motion(vibrations=shakes))


def _litter(kind: LitterKind, share: float) -> Change:
    def change(rng: Rng, shot: Shot, side: float) -> Shot:
        usual = {"leaves": 0.05, "snow": 0.21, "mud": 0.18}[kind] * side
        litter = Litter(kind=kind, share=share, size_mm=usual, seed=int(rng.integers(1000)))
        return replace(shot, scene=replace(shot.scene, litter=litter))

    return change


def _bent(name: str) -> Change:
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


def _tiled(swaps: int = 0, turn_deg: float = 0.2, gap_mm: float = 1.5) -> Change:
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


def _two(copy: bool) -> Change:
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


def _reversed(image: Picture) -> Picture:
    return np.ascontiguousarray(image[..., ::-1])


def _mirrored(image: Picture) -> Picture:
    return np.ascontiguousarray(image[:, ::-1])


def _inverted(image: Picture) -> Picture:
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
    **{
        f"look-{name}": RealityClass(_look(name))
        for name, look in LOOKS.items()
        if name != "clear" and not look.disturbances
    },
    "exchanged": RealityClass(_NOTHING, after=_reversed),
    "mirrored": RealityClass(_NOTHING, after=_mirrored),
    "inverted": RealityClass(_NOTHING, after=_inverted),
}
