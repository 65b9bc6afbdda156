"""Following a pad through a video: what the next frame should show.

The camera is expected to move on as it did between the last two frames. A rolling shutter reads
the frame while that happens; how much of the time between two frames its reading takes is a
property of the camera, learnt from the frames in which the motion shows. Once known, it tells how
the pose changes within a frame, above all in height, which no single frame can tell from tilt.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

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
# A known change of height may be off by this share of the height.
_LEAST_CLIMB = 0.0001


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
    """

    pose: MovingPose
    motion: KnownMotion | None = None
    miss: float = math.inf


class Tracker:
    """Learns from detections, frame by frame."""

    def __init__(self) -> None:
        self._past: list[Pose] = []
        self._expected: Expectation | None = None
        self._miss = math.inf
        self._weight = self._product = self._misfit = 0.0
        self._frames = 0

    def expect(self) -> Expectation | None:
        """The next frame's pose, or None after a frame without one."""
        self._expected = self._expect()
        return self._expected

    def _expect(self) -> Expectation | None:
        if not self._past:
            return None
        last = self._past[-1]
        if len(self._past) < 2:
            return Expectation(MovingPose(last))
        step = self._past[-2].step_to(last)
        shift, rotvec = step[:3], step[3:]
        pose = Pose(last.position_mm + shift, last.rotation @ rotation_from_vector(rotvec))
        share = self._share()
        if share is None:
            return Expectation(MovingPose(pose), miss=self._miss)
        motion = KnownMotion(share * shift, share * rotvec, self._climb_sigma(share, shift))
        return Expectation(MovingPose(pose, motion.shift_mm, motion.rotvec), motion, self._miss)

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
        if self._expected is not None:
            self._miss = self._expected.pose.apart_px(MovingPose(detection.pose), focal_px=1.0)
        if self._past and detection.shift_mm is not None and detection.turn_rad is not None:
            self._compare(detection.pose, detection.shift_mm, detection.turn_rad)
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
        if self._frames < _LEAST_FRAMES or self._weight <= 0:
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
