"""Named conditions: light, dirt and camera settings that a flight may meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from padstudio.errors import SpecError, shown
from padstudio.simulate.disturbances import disturb
from padstudio.simulate.radiance.scene import Light, Occluder, Scene, Shadow
from padstudio.simulate.sensor import Glare, Imaging


@dataclass(frozen=True)
class Look:
    """Conditions to put on a scene.

    Attributes
    ----------
    light : Light
    imaging : Imaging
    leaves : int
        Number of things that lie on the pad.
    disturbances : tuple of str
        As of `padstudio.simulate.disturbances.disturb`.
    note : str
        One line for people.
    """

    note: str
    light: Light = field(default_factory=Light)
    imaging: Imaging = field(default_factory=Imaging)
    leaves: int = 0
    disturbances: tuple[str, ...] = ()


# Those that are told in words alone.
_WORDED: dict[str, tuple[str, tuple[str, ...]]] = {
    "autumn": ("two fifths of the pad under leaves", ("leaves=0.4",)),
    "snow": ("snow on a third of the pad", ("snow=0.33",)),
    "mud": ("mud on a third of the pad", ("mud=0.33",)),
    "faded": ("ink that years of sun have faded", ("faded=0.7",)),
    "mist": ("mist: 20 m of sight", ("fog=20",)),
    "fog": ("dust or thick fog: 4 m of sight", ("fog=4",)),
    "mono": ("a monochrome camera", ("sensor=mono",)),
    "infrared": ("a camera that sees the near infrared alone", ("sensor=nir",)),
    "sodium": ("yellow street light", ("sensor=sodium",)),
    "warped": ("paper with waves and a fold", ("waves=2:260", "fold=6:70")),
    "tiled": ("24 sheets, laid by hand", ("tiles=6x4", "gap=1.5", "offset=1", "turn=0.3")),
}


def _looks() -> dict[str, Look]:
    plain = Imaging()
    half = Shadow(x_mm=80.0, toward_deg=70.0, softness_mm=25.0, density=0.85)
    drone = Shadow(x_mm=60.0, y_mm=40.0, radius_mm=220.0, softness_mm=90.0, density=0.75)
    low_sun = Light(gradient_per_m=(0.3, 0.2), cast=(1.15, 1.0, 0.75))
    return {
        "clear": Look("even daylight"),
        "gradient": Look("light that falls off to one side", Light(gradient_per_m=(0.7, 0.3))),
        "shadow": Look("a hard shadow across the pad", Light(shadows=(half,))),
        "drone-shadow": Look("the drone's own shadow", Light(shadows=(drone,))),
        "low-sun": Look("a low, warm sun", low_sun),
        "dusk": Look(
            "little light: long exposure, much noise",
            imaging=plain.with_changes(
                brightness=0.3, exposure_ms=15.0, full_well_e=800.0, read_noise_e=8.0
            ),
        ),
        "bright": Look("over-exposed", imaging=plain.with_changes(brightness=2.5)),
        "glare": Look("sun mirrored in the print", imaging=plain.with_changes(glare=Glare(x=0.4))),
        "defocus": Look("out of focus", imaging=plain.with_changes(defocus_px=3.0)),
        "blur": Look("slow shutter", imaging=plain.with_changes(exposure_ms=20.0)),
        "rolling": Look("slow rolling shutter", imaging=plain.with_changes(readout_ms=25.0)),
        "noise": Look(
            "a noisy sensor", imaging=plain.with_changes(full_well_e=300.0, read_noise_e=12.0)
        ),
        "salt": Look("stuck pixels", imaging=plain.with_changes(hot_pixels=0.02)),
        "jpeg": Look("strong compression", imaging=plain.with_changes(jpeg_quality=40)),
        "leaves": Look("leaves and stones on the pad", leaves=28),
        **{name: Look(note, disturbances=words) for name, (note, words) in _WORDED.items()},
    }


LOOKS = _looks()


def dress(
    scene: Scene, look: str, *, seed: int = 0, words: Sequence[str] = ()
) -> tuple[Scene, Imaging]:
    """The scene under a look's light with its dirt, and the look's camera settings.

    Parameters
    ----------
    scene : Scene
    look : str
    seed : int
    words : sequence of str
        Disturbances on top of the look's, as of `padstudio.simulate.disturbances.disturb`.

    Raises
    ------
    SpecError
        If there is no such look, or as `disturb`.
    """
    if look not in LOOKS:
        raise SpecError(f"no look {shown(look)}; choose one of {', '.join(LOOKS)}")
    chosen = LOOKS[look]
    occluders = scene.occluders + _leaves(scene, chosen.leaves, seed)
    lit = replace(scene, light=chosen.light, occluders=occluders)
    return disturb(lit, chosen.imaging, _together(chosen.disturbances, words), seed=seed)


def _together(own: Sequence[str], given: Sequence[str]) -> tuple[str, ...]:
    """A look's disturbances, those of the same name as given."""
    names = {word.partition("=")[0].strip() for word in given}
    return (*(word for word in own if word.partition("=")[0] not in names), *given)


def _leaves(scene: Scene, count: int, seed: int) -> tuple[Occluder, ...]:
    if scene.size_mm is None or not count:
        return ()
    rng = np.random.default_rng([seed, 0x1EAF])
    width, height = scene.size_mm
    leaves = []
    for x, y, size, *color in rng.random((count, 6)):
        red, green, blue = (70.0 + 120.0 * float(value) for value in color)
        leaves.append(
            Occluder(
                x_mm=(float(x) - 0.5) * width,
                y_mm=(float(y) - 0.5) * height,
                radius_mm=(0.014 + 0.021 * float(size)) * min(width, height),
                color=(red, green, blue),
            )
        )
    return tuple(leaves)
