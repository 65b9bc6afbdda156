"""Sets of simulated frames over which a covariance ought to hold, with their true poses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from padstudio import Camera, Pad
from padstudio.geometry.pose import Pose
from padstudio.simulate.lay.relief import Fold, Relief, Wave
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.trajectories import Flight, FlightKind, FlightSpec, Setup, plan
from padstudio.simulate.vibration import Vibration

#: A video of each kind is the middle of three seconds from each of these to two fifths of it.
_FRAMES = 90
_HEIGHTS_MM = (4500.0, 2200.0, 1100.0, 550.0, 250.0, 120.0)
#: The same of the far end; the last ends at 8 m.
_FAR_MM = (60_000.0, 48_000.0, 38_000.0, 30_000.0, 24_000.0, 20_000.0)

_AT_REST = Imaging(exposure_ms=0.0)
_GLOBAL = Imaging(exposure_ms=3.0)
_ROLLING = Imaging(exposure_ms=3.0, readout_ms=20.0)
# A picture shows the mean over its exposure; in 1 ms that is the middle of any swing, nearly.
_QUICK_GLOBAL = Imaging(exposure_ms=1.0)


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One set of frames, seen one by one or tracked.

    Attributes
    ----------
    name : str
    kind : FlightKind
    imaging : Imaging
    tracked : bool
    stills_mm : (from, to) or None
        Of stills; None for videos.
    heights_mm : tuple of float
        Where videos begin, one a seed.
    sway : float
    vibrating : bool
        At one or two frequencies of 50 … 150 Hz, by 0.05 … 0.2 degrees.
    warped : bool
        On paper with waves and a fold; the truth is relative to the nominal plane.
    """

    name: str
    kind: FlightKind
    imaging: Imaging
    tracked: bool = False
    stills_mm: tuple[float, float] | None = None
    heights_mm: tuple[float, ...] = _HEIGHTS_MM
    sway: float = 1.0
    vibrating: bool = False
    warped: bool = False


def _both(name: str, kind: FlightKind, imaging: Imaging, **more: object) -> tuple[Trial, ...]:
    """A set's single frames and the same frames tracked."""
    single = Trial(name=f"{name}, single", kind=kind, imaging=imaging)
    single = replace(single, **more)
    return single, replace(single, name=f"{name}, tracked", tracked=True)


TRIALS = (
    Trial(name="still, 12 m … 70 mm", kind="descent", imaging=_AT_REST, stills_mm=(12_000, 70)),
    Trial(name="still, tilts to 70°", kind="tilts", imaging=_AT_REST, stills_mm=(900, 900)),
    *_both("still, rolling", "hover", _ROLLING, sway=0.0),
    *_both("hover, rolling", "hover", _ROLLING),
    *_both("landing, global shutter", "landing", _GLOBAL),
    *_both("landing, rolling", "landing", _ROLLING),
    *_both("gusty, rolling", "gusty", _ROLLING),
    *_both("vibrating landing, rolling", "landing", _ROLLING, vibrating=True),
    *_both("vibrating hover, rolling", "hover", _ROLLING, vibrating=True),
    *_both("vibrating landing, global", "landing", _QUICK_GLOBAL, vibrating=True),
    Trial(name="far, 60 … 8 m, stills", kind="descent", imaging=_AT_REST, stills_mm=(60_000, 8000)),
    Trial(
        name="warped, 4 m … 150 mm, stills",
        kind="descent",
        imaging=_AT_REST,
        stills_mm=(4000, 150),
        warped=True,
    ),
    *_both("warped landing, rolling", "landing", _ROLLING, warped=True),
    *_both("far, 60 … 8 m, rolling", "landing", _ROLLING, heights_mm=_FAR_MM),
)


def frames_of(
    trial: Trial, pad: Pad, camera: Camera, frames: int, seed: int
) -> Iterator[tuple[NDArray[np.uint8], Pose]]:
    """The pictures of a flight and their true poses."""
    flight = _flight(trial, frames, seed)
    lay = _warp(seed) if trial.warped else None
    scene = Scene(pad=pad, ground="gravel", lay=lay)
    setup = Setup(scene=scene, camera=camera, imaging=trial.imaging, seed=seed)
    for frame in flight.frames(setup):
        yield frame.image, frame.truth.pose


def _flight(trial: Trial, frames: int, seed: int) -> Flight:
    start = trial.heights_mm[seed % len(trial.heights_mm)]
    from_mm, to_mm = trial.stills_mm or (start, 0.4 * start)
    spec = FlightSpec(
        kind=trial.kind,
        frames=frames if trial.stills_mm else _FRAMES,
        from_mm=from_mm,
        to_mm=to_mm,
        seed=seed,
        sway=trial.sway,
        vibrations=_vibrations(seed) if trial.vibrating else (),
    )
    flight = plan(spec)
    if trial.stills_mm:
        return flight
    some = slice((_FRAMES - frames) // 2, (_FRAMES + frames) // 2)
    return replace(
        flight,
        poses=flight.poses[some],
        motions=flight.motions[some],
        groups=flight.groups[some],
    )


def _vibrations(seed: int) -> tuple[Vibration, ...]:
    rng = np.random.default_rng([seed, *b"shaking"])
    return tuple(
        Vibration.drawn(rng, float(rng.uniform(50, 150)), float(rng.uniform(0.05, 0.2)))
        for _ in range(1 + int(rng.integers(2)))
    )


def _warp(seed: int) -> Relief:
    """Waves of 0.5 … 3 mm and a fold of 2 … 8 mm."""
    rng = np.random.default_rng([seed, *b"warped"])
    wave = Wave(
        amplitude_mm=float(rng.uniform(0.5, 3)),
        length_mm=float(rng.uniform(150, 500)),
        toward_deg=float(rng.uniform(0, 180)),
        phase_deg=float(rng.uniform(0, 360)),
    )
    fold = Fold(
        height_mm=float(rng.uniform(2, 8)),
        reach_mm=float(rng.uniform(40, 120)),
        toward_deg=float(rng.choice([0.0, 90.0])),
        offset_mm=float(rng.uniform(-200, 200)),
        radius_mm=10.0,
    )
    return Relief((wave, fold))
