"""Pictures of a pad, and of a ChArUco board, by cameras whose lens is known."""

from __future__ import annotations

import cv2
import numpy as np

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.layout import Layout
from padstudio.pad.spec import Pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging

# A square of the board, its marker (seven modules a side), pixels of the drawing.
_SQUARES, _SQUARE_PX, _MARKER_PX = 12, 28, 21

LENSES = {
    "bent": Camera(
        960, 540,
        [[701.0, 0, 477.3], [0, 700.2, 270.6], [0, 0, 1]],
        [-0.2714, 0.0932, 0.0007, -0.0004, -0.0178],
    ),
    "straight": Camera(960, 540, [[675.0, 0, 484.0], [0, 676.0, 264.0], [0, 0, 1]]),
    "long": Camera(
        960, 540, [[1800.0, 0, 470.0], [0, 1800.0, 277.0], [0, 0, 1]], [0.05, -0.2, 0, 0]
    ),
    "fisheye": Camera(
        960, 720,
        [[315.0, 0, 489.1], [0, 315.7, 353.7], [0, 0, 1]],
        [-0.0312, 0.0087, -0.0041, 0.0006],
        model="fisheye",
    ),
}  # fmt: skip


def poses_about(side_mm: float, camera: Camera, count: int, *, seed: int, tilt_deg: float = 40.0):
    """Poses from which a square fills 0.6 to 1.1 of the picture's height, leaning up to a tilt."""
    rng, out = np.random.default_rng(seed), []
    for _ in range(count):
        distance = side_mm * camera.matrix[0, 0] / (camera.height * rng.uniform(0.6, 1.1))
        tilt = rng.uniform(0, tilt_deg)
        x, y = rng.uniform(-0.3, 0.3, 2) * side_mm
        out.append(
            look_at_pad(
                float(distance * np.cos(np.radians(tilt))),
                tilt_deg=float(tilt),
                heading_deg=float(rng.uniform(0, 360)),
                tilt_towards_deg=float(rng.uniform(0, 360)),
                target_mm=(float(x), float(y)),
            )
        )
    return out


def shots(print_: Pad | Layout, camera: Camera, poses: list[Pose], imaging: Imaging | None = None):
    """A picture from each pose."""
    scene = Scene(pad=print_) if isinstance(print_, Pad) else Scene(pad=None, sheet=print_)
    imaging = imaging or Imaging()
    return [render(scene, camera, pose, imaging, seed=k).image for k, pose in enumerate(poses)]


def charuco_board(side_mm: float) -> tuple[cv2.aruco.CharucoBoard, Layout]:
    """A board, and as a sheet for the simulator."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_100)
    square = side_mm / _SQUARES
    sides = (square, square * _MARKER_PX / _SQUARE_PX)
    board = cv2.aruco.CharucoBoard((_SQUARES, _SQUARES), *sides, dictionary)
    pixels = _SQUARES * _SQUARE_PX
    grey = board.generateImage((pixels, pixels))
    edges = np.linspace(0, side_mm, pixels + 1)
    return board, Layout(side_mm, side_mm, edges, edges, np.repeat(grey[:, :, None], 3, axis=2))


def charuco_camera(board: cv2.aruco.CharucoBoard, pictures, model: str) -> Camera:
    """OpenCV's own calibration on its own corners, refined to parts of a pixel."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    detector = cv2.aruco.CharucoDetector(board)
    detector.setDetectorParameters(parameters)
    objects, pixels = [], []
    for picture in pictures:
        corners, ids, _, _ = detector.detectBoard(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY))
        if ids is not None and len(ids) >= 12:
            objects.append(board.getChessboardCorners()[ids.ravel()][None].astype(np.float32))
            pixels.append(corners.reshape(1, -1, 2).astype(np.float32))
    height, width = pictures[0].shape[:2]
    size = (width, height)
    if model == "fisheye":
        matrix = np.array([[0.33 * width, 0, width / 2], [0, 0.33 * width, height / 2], [0, 0, 1]])
        flags = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_RECOMPUTE_EXTRINSIC | cv2.CALIB_FIX_SKEW
        found = cv2.fisheye.calibrate(objects, pixels, size, matrix, np.zeros(4), flags=flags)
    else:
        found = cv2.calibrateCamera(objects, pixels, size, None, None)
    return Camera(width, height, found[1], found[2].ravel(), model)


def lens_error_px(found: Camera, true: Camera, reach: float = 1.0):
    """By how much a camera is off over the picture's grid, pixels, after the best turn (N,).

    Parameters
    ----------
    found, true : Camera
    reach : float
        Share of the picture about its middle that is looked at.
    """
    x = np.linspace((1 - reach) / 2, (1 + reach) / 2, 24) * (true.width - 1)
    y = np.linspace((1 - reach) / 2, (1 + reach) / 2, 16) * (true.height - 1)
    pixels = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    pixels = pixels[true.has_ray(pixels, true.normalize(pixels))]
    a, b = (_directions(camera, pixels) for camera in (found, true))
    seen = np.isfinite(a).all(axis=1) & np.isfinite(b).all(axis=1)
    u, _, v = np.linalg.svd(b[seen].T @ a[seen])
    turn = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    turned = a[seen] @ turn.T
    return np.linalg.norm(turned - b[seen], axis=1) * true.focal_px


def _directions(camera: Camera, pixels):
    rays = np.column_stack([camera.normalize(pixels), np.ones(len(pixels))])
    return rays / np.linalg.norm(rays, axis=1, keepdims=True)
