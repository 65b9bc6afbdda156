"""What is simulated: the pad and the camera of the paper, and every frame of its experiments.

Source: the article "landing sign based on double-layer unique coding" (2024),
doi:10.1177/17298806241279046. Its pad is 1250 mm wide with cells of 10 mm and 50 mm, windows of
5 x 5 and two levels; its camera has a lens of 24 mm equivalent focal length and 2720 x 1530 pixels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal, get_args

import numpy as np

from padstudio.errors import SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.geometry.presets import load_camera
from padstudio.pad.coding.generate import generate_pad
from padstudio.pad.coding.pad_spec import PadSpec
from padstudio.pad.spec import Pad
from padstudio.simulate.radiance.scene import Light, Scene
from padstudio.simulate.sensor import Imaging

ExperimentName = Literal[
    "stages", "ranges", "vertical", "horizontal", "attitude", "landing", "continuity"
]
#: In the order of the report.
EXPERIMENTS: tuple[ExperimentName, ...] = get_args(ExperimentName)
#: Frames that are taken of one place, and the most that may be.
SEEDS, MOST_SEEDS = 20, 100
#: The width of the paper's pad and of its cells, mm; its window, cells.
SIDE_MM, FINE_MM, COARSE_MM, WINDOW = 1250.0, 10.0, 50.0, 5
#: The height of the series across the pad and of attitude, mm.
SERIES_MM = 500.0
#: The height of the series from cell to cell, where the fine layer is read, mm.
CELLS_MM = 150.0

_CAMERA = "preset-dji-mini-27k"
_SEED = 1
# A camera that is held at a place by hand or hovers there: off by so much, at random.
_OFF_MM, _LEAN_DEG = 10.0, 2.0


@dataclass(frozen=True)
class Place:
    """Where a camera is held, nominally.

    Attributes
    ----------
    height_mm, x_mm, y_mm : float
        Over the pad's centre.
    tilt_deg : float
        Of the optical axis off straight down, on top of what a hand leaves over; the axis then
        meets the pad's plane at (x, y).
    """

    height_mm: float
    x_mm: float = 0.0
    y_mm: float = 0.0
    tilt_deg: float = 0.0


_LANDING_MM = (1540, 1200, 900, 700, 550, 470, 400, 330, 260, 210)
#: The places of each experiment; ranges are read from the vertical series' frames.
PLACES: dict[ExperimentName, tuple[Place, ...]] = {
    "vertical": tuple(
        Place(height) for height in (70, 80, 130, 180, 220, 260, 310, 400, 600, 900, 1540, 1800)
    ),
    "horizontal": tuple(Place(SERIES_MM, x_mm=x, y_mm=-x / 2) for x in range(-300, 301, 100)),
    "attitude": tuple(
        Place(SERIES_MM, tilt_deg=tilt) for tilt in (10, 20, 30, 40, 50, 60, 65, 70, 75)
    ),
    # It comes in from the side, and settles over the centre.
    "landing": tuple(
        Place(height, x_mm=120.0 * (height / 1540) ** 2, y_mm=-80.0 * height / 1540)
        for height in _LANDING_MM
    ),
    # Along a rail: whatever a hand leaves over is the same at each place.
    "continuity": tuple(Place(CELLS_MM, x_mm=FINE_MM * step) for step in range(6)),
}


@dataclass(frozen=True)
class Shot:
    """One frame.

    Attributes
    ----------
    series : str
        The experiment whose place it is taken at.
    place : int
        Its number there.
    seed : int
    by_layer : bool
        Each layer is also read alone.
    """

    series: ExperimentName
    place: int
    seed: int
    by_layer: bool = False

    @property
    def where(self) -> Place:
        """Where the camera is held, nominally."""
        return PLACES[self.series][self.place]


@cache
def paper_pad() -> Pad:
    """A pad of the paper's sizes, its layers' fields independent of each other."""
    side = round(SIDE_MM / FINE_MM)
    spec = PadSpec(
        name="1250 mm, 10 mm and 50 mm cells",
        window=WINDOW,
        levels=2,
        rows=side,
        cols=side,
        ratio=round(COARSE_MM / FINE_MM),
        cell_mm=FINE_MM,
        unique="rotation",
        distance=1,
        seed=_SEED,
    )
    return generate_pad(spec)


@cache
def paper_camera() -> Camera:
    """The paper's camera, as its data sheet has it."""
    return load_camera(_CAMERA, no_distortion=False)


def shots_of(names: Sequence[ExperimentName], seeds: int) -> list[Shot]:
    """All frames of some experiments, each once.

    Parameters
    ----------
    names : sequence of ExperimentName
    seeds : int
        Frames of each place.

    Raises
    ------
    SpecError
        If there are no seeds or more than `MOST_SEEDS`.
    """
    if not 1 <= seeds <= MOST_SEEDS:
        raise SpecError(f"seeds is {seeds}; it must lie within 1 … {MOST_SEEDS}")
    wanted = {"vertical" if name == "ranges" else name for name in names}
    return [
        Shot(series, place, seed, by_layer=series == "vertical" and "ranges" in names)
        for series, places in PLACES.items()
        if series in wanted
        for place in range(len(places))
        for seed in range(seeds)
    ]


def pose_of(shot: Shot) -> Pose:
    """Where the camera really is: near its place, at a heading and a lean of its own.

    A flight keeps its heading, and a rail all that a hand leaves over.
    """
    where = shot.where
    flight, hand = _random(shot, "flight", of_place=False), _random(shot, "hand")
    if shot.series == "continuity":
        hand = flight
    heading = (flight if shot.series == "landing" else hand).uniform(0, 360)
    off_x, off_y, off_z = hand.uniform(-_OFF_MM, _OFF_MM, 3)
    return look_at_pad(
        where.height_mm + off_z * min(1.0, where.height_mm / SERIES_MM),
        tilt_deg=abs(where.tilt_deg + hand.uniform(-1, 1) * _LEAN_DEG),
        heading_deg=heading,
        tilt_towards_deg=hand.uniform(0, 360),
        target_mm=(where.x_mm + off_x, where.y_mm + off_y),
    )


def scene_of(shot: Shot) -> Scene:
    """The pad on grass, under light that falls off and is a little coloured."""
    rng = _random(shot, "light")
    light = Light(
        level=rng.uniform(0.8, 1.15),
        gradient_per_m=(rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3)),
        cast=(rng.uniform(0.92, 1.08), 1.0, rng.uniform(0.92, 1.08)),
    )
    return Scene(pad=paper_pad(), light=light, ground_seed=shot.seed)


def imaging_of(shot: Shot) -> Imaging:
    """A small drone's camera: noise, a mosaic, a lens that is more or less sharp, JPEG."""
    rng = _random(shot, "imaging")
    return Imaging(
        blur_px=rng.uniform(0.5, 1.1),
        full_well_e=rng.uniform(2500, 8000),
        sharpen=rng.uniform(0.0, 0.5),
        jpeg_quality=int(rng.integers(80, 93)),
    )


def noise_of(shot: Shot) -> int:
    """The seed of the sensor's noise."""
    return int(_random(shot, "noise").integers(2**31))


def _random(shot: Shot, what: str, *, of_place: bool = True) -> np.random.Generator:
    """A stream of its own for each use, whatever else is simulated; for each frame, or a series."""
    place = shot.place + 1 if of_place else 0
    return np.random.default_rng([shot.seed, place, *f"{shot.series} {what}".encode()])
