"""ArUco markers by OpenCV: a board of many, a single one, and markers nested in each other."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Image
from padstudio.experiments.shootout.boards.board_pose import pose_of_squares
from padstudio.experiments.shootout.boards.sheets import (
    LEAST_MODULE_MM,
    PLACES,
    Page,
    centred,
    square_mm,
)
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.layout import Layout

#: A reader of one board: the pose over a picture (H, W, 3) uint8 BGR, or None.
Read = Callable[[Image], Pose | None]
#: Where a marker's corners are on the page, pad frame, mm, by the marker's number.
Places = Mapping[int, NDArray[np.float64]]

# Markers of 4 x 4 modules in a black border of one, and a white one round that.
_BOARD_MODULES, _BOARD_STEP = 6, 8
# 8 x 8 with the border, and a white one.
_SINGLE_MODULES, _SINGLE_STEP = 8, 10
# Markers of 5 x 5 modules have one in the middle; 7 with the border. White modules round the
# outermost one, and round those within: the reader samples a module at its quarters, and has to
# find white there.
_NESTED_MODULES, _OUTER_WHITE, _INNER_WHITE = 7, 1, 2
# ChArUco boards have the first markers of the same dictionary.
_NESTED_FROM = 900


def dictionary(name: str) -> cv2.aruco.Dictionary:
    """A predefined dictionary of OpenCV, by its name without ``DICT_``."""
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{name}"))


def parameters(thorough: bool) -> cv2.aruco.DetectorParameters:
    """How markers are looked for.

    Fast: the picture is thresholded over windows of one width. Thorough: of three, as is usual, and
    markers of a sixth of the usual least size are looked at. Corners are refined
    (``CORNER_REFINE_SUBPIX``) in both.
    """
    out = cv2.aruco.DetectorParameters()
    out.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    if thorough:
        out.minMarkerPerimeterRate = 0.005
    else:
        out.adaptiveThreshWinSizeMin = out.adaptiveThreshWinSizeMax
    return out


def board_sheet(page: Page) -> Layout:
    """As many markers as `PLACES` along the longer side, the largest modules that allow it."""
    columns, rows, side_mm = page.places(PLACES)
    white = np.full((rows * _BOARD_STEP, columns * _BOARD_STEP), 255, np.uint8)
    for number in range(columns * rows):
        row, column = (_BOARD_STEP * place + 1 for place in divmod(number, columns))
        marker = cv2.aruco.generateImageMarker(dictionary("4X4_1000"), number, _BOARD_MODULES)
        white[row : row + _BOARD_MODULES, column : column + _BOARD_MODULES] = marker
    return centred(white, columns * side_mm, page)


def board_reader(page: Page, camera: Camera, thorough: bool) -> Read:
    """Reads `board_sheet`."""
    columns, rows, side_mm = page.places(PLACES)
    square = square_mm(side_mm * _BOARD_MODULES / _BOARD_STEP)
    places = {}
    for number in range(columns * rows):
        row, column = divmod(number, columns)
        middle = np.array([column + 0.5 - columns / 2, rows / 2 - row - 0.5]) * side_mm
        places[number] = middle + square
    return _reader_of(dictionary("4X4_1000"), places, camera, thorough)


def single_sheet(page: Page) -> Layout:
    """One marker over the whole page, a module of white round it."""
    marker = cv2.aruco.generateImageMarker(dictionary("ARUCO_MIP_36h12"), 0, _SINGLE_MODULES)
    return centred(np.pad(marker, 1, constant_values=255), page.side_mm, page)


def single_reader(page: Page, camera: Camera, thorough: bool) -> Read:
    """Reads `single_sheet`."""
    side_mm = page.side_mm * _SINGLE_MODULES / _SINGLE_STEP
    return _reader_of(dictionary("ARUCO_MIP_36h12"), {0: square_mm(side_mm)}, camera, thorough)


def nested_sides_mm(page: Page) -> list[float]:
    """Sides of the nested markers, the outermost first: each lies in the last one's middle module.

    They go on as long as their modules are at least `LEAST_MODULE_MM`.
    """
    sides = [page.side_mm * _NESTED_MODULES / (_NESTED_MODULES + 2 * _OUTER_WHITE)]
    while (module := sides[-1] / _NESTED_MODULES / (_NESTED_MODULES + 2 * _INNER_WHITE)) >= (
        LEAST_MODULE_MM
    ):
        sides.append(module * _NESTED_MODULES)
    return sides


def nested_sheet(page: Page) -> Layout:
    """Markers whose middle module is white, and holds a smaller one in a white border."""
    numbers = _nested_numbers(len(nested_sides_mm(page)))
    grey = np.full((1, 1), 255, np.uint8)
    for level, number in reversed(list(enumerate(numbers))):
        marker = cv2.aruco.generateImageMarker(dictionary("5X5_1000"), number, _NESTED_MODULES)
        border = _INNER_WHITE if level else _OUTER_WHITE
        framed, inner = np.pad(marker, border, constant_values=255), len(grey)
        out = np.kron(framed, np.ones((inner, inner), np.uint8))
        middle = slice(inner * (len(framed) // 2), inner * (len(framed) // 2 + 1))
        out[middle, middle] = grey
        grey = out.astype(np.uint8)
    return centred(grey, page.side_mm, page)


def nested_reader(page: Page, camera: Camera, thorough: bool) -> Read:
    """Reads `nested_sheet`: markers are looked for one by one, the largest first.

    A detector that knows them all does not look at a marker in which it has read another.
    """
    sides = nested_sides_mm(page)
    numbers = _nested_numbers(len(sides))
    one_by_one = [
        _reader_of(_alone(number), {0: square_mm(side)}, camera, thorough)
        for number, side in zip(numbers, sides, strict=True)
    ]

    def read(bgr: Image) -> Pose | None:
        found = (reader(bgr) for reader in one_by_one)
        return next((pose for pose in found if pose is not None), None)

    return read


def _alone(number: int) -> cv2.aruco.Dictionary:
    """A dictionary with one marker of `5X5_1000`, whose number there is 0."""
    words = dictionary("5X5_1000")
    return cv2.aruco.Dictionary(
        words.bytesList[number : number + 1], words.markerSize, words.maxCorrectionBits
    )


def _nested_numbers(count: int) -> list[int]:
    """Markers whose middle module is white, as a marker in its white border mostly is."""
    words, found = dictionary("5X5_1000"), []
    for number in range(_NESTED_FROM, 1000):
        marker = cv2.aruco.generateImageMarker(words, number, _NESTED_MODULES)
        if marker[_NESTED_MODULES // 2, _NESTED_MODULES // 2] == 255:
            found.append(number)
    return found[:count]


def _reader_of(words: cv2.aruco.Dictionary, places: Places, camera: Camera, thorough: bool) -> Read:
    """A reader of the markers of some places."""
    detector = cv2.aruco.ArucoDetector(words, parameters(thorough))

    def read(bgr: Image) -> Pose | None:
        corners, numbers, _ = detector.detectMarkers(bgr)
        found = [
            (places[int(number)], seen.reshape(4, 2).astype(float))
            for seen, number in zip(
                corners, () if numbers is None else numbers.ravel(), strict=True
            )
            if int(number) in places
        ]
        return pose_of_squares(found, camera)

    return read
