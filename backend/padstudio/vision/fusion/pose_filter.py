"""Fuses the poses of a video's frames as they come.

An error-state extended Kalman filter on SO(3) × R³ at constant velocity and turn rate, both of
which white noise changes. A frame is taken for what it says best: where the pad's centre lies in
the camera's frame, and the attitude, which from afar may be hardly known. Two things keep it from
promising too much. Part of a frame's error lasts from frame to frame (a first-order Gauss–Markov
process in units of the frame's own covariance), so that a hundred frames are not ten times as sure
as one. And the camera shakes: the attitude that a fused pose states is that at the frame's own
moment, the steady one with this frame's shaking; the filter takes it from the frame as far as the
frame knows it, and smooths only what the frame does not know. How much the camera shakes, and how
much less frames know their attitude than they say, is learnt from the innovations.

References
----------
Solà, J. (2017). Quaternion kinematics for the error-state Kalman filter. arXiv:1711.02508.
Bar-Shalom, Y., Li, X. R. and Kirubarajan, T. (2001). Estimation with applications to tracking and
navigation, chapters 6.2 (white noise acceleration) and 8.2 (autocorrelated measurement noise).
doi:10.1002/0471221279. Mehra, R. K. (1970). On the identification of variances and adaptive Kalman
filtering. doi:10.1109/TAC.1970.1099422. Lange, K. L., Little, R. J. A. and Taylor, J. M. G. (1989).
Robust statistical modeling using the t distribution. doi:10.1080/01621459.1989.10478852.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.curvature import with_curvature
from padstudio.geometry.pose import Pose
from padstudio.vision.fusion import kernel
from padstudio.vision.fusion.kernel import Noise, Track
from padstudio.vision.fusion.measurement import Fused, Measurement, pose_by_seen
from padstudio.vision.fusion.motion import MotionModel

# Squared Mahalanobis distances of six degrees of freedom: beyond the first (one frame in twenty)
# a frame counts less, as Student's t of so many degrees of freedom has it; beyond the second (one
# in a million) not at all.
_DOUBTED, _FREEDOM, _REFUSED = 12.6, 8.0, 38.3
#: So many frames in a row that agree with each other, and not with the filter, are right.
REBELS = 3
# Velocities are known no more after a longer gap.
_LONGEST_GAP_S = 2.0
# What frames say again and again tells how much the camera shakes, by where they see the pad's
# centre, and, by how their attitudes differ beyond that, how much less they know them than they
# say. In logarithms both variances change by so much for each unit that squared innovations (of
# three degrees of freedom) are above or below what three of ten true ones exceed; neither falls
# below what is taken for granted, so that a filter that is right learns nothing.
_LEARNING, _USUAL, _MOST_LEARNT = 0.3, 3.7, 2.0
_FIELDS = ("centre", "rotation", "velocity", "rate", "lasting", "covariance")


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
        by_seen = pose_by_seen(pose)
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
    doubt : (2,) float64
        By how much the variances of the camera's shaking and of the frames' attitudes are larger
        than taken for granted.
    rival : FilterState or None
        What the last frames say, which this one does not believe.
    """

    time_s: float
    track: Track
    frames: int
    doubt: Array
    rival: FilterState | None = None

    def to_record(self) -> dict[str, Any]:
        """JSON-serialisable; `from_record` gives the very same state."""
        track = {name: getattr(self.track, name).tolist() for name in _FIELDS}
        rival = None if self.rival is None else self.rival.to_record()
        told = {"time_s": self.time_s, "frames": self.frames, "doubt": self.doubt.tolist()}
        return told | track | {"rival": rival}

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> FilterState:
        """Inverse of `to_record`."""
        track = Track(*(np.array(record[name], float) for name in _FIELDS))
        rival = record["rival"]
        return cls(
            record["time_s"],
            track,
            record["frames"],
            np.array(record["doubt"], float),
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
            return self._begin(frame, np.ones(2) if state is None else state.doubt)
        link, doubt = self._follow(state, frame, state.doubt)
        if link is not None:
            self.state = FilterState(frame.time_s, link.track, state.frames + 1, doubt)
            self._rivals = []
            return link
        if state.frames < REBELS:
            # Neither is surer than the other; each says what it saw.
            return self._begin(frame, doubt)
        return self._rebel(state, frame, doubt)

    def predicted(self, time_s: float) -> Pose | None:
        """Where the camera should be at a time; None where nothing is known."""
        state = self.state
        if state is None or not 0 < time_s - state.time_s <= _LONGEST_GAP_S:
            return None
        ahead, _ = kernel.moved(state.track, time_s - state.time_s, self._noise)
        return Pose.from_T_camera_pad(ahead.rotation.T, ahead.centre)

    def _begin(self, frame: Measurement, doubt: Array) -> Link:
        link = self._first(frame, doubt)
        self.state, self._rivals = FilterState(frame.time_s, link.track, 1, doubt), []
        return link

    def _first(self, frame: Measurement, doubt: Array) -> Link:
        track, joint = kernel.begun(*_doubted(frame, doubt), self._fastest, self._shaking(doubt))
        return Link(track, np.zeros(3), joint, np.eye(kernel.STATE), None)

    def _follow(
        self, state: FilterState, frame: Measurement, doubt: Array
    ) -> tuple[Link | None, Array]:
        """The frame added to a state, or None where it does not fit; and the doubt thereafter."""
        ahead, step = kernel.moved(state.track, frame.time_s - state.time_s, self._noise)
        seen, noise = _doubted(frame, doubt), self._shaking(doubt)
        sight = kernel.sighted(ahead, *seen, noise, 1.0)
        halves = np.array([sight.centre_distance, sight.distance - sight.centre_distance])
        off = np.clip(np.log(np.maximum(halves, 1e-6) / _USUAL), -_MOST_LEARNT, _MOST_LEARNT)
        doubt = np.maximum(doubt * np.exp(_LEARNING * off), 1.0)
        if not sight.distance <= _REFUSED:
            return None, doubt
        if sight.distance > _DOUBTED:
            more = (_FREEDOM + sight.distance) / (_FREEDOM + 6)
            sight = kernel.sighted(ahead, *seen, noise, more)
        return Link(*kernel.corrected(ahead, sight), step, ahead), doubt

    def _rebel(self, state: FilterState, frame: Measurement, doubt: Array) -> Link:
        """A frame that does not fit, beside others that did not."""
        link = None
        if state.rival is not None:
            link, _ = self._follow(state.rival, frame, doubt)
        if link is None or state.rival is None:
            link = self._first(frame, doubt)
            rival, self._rivals = FilterState(frame.time_s, link.track, 1, doubt), [link]
        else:
            frames = state.rival.frames + 1
            rival = FilterState(frame.time_s, link.track, frames, doubt)
            self._rivals.append(link)
        if rival.frames >= REBELS:
            self.state, self.revised, self._rivals = rival, tuple(self._rivals[:-1]), []
            return link
        ahead, step = kernel.moved(state.track, frame.time_s - state.time_s, self._noise)
        joint = np.zeros((kernel.STATE + kernel.SHAKE,) * 2)
        joint[: kernel.STATE, : kernel.STATE] = ahead.covariance
        joint[kernel.STATE :, kernel.STATE :] = self._shaking(doubt).shake * np.eye(3)
        self.state = replace(state, time_s=frame.time_s, track=ahead, doubt=doubt, rival=rival)
        return Link(ahead, np.zeros(3), joint, step, ahead, is_outlier=True)

    def _shaking(self, doubt: Array) -> Noise:
        return self._noise._replace(shake=float(doubt[0]) * self._noise.shake)


def _doubted(frame: Measurement, doubt: Array) -> tuple[Array, Array, Array]:
    """What a frame saw, as unsure as it is."""
    centre, rotation, covariance = frame.seen
    out, scale = covariance.copy(), float(np.sqrt(doubt[1]))
    out[3:] *= scale
    out[:, 3:] *= scale
    return centre, rotation, out
