"""The readers of the shoot-out: from pictures to the camera's poses over a board."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import cv2
import numpy as np
import shootout_boards as boards
from numpy.typing import NDArray

from padstudio import Camera, Detector, Pad, Pose
from padstudio.pad.layout import Layout
from padstudio.vision.stage.detection import Method

Image = NDArray[np.uint8]
Read = Callable[[Image], Pose | None]
#: One pose, or None, a picture.
ReadAll = Callable[[Iterable[Image]], Iterator[Pose | None]]

_LEAST_CORNERS = 4
# How far off a point may be to count for the pose, pixels.
_INLIER_PX = 3.0


@dataclass(frozen=True)
class Reader:
    """A way to read a board.

    Attributes
    ----------
    board : str
        Key of `BOARDS`.
    make : callable
        From the pad (which rivals do not look at) and the camera to the reader.
    groups : tuple of str or None
        Groups of frames it is for; None is all.
    """

    board: str
    make: Callable[[Pad, Camera], ReadAll]
    groups: tuple[str, ...] | None = None


def _ours(method: Method) -> Callable[[Pad, Camera], ReadAll]:
    def make(pad: Pad, camera: Camera) -> ReadAll:
        detector = Detector(pad, camera, method=method)
        return lambda images: (detector.detect(image).pose for image in images)

    return make


def _tracked(pad: Pad, camera: Camera) -> ReadAll:
    detector = Detector(pad, camera)
    return lambda images: (detection.pose for detection in detector.track(images))


def _rival(make: Callable[[Camera], Read]) -> Callable[[Pad, Camera], ReadAll]:
    def from_camera(_: Pad, camera: Camera) -> ReadAll:
        read = make(camera)
        return lambda images: (read(image) for image in images)

    return from_camera


def pose_of(
    points_mm: NDArray[np.float64], pixels: NDArray[np.float64], camera: Camera
) -> Pose | None:
    """The pose from points of the board's plane (N, 2) and where they are seen (N, 2).

    A homography by RANSAC drops misread points; IPPE's better answer is polished on the others.
    """
    if len(points_mm) < _LEAST_CORNERS:
        return None
    rays = camera.normalize(pixels)
    focal = float(camera.matrix[0, 0])
    _, kept = cv2.findHomography(points_mm, rays, cv2.RANSAC, _INLIER_PX / focal)
    if kept is None or kept.sum() < _LEAST_CORNERS:
        return None
    keep = kept.ravel() > 0
    points = np.column_stack([points_mm[keep], np.zeros(keep.sum())])
    eye, none = np.eye(3), np.zeros(4)
    found, turns, shifts, _ = cv2.solvePnPGeneric(
        points, rays[keep], eye, none, flags=cv2.SOLVEPNP_IPPE
    )
    if not found:
        return None
    turn, shift = cv2.solvePnPRefineLM(points, rays[keep], eye, none, turns[0], shifts[0])
    rotation = cv2.Rodrigues(turn)[0].T
    return Pose((-rotation @ shift).ravel(), rotation)


def _detector(dictionary: cv2.aruco.Dictionary) -> cv2.aruco.ArucoDetector:
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    return cv2.aruco.ArucoDetector(dictionary, parameters)


def aruco_board(camera: Camera) -> Read:
    """The board of 25 x 25 markers by `cv2.aruco`."""
    detector = _detector(boards.aruco_dictionary())
    pitch = boards.SIDE_MM / boards.MARKERS
    side = pitch * boards.MARKER_SHARE
    square = np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]]) * side / 2

    def read(bgr: Image) -> Pose | None:
        corners, numbers, _ = detector.detectMarkers(bgr)
        if numbers is None:
            return None
        pixels, points = [], []
        for seen, number in zip(corners, numbers.ravel(), strict=True):
            if number < boards.MARKERS**2:
                row, col = divmod(int(number), boards.MARKERS)
                middle = np.array([col + 0.5, boards.MARKERS - row - 0.5]) * pitch
                points.append(middle - boards.SIDE_MM / 2 + square)
                pixels.append(seen.reshape(4, 2))
        if not points:
            return None
        return pose_of(np.concatenate(points), np.concatenate(pixels).astype(float), camera)

    return read


def single_marker(camera: Camera) -> Read:
    """One large marker by `cv2.aruco`."""
    detector = _detector(boards.single_dictionary())
    square = np.array([[-1.0, 1], [1, 1], [1, -1], [-1, -1]]) * boards.single_side_mm() / 2

    def read(bgr: Image) -> Pose | None:
        corners, numbers, _ = detector.detectMarkers(bgr)
        if numbers is None or 0 not in numbers:
            return None
        seen = corners[int(np.flatnonzero(numbers.ravel() == 0)[0])]
        return pose_of(square, seen.reshape(4, 2).astype(float), camera)

    return read


def puzzle_board(squares: int) -> Callable[[Camera], Read]:
    """A maker of readers of a PuzzleBoard by calib-targets."""

    def make(camera: Camera) -> Read:
        import calib_targets

        params = calib_targets.default_puzzleboard_params(squares, squares)
        params.decode.search_mode = calib_targets.PuzzleBoardSearchMode.fixed_board()
        cell_mm = boards.SIDE_MM / squares

        def read(bgr: Image) -> Pose | None:
            grey = cv2.cvtColor(bgr, cv2.COLOR_BGR2GRAY)
            try:
                found = calib_targets.detect_puzzleboard(grey, params=params)
            except RuntimeError:
                # How it says that nothing was found.
                return None
            pixels = np.array([corner.position for corner in found.corners], float)
            places = np.array([corner.target_position for corner in found.corners], float)
            middle = boards.SIDE_MM / 2
            points = np.column_stack(
                [places[:, 0] * cell_mm - middle, middle - places[:, 1] * cell_mm]
            )
            return pose_of(points, pixels, camera)

        return read

    return make


BOARDS: dict[str, Callable[[], Layout]] = {
    "ArUco board": boards.aruco_sheet,
    "single marker": boards.single_sheet,
    "PuzzleBoard 25 mm": lambda: boards.puzzle_sheet(50),
    "PuzzleBoard 10 mm": lambda: boards.puzzle_sheet(125, pixels=12),
}
READERS = {
    "dense": Reader("pad", _ours("dense")),
    "dense, tracked": Reader("pad", _tracked, ("flight",)),
    "paper": Reader("pad", _ours("paper")),
    "ArUco board": Reader("ArUco board", _rival(aruco_board)),
    "single marker": Reader("single marker", _rival(single_marker)),
    "PuzzleBoard 25 mm": Reader("PuzzleBoard 25 mm", _rival(puzzle_board(50))),
    "PuzzleBoard 10 mm": Reader("PuzzleBoard 10 mm", _rival(puzzle_board(125))),
}
