"""Simulated flights: where the camera is, how it moves, frame by frame."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal, get_args

import numpy as np

from padstudio.errors import LimitError, SpecError, shown
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.simulate.motion import Motion, course
from padstudio.simulate.paths import motion_along, scattered, tilted, wandering_path
from padstudio.simulate.radiance.lens import check_lens
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.radiance.sheet import check_lay
from padstudio.simulate.render import Frame, check_pose, render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.vibration import Vibration, shaking

FlightKind = Literal["descent", "hover", "landing", "gusty", "tilts"]
FLIGHT_KINDS: tuple[FlightKind, ...] = get_args(FlightKind)
#: Those that are one movement, usually written as a video.
VIDEO_KINDS: tuple[FlightKind, ...] = ("hover", "landing", "gusty")

# Eleven minutes of video at 30 frames a second; and 1 km of height.
MAX_FRAMES = 20_000
MAX_HEIGHT_MM = 1_000_000.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Setup:
    """What a flight's frames are taken of, and with.

    Attributes
    ----------
    scene : Scene
    camera : Camera
    imaging : Imaging
    seed : int
        Of the noise.
    """

    scene: Scene
    camera: Camera
    imaging: Imaging = field(default_factory=Imaging)
    seed: int = 0


@dataclass(frozen=True, eq=False)
class Flight:
    """Poses and motions of a flight's frames.

    Attributes
    ----------
    name : str
        Stem of the files' names.
    fps : float or None
        None for a series of stills that are not one movement.
    poses : tuple of Pose
    motions : tuple of Motion
        Velocities and vibrations at each pose.
    groups : tuple of str
        What each frame tests, for the score.
    """

    name: str
    fps: float | None
    poses: tuple[Pose, ...]
    motions: tuple[Motion, ...]
    groups: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.poses)

    def time_s(self, frame: int) -> float | None:
        """When a frame is taken, seconds from the first; None for stills."""
        return None if self.fps is None else frame / self.fps

    def frames(self, setup: Setup) -> Iterator[Frame]:
        """Render the frames in their order; raises as `padstudio.simulate.render.render`."""
        for index, (pose, motion) in enumerate(zip(self.poses, self.motions, strict=True)):
            sequence = np.random.SeedSequence([setup.seed, index])
            noise = int(sequence.generate_state(1, np.uint64)[0])
            yield render(setup.scene, setup.camera, pose, setup.imaging, noise, motion=motion)


@dataclass(frozen=True, kw_only=True)
class FlightSpec:
    """A flight to be planned.

    Attributes
    ----------
    kind : {"descent", "hover", "landing", "gusty", "tilts"}
        descent: stills from ``from_mm`` down to ``to_mm``, in even ratios, each with a heading and
        a place of its own. hover: a video at ``from_mm``. landing, gusty: a video from ``from_mm``
        down to ``to_mm``, calm or in gusts. tilts: stills at the distance ``from_mm`` with the axis
        0 … 70 degrees off straight down.
    frames : int
    from_mm, to_mm : float
        Heights, mm.
    fps : float
        Of the videos.
    seed : int
    sway : float
        Scales how much the camera wanders and leans.
    vibrations : tuple of Vibration
        Shake the camera throughout a video, with the phases that they have at its first frame;
        a still's phases are drawn for it alone.

    Raises
    ------
    SpecError
        If a figure is out of range.
    LimitError
        If more than `MAX_FRAMES` frames are asked for.
    """

    kind: FlightKind
    frames: int
    from_mm: float
    to_mm: float
    fps: float = 30.0
    seed: int = 0
    sway: float = 1.0
    vibrations: tuple[Vibration, ...] = ()

    def __post_init__(self) -> None:
        if self.kind not in FLIGHT_KINDS:
            raise SpecError(
                f"no flight {shown(self.kind)}; choose one of {', '.join(FLIGHT_KINDS)}"
            )
        if self.frames > MAX_FRAMES:
            raise LimitError(
                f"{self.frames} frames are asked for at once; the limit is {MAX_FRAMES}, split the "
                "flight",
                code="too_many_frames",
                detail={"frames": self.frames, "limit": MAX_FRAMES},
            )
        if self.frames < 1:
            raise SpecError(f"{self.frames} frames are asked for; ask for at least 1")
        for name, value in (("from_mm", self.from_mm), ("to_mm", self.to_mm)):
            if not 1.0 < value <= MAX_HEIGHT_MM:
                raise SpecError(
                    f"{name} is {value:g}; a height lies above 1 and at most {MAX_HEIGHT_MM:g} mm",
                    code="pose_below_ground" if value <= 1 else "invalid_spec",
                )
        if not 0.1 <= self.fps <= 1000:
            raise SpecError(f"fps is {self.fps}; it must lie within 0.1 … 1000")
        if not 0 <= self.sway <= 10:
            raise SpecError(f"sway is {self.sway}; it must lie within 0 … 10")


def plan(spec: FlightSpec) -> Flight:
    """The poses and motions of a flight; the same spec gives the same flight."""
    return shaken(_steady(spec), spec.vibrations, spec.seed)


def shaken(flight: Flight, vibrations: tuple[Vibration, ...], seed: int = 0) -> Flight:
    """A flight whose camera vibrates; its poses are those of the shaken camera.

    Parameters
    ----------
    flight : Flight
    vibrations : tuple of Vibration
        With their phases at a video's first frame, through which they go on.
    seed : int
        Of the phases of stills, each of which has its own.
    """
    if not vibrations:
        return flight
    rng = np.random.default_rng([seed, *b"vibration"])
    poses, motions = [], []
    for frame, (pose, motion) in enumerate(zip(flight.poses, flight.motions, strict=True)):
        time_s = flight.time_s(frame)
        # Stills are far apart in time: any two of them are as good as unrelated.
        moment = float(rng.uniform(0, 1000)) if time_s is None else time_s
        now = tuple(vibration.later(moment) for vibration in vibrations)
        poses.append(Pose(pose.position_mm, pose.rotation @ shaking(now, np.zeros(()))))
        motions.append(replace(motion, vibrations=now))
    return replace(flight, poses=tuple(poses), motions=tuple(motions))


def _steady(spec: FlightSpec) -> Flight:
    """The flight without vibrations."""
    kind, frames, from_mm, sway = spec.kind, spec.frames, spec.from_mm, spec.sway
    rng = np.random.default_rng([spec.seed, *kind.encode()])
    if kind == "descent":
        heights = np.geomspace(from_mm, spec.to_mm, frames)
        poses = [scattered(rng, float(h), sway) for h in heights]
        return _stills(kind, poses, ["descent"] * frames)
    if kind == "tilts":
        tilts = np.linspace(0.0, 70.0, frames)
        poses = [tilted(rng, from_mm, float(tilt)) for tilt in tilts]
        return _stills(kind, poses, [f"tilt{tilt:.0f}" for tilt in tilts])
    duration_s = max(frames - 1, 1) / spec.fps
    strength = {"hover": 0.5, "landing": 1.0, "gusty": 3.0}[kind] * sway
    end_mm = from_mm if kind == "hover" else spec.to_mm
    path = wandering_path(rng, from_mm, end_mm, duration_s, strength)
    times = np.arange(frames) / spec.fps
    return Flight(
        name=kind,
        fps=spec.fps,
        poses=tuple(path(float(t)) for t in times),
        motions=tuple(motion_along(path, float(t)) for t in times),
        groups=("flight",) * frames,
    )


def check_flight(flight: Flight, setup: Setup) -> None:
    """Refuse what cannot be rendered before anything is; raises as `render`."""
    camera, imaging = setup.camera, setup.imaging
    check_lens(camera)
    check_lay(setup.scene)
    for pose, motion in zip(flight.poses, flight.motions, strict=True):
        check_pose(camera, pose)
        # Of one row: all swing alike.
        exposure_ms, readout_ms = imaging.exposure_ms, imaging.readout_ms
        course(pose, motion, 1, exposure_ms=exposure_ms, readout_ms=readout_ms)


def _stills(name: str, poses: list[Pose], groups: list[str]) -> Flight:
    return Flight(name, None, tuple(poses), (Motion(),) * len(poses), tuple(groups))
