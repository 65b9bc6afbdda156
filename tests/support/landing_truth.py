"""A landing whose every transform is known, put together by 4 x 4 matrices."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from padstudio.geometry.pose import Pose
from padstudio.live.reports.frame import LiveFrame
from padstudio.live.reports.report import LiveReport
from padstudio.vision.stage.detection import Detection, Uncertainty
from padstudio.vision.stage.trace import Reason, StageFailure

PICTURE = np.zeros((2, 2, 3), np.uint8)


def turn(vector: Any) -> Any:
    """A rotation (3, 3) about a vector, radians."""
    return cv2.Rodrigues(np.asarray(vector, float))[0]


def transform(rotation: Any, position: Any) -> Any:
    """(4, 4)."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation, position
    return T


class LandingTruth:
    """A vehicle that sways while it comes down over a pad.

    Metres; local is north, east, down. The camera looks down with the top of its picture at
    ``turned_deg`` from forward, leans by ``lean_rad`` about the body's y, and sits off the centre.
    """

    def __init__(self, turned_deg: float = 0.0, lean_rad: float = 0.0, offset: Any = (0, 0, 0)):
        down = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
        heading = turn([0, 0, np.radians(turned_deg)])
        self.T_body_camera = transform(turn([0, lean_rad, 0]) @ heading @ down, offset)
        # The page lies level, its top to the north-east; its Z is up.
        c = np.sqrt(0.5)
        self.T_local_pad = transform([[-c, c, 0], [c, c, 0], [0, 0, -1]], [12.0, -7.0, 1.5])

    def T_local_body(self, time_s: float) -> Any:
        position = [12 + np.sin(time_s), -7 + 0.7 * np.cos(0.8 * time_s), -4 + np.sin(0.5 * time_s)]
        lean = [0.1 * np.sin(1.3 * time_s), 0.08 * np.cos(time_s), 0.0]
        return transform(turn([0, 0, 0.3 * time_s]) @ turn(lean), position)

    def pose(self, time_s: float) -> Pose:
        """Of the camera in the pad frame."""
        T = np.linalg.inv(self.T_local_pad) @ self.T_local_body(time_s) @ self.T_body_camera
        return Pose(T[:3, 3] * 1000, T[:3, :3])

    def pad_in_body(self, time_s: float) -> Any:
        """(4, 4), the pad with x up the page, y right, z into it."""
        return np.linalg.inv(self.T_local_body(time_s)) @ self.T_local_target

    @property
    def T_local_target(self) -> Any:
        """(4, 4), the same in the local frame."""
        page = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]])
        return self.T_local_pad @ transform(page, [0, 0, 0])


def report(
    pose: Pose | None,
    taken_s: float,
    *,
    number: int = 0,
    sigma_mm: float = 1.0,
    sigma_deg: float = 0.1,
) -> LiveReport:
    """Of a frame that was taken, decoded and read at once."""
    frame = LiveFrame(number, PICTURE, taken_s, taken_s, taken_s)
    if pose is None:
        failure = StageFailure("search", Reason.NO_PAD, "nothing has the pad's colours")
        return LiveReport(frame, Detection(None, failure), taken_s)
    covariance = np.diag([sigma_mm**2] * 3 + [np.radians(sigma_deg) ** 2] * 3)
    sigma = Uncertainty.of(pose, covariance)
    return LiveReport(frame, Detection(pose, uncertainty=sigma, layer="red"), taken_s)
