"""Following a pad through a video: what the next frame should show.

The camera is expected to move on as it did between the last two frames, for as long as it is until
the next one. How far off that may be is learnt: accelerations stay as they were. A rolling shutter
reads the frame while that happens; how much of the time between two frames its reading takes is a
property of the camera, learnt from the frames in which the motion shows. Once known, it tells how
the pose changes within a frame, above all in height, which no single frame can tell from tilt.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.pose import Pose, rotation_from_vector
from padstudio.geometry.rolling_shutter import KnownMotion, MovingPose
from padstudio.vision.stage.detection import Detection

#: The unit of the tracker's time, s.
STEP_S = 1 / 30
# Chosen by the first 60 frames of both flights of the footage (mean position error 0.0830 % of the
# height); what halving or doubling changes is named.
# Of steps longer than this the motion within a frame is not known: gusts change it in between.
_STEADY = 1.5
# Accelerations last for so long.
_GUST = 4.0
# Of the acceleration that the frame before showed so much is still reckoned with.
_CALMER = 0.7
# Sums of the share's least squares are forgotten by this factor a frame.
_MEMORY = 0.98
# The share is used once it is known to about this, and after so many frames. Half: 0.0846, and
# 0.0811; double: the same, and 0.0926.
_KNOWN = 0.08
_LEAST_FRAMES = 4
# Natural logarithm of a shaking's odds from which a frame's motion is that of its shaking, which
# tells nothing of the motion between frames.
_SHAKEN = 5.0
# Points about the middle of the picture, in heights.
_AMID = 0.3 * np.array([[0, 0, 0], [1, 1, 0], [1, -1, 0], [-1, 1, 0], [-1, -1, 0]])
# A known change of height may be off by this share of the height.
_LEAST_CLIMB = 0.0001
# What is told of a pose is refused beyond these: mm, and off a rotation's orthogonality.
_FARTHEST, _MOST_SKEW = 1e8, 1e-6


@dataclass(frozen=True)
class Expectation:
    """What the next frame should show.

    Attributes
    ----------
    pose : MovingPose
    motion : KnownMotion or None
        Its change within the frame, where that is known rather than guessed at zero.
    miss : float
        By how much it may be off, as a share of the height or in radians, whichever is more: as
        much as the last one, where frames are evenly spaced.
    pad_id : str or None
        The pad that the pose is relative to.
    is_fresh : bool
        The frame just before has borne the pad out.
    """

    pose: MovingPose
    motion: KnownMotion | None = None
    miss: float = math.inf
    pad_id: str | None = None
    is_fresh: bool = True

    def to_dict(self) -> dict[str, Any]:
        """JSON-serialisable, and exact."""
        motion, moving = self.motion, self.pose
        return {
            "position_mm": moving.pose.position_mm.tolist(),
            "rotation": moving.pose.rotation.tolist(),
            "shift_mm": moving.shift_mm.tolist(),
            "rotvec": moving.rotvec.tolist(),
            "motion": None
            if motion is None
            else {
                "shift_mm": motion.shift_mm.tolist(),
                "rotvec": motion.rotvec.tolist(),
                "climb_sigma_mm": motion.climb_sigma_mm,
            },
            "miss": self.miss if math.isfinite(self.miss) else None,
            "pad_id": self.pad_id,
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Expectation:
        """From what `to_dict` gives.

        Raises
        ------
        ValueError, KeyError, TypeError
            If it is of another shape.
        """
        motion, miss, pad_id = values["motion"], values["miss"], values["pad_id"]
        rotation = _figures(values["rotation"], 3, 3)
        if np.abs(rotation @ rotation.T - np.eye(3)).max() > _MOST_SKEW:
            raise ValueError("a rotation that is none")
        pose = Pose(_figures(values["position_mm"], 3), rotation)
        moving = MovingPose(pose, *(_figures(values[name], 3) for name in ("shift_mm", "rotvec")))
        known = None
        if motion is not None:
            shift, turn = (_figures(motion[name], 3) for name in ("shift_mm", "rotvec"))
            known = KnownMotion(shift, turn, float(motion["climb_sigma_mm"]))
        if pad_id is not None and not isinstance(pad_id, str):
            raise ValueError("a pad's identity that is no text")
        return cls(moving, known, math.inf if miss is None else float(miss), pad_id)


def _figures(value: Any, *shape: int) -> Array:
    found = np.array(value, float)
    if found.shape != shape or not np.abs(found).max() < _FARTHEST:
        raise ValueError(f"{len(shape)}-dimensional figures that are none")
    return found


@dataclass(frozen=True, eq=False)
class _Past:
    """A frame with a pose."""

    time: float
    pose: Pose


class Tracker:
    """Learns from detections, frame by frame.

    Times are in units of `STEP_S`; frames of which none is told are one unit apart.

    Parameters
    ----------
    longest_gap : float
        A pad that was lost for so long at the most is still expected; at 0 it is expected right
        after a frame that shows it, whatever its time.
    """

    def __init__(self, longest_gap: float = 0.0) -> None:
        self._longest_gap = longest_gap
        self._time = 0.0
        self._is_lost = False
        self._past: list[_Past] = []
        self._pad_id: str | None = None
        self._expected: Expectation | None = None
        self._wobble = math.inf
        self._weight = self._product = self._misfit = 0.0
        self._frames = 0
        self._shaken = False

    def expect(self, time: float | None = None) -> Expectation | None:
        """The next frame's pose, or None where nothing leads there.

        Parameters
        ----------
        time : float, optional
            Of the next frame.
        """
        self._expected = self._expect(self._time + 1.0 if time is None else time)
        return self._expected

    def _expect(self, time: float) -> Expectation | None:
        if not self._past:
            return None
        last, fresh = self._past[-1], not self._is_lost
        ahead = time - last.time
        if self._longest_gap and not 0 < ahead <= self._longest_gap:
            return None
        if len(self._past) < 2:
            return Expectation(MovingPose(last.pose), pad_id=self._pad_id, is_fresh=fresh)
        before = self._past[-2]
        since = last.time - before.time
        step = before.pose.step_to(last.pose) * (ahead / since)
        speed = step / ahead
        if self._longest_gap:
            step = step + self._gained(speed, ahead)
        pose = Pose(
            last.pose.position_mm + step[:3], last.pose.rotation @ rotation_from_vector(step[3:])
        )
        miss = self._wobble * ahead * (ahead + since) / 2
        if self._longest_gap and since > _GUST:
            # A step over a gap tells its mean speed, not that of now.
            miss = math.inf
        share = self._share()
        if share is None or max(ahead, since) > _STEADY:
            return Expectation(MovingPose(pose), None, miss, self._pad_id, fresh)
        climb_sigma = self._climb_sigma(share, speed[:3], time)
        motion = KnownMotion(share * speed[:3], share * speed[3:], climb_sigma)
        moving = MovingPose(pose, motion.shift_mm, motion.rotvec)
        return Expectation(moving, motion, miss, self._pad_id, fresh)

    def _gained(self, speed: Array, ahead: float) -> Array:
        """What a gust adds to an even step, (6,), where it is short: accelerations last a while.

        As a turn that moves the picture as much: where the camera stands aside is hardly known
        from frame to frame, and differences of differences would make much of that.
        """
        if len(self._past) < 3 or ahead > _GUST:
            return np.zeros(6)
        first, second, last = self._past
        earlier, since = second.time - first.time, last.time - second.time
        if max(earlier, since) > _GUST:
            return np.zeros(6)
        gain = (speed - first.pose.step_to(second.pose) / earlier) / ((earlier + since) / 2)
        gained = gain * ahead * (ahead + since) / 2
        x, y = _apparent(last.pose, gained[:3], gained[3:])
        return np.array([0.0, 0.0, 0.0, y, -x, 0.0])

    def _climb_sigma(self, share: float, speed: Array, time: float) -> float:
        """How far the change of height in a frame may be off, mm.

        The share is not known exactly, and the climb may go on changing as it did.
        """
        change = 0.0
        if len(self._past) > 2:
            first, second, last = self._past
            before = (second.pose.position_mm - first.pose.position_mm)[2]
            before = before / (second.time - first.time)
            # Speeds are those amid the steps.
            later = time - (second.time + last.time) / 2
            change = later / ((last.time - first.time) / 2) * share * (speed[2] - before)
        floor = _LEAST_CLIMB * float(self._past[-1].pose.position_mm[2])
        return float(np.linalg.norm((_KNOWN / 2 * speed[2], change, floor)))

    def learn(self, detection: Detection, time: float | None = None) -> None:
        """Take a frame's detection into account.

        Parameters
        ----------
        detection : Detection
        time : float, optional
            Of the frame, as told to `expect`.
        """
        self._time = self._time + 1.0 if time is None else time
        if detection.pose is None:
            self._is_lost = True
            if not self._longest_gap:
                self._past, self._wobble = [], math.inf
            return
        self._is_lost = False
        if detection.pad_id != self._pad_id:
            # Its pose is in another frame.
            self._past, self._expected, self._pad_id = [], None, detection.pad_id
        longest = self._longest_gap or math.inf
        if self._past and not 0 < self._time - self._past[-1].time <= longest:
            self._past, self._expected = [], None
        before, self._wobble = self._wobble, self._off(detection.pose)
        if self._longest_gap and math.isfinite(before):
            # One frame that came as expected does not end a gust.
            self._wobble = max(self._wobble, _CALMER * before)
        self._shaken = detection.shaking > _SHAKEN
        shift, turn = detection.shift_mm, detection.turn_rad
        if self._past and not self._shaken and shift is not None and turn is not None:
            self._compare(detection.pose, shift, turn)
        self._past = [*self._past[-2:], _Past(self._time, detection.pose)]

    def _off(self, pose: Pose) -> float:
        """What was expected wrongly, as an acceleration; infinite where nothing was expected."""
        if self._expected is None:
            return math.inf
        if self._longest_gap and len(self._past) < 2:
            # Only a camera at rest was expected so.
            return math.inf
        expected = self._expected.pose
        miss = picture_miss(expected.pose, pose)
        if not self._longest_gap:
            miss = expected.apart_px(MovingPose(pose), focal_px=1.0)
        ahead = self._time - self._past[-1].time
        since = self._past[-1].time - self._past[-2].time if len(self._past) > 1 else ahead
        # A long step before tells of its mean alone, in which gusts cancel.
        return 2 * miss / (ahead * (ahead + min(since, ahead)))

    def _compare(self, pose: Pose, shift_mm: Array, turn_rad: Array) -> None:
        """Least squares for the share: motion within the frame over motion in a unit of time."""
        ahead = self._time - self._past[-1].time
        if ahead > _STEADY:
            return
        step = self._past[-1].pose.step_to(pose) / ahead
        between = _apparent(pose, step[:3], step[3:])
        within = _apparent(pose, shift_mm, turn_rad)
        self._weight = _MEMORY * self._weight + float(between @ between)
        self._product = _MEMORY * self._product + float(between @ within)
        self._misfit = _MEMORY * self._misfit + float(within @ within)
        self._frames += 1

    def _share(self) -> float | None:
        if self._shaken or self._frames < _LEAST_FRAMES or self._weight <= 0:
            return None
        share = self._product / self._weight
        left = max(self._misfit - share * self._product, 0.0)
        spread = np.sqrt(left / self._weight / max(min(self._frames, 50) - 1, 1))
        return float(np.clip(share, 0.0, 1.0)) if spread < _KNOWN else None


def picture_miss(expected: Pose, pose: Pose) -> float:
    """By how much a picture differs from the expected one, on the plane z = 1.

    The most that points of the pad's plane amid the picture move; shifts and turns that cancel out
    there count little.
    """
    forward = pose.rotation[:, 2]
    height = float(pose.position_mm[2])
    amid = pose.position_mm + forward * (height / max(-forward[2], 0.1))
    points = amid + height * _AMID
    points[:, 2] = 0.0
    there, here = expected.to_camera(points), pose.to_camera(points)
    if there[:, 2].min() <= 0 or here[:, 2].min() <= 0:
        return math.inf
    moved = there[:, :2] / there[:, 2:] - here[:, :2] / here[:, 2:]
    return float(np.abs(moved).max())


def _apparent(pose: Pose, shift_mm: Array, rotvec: Array) -> Array:
    """Shift on the plane z = 1 of what lies amid the picture, (2,), for a change of pose.

    Sideways motion and turns look alike there, and their sum is what a frame shows best.
    """
    depth = -pose.position_mm[2] / min(pose.rotation[2, 2], -1e-3)
    across, along, _ = (shift_mm @ pose.rotation / depth).tolist()
    about_x, about_y, _ = rotvec.tolist()
    return np.array([-across - about_y, about_x - along])
