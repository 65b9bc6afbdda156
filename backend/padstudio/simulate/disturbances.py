"""Disturbances as words that a person types: ``fog=30``, ``leaves=0.4``, ``vibration=93:0.1``."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from padstudio.errors import SpecError, shown
from padstudio.simulate.lay.relief import Fold, Lift, Relief, Wave
from padstudio.simulate.lay.tiles import Tiles
from padstudio.simulate.radiance.fog import Fog
from padstudio.simulate.radiance.litter import LITTER_KINDS, Litter
from padstudio.simulate.radiance.scene import Neighbour, Scene
from padstudio.simulate.response import RESPONSES
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.vibration import Vibration


@dataclass(frozen=True)
class Word:
    """What may be typed of one disturbance.

    Attributes
    ----------
    form : str
        What stands after the equals sign.
    note : str
        One line for people.
    """

    form: str
    note: str


#: All disturbances, in the order in which they are listed.
WORDS = {
    "vibration": Word("HZ:DEG", "the camera shakes about its axes; several: 93:0.1+141:0.05"),
    "exposure": Word("MS", "time each row gathers light"),
    "readout": Word("MS", "rolling shutter, first row to last; 0 is global"),
    "sensor": Word("NAME", f"spectral response: {', '.join(RESPONSES)}"),
    "fog": Word("METRES", "visibility, at which 5 % of contrast is left"),
    "leaves": Word("SHARE", "of the pad that leaves cover, 0 … 0.95"),
    "snow": Word("SHARE", "of the pad that snow covers"),
    "mud": Word("SHARE", "of the pad that mud covers"),
    "faded": Word("SHARE", "of the ink's dyes that is gone, 0 … 1"),
    "waves": Word("MM:LENGTH", "bent paper: amplitude and length of its waves, mm"),
    "fold": Word("MM:REACH", "bent paper: height of a ridge, and how far it reaches, mm"),
    "lifted": Word("MM:REACH", "bent paper: a corner that rises so high over its last mm"),
    "tiles": Word("COLUMNSxROWS", "a print of so many sheets"),
    "gap": Word("MM", "between the sheets of a tiled print"),
    "offset": Word("MM", "each sheet lies up to so much off its place"),
    "turn": Word("DEG", "each sheet is turned by up to so much"),
    "swaps": Word("COUNT", "pairs of sheets that are exchanged"),
    "copy": Word("MM:DEG", "the same pad once more, so far to the right and turned"),
}
_ONE = re.compile(r"([^:]+)")
_TWO = re.compile(r"([^:]+):([^:]+)")
_TILES = re.compile(r"(\d{1,3})x(\d{1,3})")


def disturb(
    scene: Scene, imaging: Imaging, words: Sequence[str], *, seed: int = 0
) -> tuple[Scene, Imaging]:
    """A scene and a camera with disturbances; vibrations are `vibrations_of` the same words.

    Parameters
    ----------
    scene : Scene
    imaging : Imaging
    words : sequence of str
        ``NAME=VALUE``, names as of `WORDS`, each at most once.
    seed : int
        Of what is drawn at random: where leaves lie, in which direction paper bends.

    Raises
    ------
    SpecError
        If a word is not known, its value ill-formed or out of range.
    """
    given = _parsed(words)
    rng = np.random.default_rng([seed, *b"disturbances"])
    for kind in LITTER_KINDS:
        if kind in given:
            litter = Litter(kind=kind, share=_number(given, kind), seed=seed)
            if scene.litter is not None:
                raise SpecError(f"{kind}: there are {scene.litter.kind} already; give one of them")
            scene = replace(scene, litter=litter)
    if "fog" in given:
        scene = replace(scene, fog=Fog(visibility_m=_number(given, "fog")))
    if "faded" in given:
        scene = replace(scene, inks=scene.inks.faded(_number(given, "faded")))
    lay = _relief(given, rng, scene) or _tiles(given, seed)
    if lay is not None:
        scene = replace(scene, lay=lay)
    if "copy" in given:
        if scene.pad is None:
            raise SpecError("copy: the ground is bare; give a pad")
        away_mm, turn_deg = _numbers(given, "copy")
        copy = Neighbour(pad=scene.pad, x_mm=away_mm, y_mm=0.0, turn_deg=turn_deg)
        scene = replace(scene, neighbours=(*scene.neighbours, copy))
    return scene, _imaging(given, imaging)


def vibrations_of(words: Sequence[str], *, seed: int = 0) -> tuple[Vibration, ...]:
    """The vibrations among disturbances, with phases drawn at random; raises as `disturb`."""
    given = _parsed(words)
    if "vibration" not in given:
        return ()
    rng = np.random.default_rng([seed, *b"vibrations"])
    out = []
    for part in given["vibration"].split("+"):
        frequency_hz, amplitude_deg = _numbers({"vibration": part}, "vibration")
        out.append(Vibration.drawn(rng, frequency_hz, amplitude_deg))
    return tuple(out)


def _parsed(words: Sequence[str]) -> dict[str, str]:
    given: dict[str, str] = {}
    for word in words:
        name, equals, value = word.strip().partition("=")
        if name not in WORDS:
            raise SpecError(f"no disturbance {shown(name)}; choose of {', '.join(WORDS)}")
        if not equals or not value:
            raise SpecError(f"{shown(word)}: give {name}={WORDS[name].form}")
        if name in given:
            raise SpecError(f"{name} is given twice")
        given[name] = value
    return given


def _numbers(given: Mapping[str, str], name: str) -> tuple[float, float]:
    """The two numbers of a word."""
    found = _TWO.fullmatch(given[name])
    if found is None:
        raise _ill_formed(given, name)
    try:
        return float(found[1]), float(found[2])
    except ValueError:
        raise _ill_formed(given, name) from None


def _number(given: Mapping[str, str], name: str) -> float:
    found = _ONE.fullmatch(given[name])
    try:
        return float(found[1] if found else "")
    except ValueError:
        raise _ill_formed(given, name) from None


def _ill_formed(given: Mapping[str, str], name: str) -> SpecError:
    return SpecError(f"{name}={given[name]} is ill-formed; give {name}={WORDS[name].form}")


def _imaging(given: Mapping[str, str], imaging: Imaging) -> Imaging:
    if "exposure" in given:
        imaging = imaging.with_changes(exposure_ms=_number(given, "exposure"))
    if "readout" in given:
        imaging = imaging.with_changes(readout_ms=_number(given, "readout"))
    if "sensor" in given:
        if given["sensor"] not in RESPONSES:
            raise SpecError(
                f"no sensor {shown(given['sensor'])}; choose one of {', '.join(RESPONSES)}"
            )
        imaging = imaging.with_changes(response=RESPONSES[given["sensor"]])
    return imaging


def _relief(given: Mapping[str, str], rng: np.random.Generator, scene: Scene) -> Relief | None:
    """The bends that are given, each in a direction of its own."""
    bends: list[Wave | Fold | Lift] = []
    if "waves" in given:
        amplitude_mm, length_mm = _numbers(given, "waves")
        toward, phase = (float(value) for value in rng.uniform(0, 360, 2))
        bends.append(
            Wave(
                amplitude_mm=amplitude_mm,
                length_mm=length_mm,
                toward_deg=toward,
                phase_deg=phase,
            )
        )
    if "fold" in given:
        height_mm, reach_mm = _numbers(given, "fold")
        across = 90.0 * int(rng.integers(2))
        bends.append(Fold(height_mm=height_mm, reach_mm=reach_mm, toward_deg=across))
    if "lifted" in given:
        height_mm, reach_mm = _numbers(given, "lifted")
        corner = 45.0 + 90.0 * int(rng.integers(4))
        # From the corner of the print inwards.
        far = float(np.hypot(*scene.size_mm)) / 2 if scene.size_mm else 0.0
        offset = max(far - reach_mm, 0.0)
        bends.append(
            Lift(height_mm=height_mm, reach_mm=reach_mm, toward_deg=corner, offset_mm=offset)
        )
    if bends and "tiles" in given:
        raise SpecError("a print is bent or in sheets here, not both")
    return Relief(tuple(bends)) if bends else None


def _tiles(given: Mapping[str, str], seed: int) -> Tiles | None:
    parts = [name for name in ("gap", "offset", "turn", "swaps") if name in given]
    if "tiles" not in given:
        if parts:
            raise SpecError(f"{parts[0]} needs sheets; give tiles={WORDS['tiles'].form} too")
        return None
    found = _TILES.fullmatch(given["tiles"])
    if found is None:
        raise _ill_formed(given, "tiles")
    numbers = {name: _number(given, name) for name in parts}
    swaps = numbers.get("swaps", 0.0)
    if swaps != int(swaps):
        raise _ill_formed(given, "swaps")
    return Tiles(
        columns=int(found[1]),
        rows=int(found[2]),
        gap_mm=numbers.get("gap", 0.0),
        offset_mm=numbers.get("offset", 0.0),
        turn_deg=numbers.get("turn", 0.0),
        swaps=int(swaps),
        seed=seed,
    )
