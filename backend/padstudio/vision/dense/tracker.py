"""Following a pad through a video: what the next frame should show.

The camera is expected to move on as it did between the last two frames. A rolling shutter reads
the frame while that happens; how much of the time between two frames its reading takes is a
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

# Chosen by the first 60 frames of both flights of the footage (mean position error 0.0830 % of the
# height); what halving or doubling changes is named.
# Sums of the share's least squares are forgotten by this factor a frame.
_MEMORY = 0.98
# The share is used once it is known to about this, and after so many frames. Half: 0.0846, and
# 0.0811; double: the same, and 0.0926.
_KNOWN = 0.08
_LEAST_FRAMES = 4
# Natural logarithm of a shaking's odds from which a frame's motion is that of its shaking, which
# tells nothing of the motion between frames.
_SHAKEN = 5.0
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
        By how much the last frame's expectation was off, as a share of the height or in radians,
        whichever is more.
    pad_id : str or None
        The pad that the pose is relative to.
    """

    pose: MovingPose
    motion: KnownMotion | None = None
    miss: float = math.inf
    pad_id: str | None = None

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


class Tracker:
    """Learns from detections, frame by frame."""

    def __init__(self) -> None:
        self._past: list[Pose] = []
        self._pad_id: str | None = None
        self._expected: Expectation | None = None
        self._miss = math.inf
        self._weight = self._product = self._misfit = 0.0
        self._frames = 0
        self._shaken = False

    def expect(self) -> Expectation | None:
        """The next frame's pose, or None after a frame without one."""
        self._expected = self._expect()
        return self._expected

    def _expect(self) -> Expectation | None:
        if not self._past:
            return None
        last = self._past[-1]
        if len(self._past) < 2:
            return Expectation(MovingPose(last), pad_id=self._pad_id)
        step = self._past[-2].step_to(last)
        shift, rotvec = step[:3], step[3:]
        pose = Pose(last.position_mm + shift, last.rotation @ rotation_from_vector(rotvec))
        share = self._share()
        if share is None:
            return Expectation(MovingPose(pose), None, self._miss, self._pad_id)
        motion = KnownMotion(share * shift, share * rotvec, self._climb_sigma(share, shift))
        moving = MovingPose(pose, motion.shift_mm, motion.rotvec)
        return Expectation(moving, motion, self._miss, self._pad_id)

    def _climb_sigma(self, share: float, shift: Array) -> float:
        """How far the change of height in a frame may be off, mm.

        The share is not known exactly, and the climb may go on changing as it did.
        """
        before = shift
        if len(self._past) > 2:
            before = self._past[1].position_mm - self._past[0].position_mm
        floor = _LEAST_CLIMB * float(self._past[-1].position_mm[2])
        parts = (_KNOWN / 2 * shift[2], 1.5 * share * (shift[2] - before[2]), floor)
        return float(np.linalg.norm(parts))

    def learn(self, detection: Detection) -> None:
        """Take a frame's detection into account."""
        self._miss = math.inf
        if detection.pose is None:
            self._past = []
            return
        if detection.pad_id != self._pad_id:
            # Its pose is in another frame.
            self._past, self._expected, self._pad_id = [], None, detection.pad_id
        if self._expected is not None:
            self._miss = self._expected.pose.apart_px(MovingPose(detection.pose), focal_px=1.0)
        self._shaken = detection.shaking > _SHAKEN
        shift, turn = detection.shift_mm, detection.turn_rad
        if self._past and not self._shaken and shift is not None and turn is not None:
            self._compare(detection.pose, shift, turn)
        self._past = [*self._past[-2:], detection.pose]

    def _compare(self, pose: Pose, shift_mm: Array, turn_rad: Array) -> None:
        """Least squares for the share: motion within the frame over motion between frames."""
        step = self._past[-1].step_to(pose)
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


def _apparent(pose: Pose, shift_mm: Array, rotvec: Array) -> Array:
    """Shift on the plane z = 1 of what lies amid the picture, (2,), for a change of pose.

    Sideways motion and turns look alike there, and their sum is what a frame shows best.
    """
    forward = pose.rotation[:, 2]
    depth = -pose.position_mm[2] / min(forward[2], -1e-3)
    sideways = pose.rotation.T @ shift_mm / depth
    return np.array([-sideways[0] - rotvec[1], -sideways[1] + rotvec[0]])
