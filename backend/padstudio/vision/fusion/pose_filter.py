"""Fuses the poses of a video's frames as they come.

An error-state extended Kalman filter on SO(3) × R³ at constant velocity and turn rate, both of
which white noise changes. A frame is taken for what it says best: where the pad's centre lies in
the camera's frame, and the attitude, which from afar may be hardly known. Two things keep it from
promising too much. Part of a frame's error lasts from frame to frame (a first-order Gauss–Markov
process in units of the frame's own covariance), so that a hundred frames are not ten times as sure
as one. And the camera shakes: the attitude that a fused pose states is that at the frame's own
moment, the steady one with this frame's shaking; the filter takes it from the frame as far as the
frame knows it, and smooths only what the frame does not know.

References
----------
Solà, J. (2017). Quaternion kinematics for the error-state Kalman filter. arXiv:1711.02508.
Bar-Shalom, Y., Li, X. R. and Kirubarajan, T. (2001). Estimation with applications to tracking and
navigation, chapters 6.2 (white noise acceleration) and 8.2 (autocorrelated measurement noise).
doi:10.1002/0471221279. Lange, K. L., Little, R. J. A. and Taylor, J. M. G. (1989). Robust
statistical modeling using the t distribution. doi:10.1080/01621459.1989.10478852.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.curvature import with_curvature, without_curvature
from padstudio.geometry.pose import Pose
from padstudio.vision.fusion import kernel
from padstudio.vision.fusion.kernel import Track
from padstudio.vision.fusion.motion import MotionModel

# Squared Mahalanobis distances of six degrees of freedom: beyond the first (one frame in twenty)
# a frame counts less, as Student's t of so many degrees of freedom has it; beyond the second (one
# in a million) not at all.
_DOUBTED, _FREEDOM, _REFUSED = 12.6, 8.0, 38.3
#: So many frames in a row that agree with each other, and not with the filter, are right.
REBELS = 3
# Velocities are known no more after a longer gap.
_LONGEST_GAP_S = 2.0
_FIELDS = ("centre", "rotation", "velocity", "rate", "lasting", "covariance")


@dataclass(frozen=True, eq=False)
class Measurement:
    """The pose of a single frame.

    Attributes
    ----------
    time_s : float
    pose : Pose
    covariance : (6, 6) float64
        As of `padstudio.vision.stage.detection.Uncertainty`.
    """

    time_s: float
    pose: Pose
    covariance: Array

    @property
    def is_usable(self) -> bool:
        """False where it holds what no filter can reckon with."""
        spread = np.diag(self.covariance)
        numbers = (self.pose.position_mm, self.pose.rotation, self.covariance)
        return bool(all(np.isfinite(part).all() for part in numbers) and (spread > 0).all())

    @property
    def seen(self) -> tuple[Array, Array, Array]:
        """The pad's centre in the camera frame, the attitude, and the covariance of both."""
        by_pose = seen_by_pose(self.pose)
        rotation = np.ascontiguousarray(self.pose.rotation, float)
        first = without_curvature(self.covariance, self.pose)
        return self.pose.tvec_mm, rotation, by_pose @ first @ by_pose.T


def seen_by_pose(pose: Pose) -> Array:
    """Derivatives (6, 6) of the pad's centre in the camera frame and the attitude by the pose."""
    out = np.eye(6)
    x, y, z = pose.tvec_mm
    out[:3, :3] = -pose.rotation.T
    out[:3, 3:] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    return out


@dataclass(frozen=True, eq=False)
class Fused:
    """A frame's pose as all frames up to it, or about it, have it.

    Attributes
    ----------
    pose : Pose
    covariance : (6, 6) float64
    is_outlier : bool
        The frame's own pose was not believed, and does not count.
    """

    pose: Pose
    covariance: Array
    is_outlier: bool = False


@dataclass(frozen=True, eq=False)
class Link:
    """What the smoother keeps of a frame.

    Attributes
    ----------
    track : Track
        With the frame.
    shake : (3,) float64
    joint : (21, 21) float64
        Covariance of both.
    step : (18, 18) float64
        Transition from the frame before.
    ahead : Track or None
        The state predicted from the frame before; None where the filter began with this one.
    is_outlier : bool
    """

    track: Track
    shake: Array
    joint: Array
    step: Array
    ahead: Track | None
    is_outlier: bool = False

    @property
    def fused(self) -> Fused:
        """The frame's pose."""
        centre, rotation, seen = kernel.shaken(self.track, self.shake, self.joint)
        pose = Pose.from_T_camera_pad(rotation.T, centre)
        by_seen = np.linalg.inv(seen_by_pose(pose))
        covariance = with_curvature(by_seen @ seen @ by_seen.T, pose)
        return Fused(pose, covariance, self.is_outlier)


@dataclass(frozen=True, eq=False)
class FilterState:
    """All that a filter carries from one frame to the next.

    Attributes
    ----------
    time_s : float
    track : Track
    frames : int
        That count in it.
    rival : FilterState or None
        What the last frames say, which this one does not believe.
    """

    time_s: float
    track: Track
    frames: int
    rival: FilterState | None = None

    def to_record(self) -> dict[str, Any]:
        """JSON-serialisable; `from_record` gives the very same state."""
        track = {name: getattr(self.track, name).tolist() for name in _FIELDS}
        rival = None if self.rival is None else self.rival.to_record()
        return {"time_s": self.time_s, "frames": self.frames, **track, "rival": rival}

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> FilterState:
        """Inverse of `to_record`."""
        track = Track(*(np.array(record[name], float) for name in _FIELDS))
        rival = record["rival"]
        return cls(
            record["time_s"],
            track,
            record["frames"],
            None if rival is None else cls.from_record(rival),
        )


@dataclass
class PoseFilter:
    """Takes frames in the order of time.

    Attributes
    ----------
    model : MotionModel
    state : FilterState or None
        That after the last frame; give it to another filter to go on.
    revised : tuple of Link
        Where the last frame brought others round: what the frames just before it, outliers until
        then, amount to.
    """

    model: MotionModel = field(default_factory=MotionModel)
    state: FilterState | None = None
    revised: tuple[Link, ...] = ()

    def __post_init__(self) -> None:
        self._noise, self._fastest = self.model.noise, self.model.fastest
        self._rivals: list[Link] = []

    def step(self, frame: Measurement) -> Fused:
        """The pose of a frame, as those before it have it, too."""
        return self.link(frame).fused

    def link(self, frame: Measurement) -> Link:
        """As `step`, with what the smoother needs."""
        self.revised = ()
        state = self.state
        if state is None or not 0 < frame.time_s - state.time_s <= _LONGEST_GAP_S:
            return self._begin(frame)
        link = self._follow(state, frame)
        if link is not None:
            self.state = FilterState(frame.time_s, link.track, state.frames + 1)
            self._rivals = []
            return link
        if state.frames < REBELS:
            # Neither is surer than the other; each says what it saw.
            return self._begin(frame)
        return self._rebel(state, frame)

    def predicted(self, time_s: float) -> Pose | None:
        """Where the camera should be at a time; None where nothing is known."""
        state = self.state
        if state is None or not 0 < time_s - state.time_s <= _LONGEST_GAP_S:
            return None
        ahead, _ = kernel.moved(state.track, time_s - state.time_s, self._noise)
        return Pose.from_T_camera_pad(ahead.rotation.T, ahead.centre)

    def _begin(self, frame: Measurement) -> Link:
        track, link = self._first(frame)
        self.state, self._rivals = FilterState(frame.time_s, track, 1), []
        return link

    def _first(self, frame: Measurement) -> tuple[Track, Link]:
        track, joint = kernel.begun(*frame.seen, self._fastest, self._noise)
        return track, Link(track, np.zeros(3), joint, np.eye(kernel.STATE), None)

    def _follow(self, state: FilterState, frame: Measurement) -> Link | None:
        """The frame added to a state, or None where it does not fit."""
        ahead, step = kernel.moved(state.track, frame.time_s - state.time_s, self._noise)
        seen = frame.seen
        sight = kernel.sighted(ahead, *seen, self._noise, 1.0)
        if not sight.distance <= _REFUSED:
            return None
        if sight.distance > _DOUBTED:
            doubt = (_FREEDOM + sight.distance) / (_FREEDOM + 6)
            sight = kernel.sighted(ahead, *seen, self._noise, doubt)
        return Link(*kernel.corrected(ahead, sight), step, ahead)

    def _rebel(self, state: FilterState, frame: Measurement) -> Link:
        """A frame that does not fit, beside others that did not."""
        link = None if state.rival is None else self._follow(state.rival, frame)
        if link is None or state.rival is None:
            track, link = self._first(frame)
            rival, self._rivals = FilterState(frame.time_s, track, 1), [link]
        else:
            rival = FilterState(frame.time_s, link.track, state.rival.frames + 1)
            self._rivals.append(link)
        if rival.frames >= REBELS:
            self.state, self.revised, self._rivals = rival, tuple(self._rivals[:-1]), []
            return link
        ahead, step = kernel.moved(state.track, frame.time_s - state.time_s, self._noise)
        joint = np.zeros((kernel.STATE + kernel.SHAKE,) * 2)
        joint[: kernel.STATE, : kernel.STATE] = ahead.covariance
        joint[kernel.STATE :, kernel.STATE :] = self._noise.shake * np.eye(3)
        self.state = replace(state, time_s=frame.time_s, track=ahead, rival=rival)
        return Link(ahead, np.zeros(3), joint, step, ahead, is_outlier=True)
