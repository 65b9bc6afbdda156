"""The frames of the shoot-out: the same poses, light and camera settings over every board."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from padstudio import Camera, Pose
from padstudio.pad.layout import Layout
from padstudio.pad.spec import Pad
from padstudio.simulate.looks import dress
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.trajectories import FlightSpec, plan

SEED = 20
# Speeds under the looks, as shares of the height a second and degrees a second.
DRIFT, FALL, TURN_DEG_S = 0.2, 0.1, 3.0
LOOK_HEIGHTS_MM = (450.0, 3000.0)
READOUT_MS = 20.0
# Looks of light, dirt and camera; what bends or hides prints is not the boards' difference.
LIGHTS = (
    "clear",
    "gradient",
    "shadow",
    "drone-shadow",
    "low-sun",
    "dusk",
    "bright",
    "glare",
    "defocus",
    "blur",
    "rolling",
    "noise",
    "salt",
    "jpeg",
    "leaves",
)


@dataclass(frozen=True)
class View:
    """One frame to be taken over every board."""

    group: str
    pose: Pose
    motion: Motion = field(default_factory=Motion)
    look: str = "clear"
    readout_ms: float = 0.0


@dataclass(frozen=True)
class Shot:
    """A frame over one board: the JPEG file and the truth."""

    board: str
    group: str
    jpeg: bytes
    pose: Pose | None


def views(full: bool) -> list[View]:
    """All views, in the order of their groups; a flight's follow one another in time."""
    more = 3 if full else 1
    stills = [
        View(group, pose)
        for group, count, start, end in (
            ("far", 3, 48_000.0, 20_000.0),
            ("descent", 18, 16_000.0, 60.0),
            ("near", 2, 52.0, 45.0),
        )
        for pose in plan(
            FlightSpec(kind="descent", frames=count * more, from_mm=start, to_mm=end, seed=SEED)
        ).poses
    ]
    for distance_mm in (600.0, 1500.0, 4000.0) if full else (1000.0,):
        tilts = plan(
            FlightSpec(kind="tilts", frames=8, from_mm=distance_mm, to_mm=distance_mm, seed=SEED)
        )
        stills += [View("tilts", pose) for pose in tilts.poses]
    return [*stills, *_looks(full), *_flight(16 * more)]


def _looks(full: bool) -> list[View]:
    """Each of `LIGHTS`; at one of the heights in turn, or at all."""
    out = []
    for number, look in enumerate(LIGHTS):
        chosen = LOOK_HEIGHTS_MM if full else (LOOK_HEIGHTS_MM[number % 2],)
        for height_mm in chosen:
            pose = plan(
                FlightSpec(
                    kind="descent", frames=1, from_mm=height_mm, to_mm=height_mm, seed=number
                )
            ).poses[0]
            speed = np.array([DRIFT, DRIFT, -FALL]) * height_mm
            motion = Motion(
                velocity_mm_s=(speed[0], speed[1], speed[2]), angular_deg_s=(TURN_DEG_S,) * 3
            )
            out.append(View("looks", pose, motion, look))
    return out


def _flight(frames: int) -> list[View]:
    """A landing at 30 frames a second, half a metre a second, under a rolling shutter."""
    end_mm = 1200.0 - 500.0 * frames / 30
    flight = plan(
        FlightSpec(
            kind="landing", frames=frames, from_mm=1200.0, to_mm=max(end_mm, 300.0), seed=SEED
        )
    )
    return [
        View("flight", pose, motion, readout_ms=READOUT_MS)
        for pose, motion in zip(flight.poses, flight.motions, strict=True)
    ]


def shots(board: str, print_: Pad | Layout, camera: Camera, planned: list[View]) -> Iterator[Shot]:
    """Take every view over a board."""
    pad, sheet = (print_, None) if isinstance(print_, Pad) else (None, print_)
    for number, view in enumerate(planned):
        scene, imaging = dress(Scene(pad=pad, sheet=sheet), view.look, seed=number)
        if view.readout_ms:
            imaging = imaging.with_changes(readout_ms=view.readout_ms)
        frame = render(scene, camera, view.pose, imaging, SEED + number, motion=view.motion)
        assert frame.encoded is not None
        yield Shot(board, view.group, frame.encoded, view.pose)


def bare_ground(camera: Camera, count: int) -> Iterator[Shot]:
    """Ground without any board."""
    for number, pose in enumerate(
        plan(FlightSpec(kind="descent", frames=count, from_mm=8000, to_mm=300)).poses
    ):
        scene = Scene(pad=None, ground=("gravel", "bricks", "grass")[number % 3])
        frame = render(scene, camera, pose, Imaging(), number)
        assert frame.encoded is not None
        yield Shot("bare ground", "foreign", frame.encoded, None)
