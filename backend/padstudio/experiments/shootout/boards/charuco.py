"""A ChArUco board by OpenCV: a chessboard whose white squares hold markers."""

from __future__ import annotations

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.experiments.shootout.boards.aruco import Read, dictionary, parameters
from padstudio.experiments.shootout.boards.board_pose import pose_of
from padstudio.experiments.shootout.boards.sheets import PLACES, Page, centred
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.layout import Layout

# Of a square: markers of 7 modules, whose patches are then a tenth of a square.
_MARKER_SHARE, _PATCHES = 0.7, 20


def _board(page: Page) -> tuple[cv2.aruco.CharucoBoard, float]:
    """The board with squares of length 1, and their side in mm."""
    columns, rows, side_mm = page.places(PLACES)
    words = dictionary("5X5_1000")
    return cv2.aruco.CharucoBoard((columns, rows), 1.0, _MARKER_SHARE, words), side_mm


def charuco_sheet(page: Page) -> Layout:
    """As many squares as `PLACES` along the longer side, as OpenCV paints them."""
    board, side_mm = _board(page)
    columns, rows = board.getChessboardSize()
    grey = board.generateImage((columns * _PATCHES, rows * _PATCHES), marginSize=0)
    return centred(np.asarray(grey, np.uint8), columns * side_mm, page)


def charuco_reader(page: Page, camera: Camera, thorough: bool) -> Read:
    """Reads `charuco_sheet`; thorough: markers that were missed are looked for again."""
    board, side_mm = _board(page)
    chosen = cv2.aruco.CharucoParameters()
    chosen.tryRefineMarkers = thorough
    detector = cv2.aruco.CharucoDetector(board, chosen, parameters(thorough))
    columns, rows = board.getChessboardSize()
    corners = np.asarray(board.getChessboardCorners(), float)[:, :2]
    places = (corners - [columns / 2, rows / 2]) * [side_mm, -side_mm]

    def read(bgr: Image) -> Pose | None:
        seen, numbers, _, _ = detector.detectBoard(bgr)
        if numbers is None or seen is None:
            return None
        pixels = np.asarray(seen, float).reshape(-1, 2)
        return pose_of(places[np.asarray(numbers).ravel()], pixels, camera)

    return read
