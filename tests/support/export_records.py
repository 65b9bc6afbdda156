"""Records of a short flight with known poses."""

from __future__ import annotations

from typing import Any

import numpy as np

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Reason, StageFailure

CAMERA = Camera(640, 480, np.array([[500.0, 0, 318], [0, 510, 242], [0, 0, 1]]))
PAD_SIZE_MM = (400.0, 300.0)
POSES = [
    look_at_pad(1200.0 - 200 * k, tilt_deg=3 * k, heading_deg=40 * k, target_mm=(10 * k, -5 * k))
    for k in range(5)
]
FAILED_AT = 2


def records() -> list[dict[str, Any]]:
    """Five poses at 10 frames a second, and a failed frame between them."""
    detections = [Detection(pose, layer="red", cells_read=90) for pose in POSES]
    failure = StageFailure("lines", Reason.NO_LATTICE, "3 lines", "go closer")
    detections.insert(FAILED_AT, Detection(None, failure))
    return [
        detection.to_record("a flight.mp4", frame=frame, time_s=frame / 10)
        for frame, detection in enumerate(detections)
    ]


def times() -> list[float]:
    """Times of the poses, s."""
    return [frame / 10 for frame in range(6) if frame != FAILED_AT]


def rotation(q_wxyz: Any) -> Any:
    """(3, 3) rotation of a quaternion, scalar first, from the sandwich product q v q*."""
    w, x, y, z = q_wxyz
    left = np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])
    right = np.array([[w, x, y, z], [-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]])
    return (left @ right)[1:, 1:]


def pad_in_camera_m(pose: Pose) -> Any:
    """The pad's centre in the camera frame, metres."""
    return pose.rotation.T @ -pose.position_mm / 1000
