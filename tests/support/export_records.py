"""Records of a short flight with known poses."""

from __future__ import annotations

from typing import Any

import numpy as np

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.vision.stage.detection import Detection, Uncertainty
from padstudio.vision.stage.trace import Reason, StageFailure

CAMERA = Camera(640, 480, np.array([[500.0, 0, 318], [0, 510, 242], [0, 0, 1]]))
PAD_SIZE_MM = (400.0, 300.0)
POSES = [
    look_at_pad(1200.0 - 200 * k, tilt_deg=3 * k, heading_deg=40 * k, target_mm=(10 * k, -5 * k))
    for k in range(5)
]
FAILED_AT = 2
#: One standard deviation of a pose: 1 mm and 0.1 degrees; and of one that stands on an arc about
#: the pad, 0.3 rad either way, whose range and bearing are known all the same.
SURE = np.diag([1.0] * 3 + [(0.1 * np.pi / 180) ** 2] * 3)


def on_an_arc(pose: Pose) -> Any:
    """The covariance (6, 6) of a pose of a pad that is far away: tilt and place look alike."""
    x, y, z = pose.tvec_mm
    # The centre moves, in the camera frame, as a turn about the pad's centre takes it.
    swing = np.vstack([np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]), np.eye(3)])
    swing[:3] = pose.rotation @ swing[:3]
    return SURE / 100 + 0.3**2 * swing[:, :2] @ swing[:, :2].T


def records(bearing_at: tuple[int, ...] = ()) -> list[dict[str, Any]]:
    """Five poses at 10 frames a second, and a failed frame between them.

    Parameters
    ----------
    bearing_at : tuple of int
        Places in `POSES` of those whose range and bearing alone are known.
    """
    detections = [
        Detection(
            pose,
            layer="red",
            cells_read=90,
            frame_px=(CAMERA.width, CAMERA.height),
            uncertainty=Uncertainty.of(pose, on_an_arc(pose) if place in bearing_at else SURE),
        )
        for place, pose in enumerate(POSES)
    ]
    failure = StageFailure("lines", Reason.NO_LATTICE, "3 lines", "go closer")
    failed = Detection(None, failure, frame_px=(CAMERA.width, CAMERA.height))
    detections.insert(FAILED_AT, failed)
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
