"""Intrinsics, lens and poses from patches of several pictures (Zhang's method, by OpenCV).

References
----------
Zhang, Z. (2000). A flexible new technique for camera calibration. doi:10.1109/34.888718.
Kannala, J. and Brandt, S. (2006). A generic camera model and calibration method for conventional,
wide-angle, and fish-eye lenses. doi:10.1109/TPAMI.2006.153.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np

from padstudio.arrays import Array
from padstudio.calibration.patches import Patches
from padstudio.errors import CalibrationError, CameraFormatError
from padstudio.geometry.camera import Camera
from padstudio.geometry.camera_files.parts.fields import LensModel
from padstudio.geometry.pose import Pose

#: How much of the camera is left free: focal length and one coefficient; besides these the
#: principal point and a second one, no decentring; everything.
Freedom = Literal["focal", "centred", "full"]

_ONE = cv2.CALIB_FIX_PRINCIPAL_POINT | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3
_FISHEYE = cv2.CALIB_RECOMPUTE_EXTRINSIC | cv2.CALIB_FIX_SKEW
_FIXED: dict[tuple[LensModel, Freedom], int] = {
    ("radtan", "focal"): _ONE | cv2.CALIB_FIX_ASPECT_RATIO | cv2.CALIB_ZERO_TANGENT_DIST,
    ("radtan", "centred"): cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K3,
    ("radtan", "full"): 0,
    ("fisheye", "focal"): _FISHEYE | _ONE | cv2.CALIB_FIX_K4,
    ("fisheye", "centred"): _FISHEYE | cv2.CALIB_FIX_K3 | cv2.CALIB_FIX_K4,
    ("fisheye", "full"): _FISHEYE,
}
_END = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 60, 1e-9)
#: What to do about pictures from which no camera follows.
UNTOLD = "no camera explains these pictures; take them from other sides, the pad large in them"
_COEFFICIENTS: dict[LensModel, int] = {"radtan": 5, "fisheye": 4}


@dataclass(frozen=True, eq=False)
class Solution:
    """A camera and the poses of its pictures.

    Attributes
    ----------
    camera : Camera
    poses : list of Pose
    residuals : list of (N, 2) float64
        Of each picture's patches, pixels: where they are less where the camera puts them.
    """

    camera: Camera
    poses: list[Pose]
    residuals: list[Array]

    @property
    def rms_px(self) -> float:
        """Root mean square of all residuals' lengths."""
        return rms_px(np.concatenate(self.residuals))


def solve(views: Sequence[Patches], start: Camera, freedom: Freedom) -> Solution:
    """Fit a camera to the patches of several pictures.

    Parameters
    ----------
    views : sequence of Patches
        Of one picture each.
    start : Camera
        Where the search begins; its lens model is kept.
    freedom : {"focal", "centred", "full"}

    Raises
    ------
    CalibrationError
        If the pictures do not tell a camera.
    """
    objects = [view.points_mm.astype(np.float32)[None] for view in views]
    pixels = [view.pixels.astype(np.float32)[None] for view in views]
    size, count = (start.width, start.height), _COEFFICIENTS[start.model]
    matrix, lens = start.matrix.copy(), np.zeros((count, 1))
    lens[: len(start.distortion), 0] = start.distortion[:count]
    calibrate = cv2.fisheye.calibrate if start.model == "fisheye" else cv2.calibrateCamera
    flags = cv2.CALIB_USE_INTRINSIC_GUESS | _FIXED[start.model, freedom]
    try:
        found = calibrate(objects, pixels, size, matrix, lens, flags=flags, criteria=_END)
    except cv2.error as error:
        raise CalibrationError(UNTOLD) from error
    _, fitted, bent, rvecs, tvecs = found
    try:
        camera = Camera(*size, np.asarray(fitted), np.ravel(bent), start.model, name=start.name)
    except CameraFormatError as error:
        raise CalibrationError(UNTOLD) from error
    poses = [
        Pose.from_T_camera_pad(np.asarray(cv2.Rodrigues(rvec)[0], float), np.ravel(tvec))
        for rvec, tvec in zip(rvecs, tvecs, strict=True)
    ]
    return Solution(camera, poses, _residuals(views, camera, poses))


def rms_px(residuals: Array) -> float:
    """Root mean square of the lengths of residuals (N, 2)."""
    return float(np.sqrt(np.mean(np.sum(residuals**2, axis=1))))


def _residuals(views: Sequence[Patches], camera: Camera, poses: Sequence[Pose]) -> list[Array]:
    return [
        view.pixels - camera.project(pose.to_camera(view.points_mm))
        for view, pose in zip(views, poses, strict=True)
    ]
