"""The boards of the shoot-out as sheets for the simulator, each 1250 mm square."""

from __future__ import annotations

import io

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from padstudio.pad.layout import Layout

SIDE_MM = 1250.0
MARKERS = 25
# Of the pitch; the rest is the white gap that markers need.
MARKER_SHARE = 0.8
SINGLE_MODULES = 6


def aruco_dictionary() -> cv2.aruco.Dictionary:
    """Of the board; the smallest predefined one with 625 markers, hence the largest modules."""
    return cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_1000)


def single_dictionary() -> cv2.aruco.Dictionary:
    """Of the single marker; shares no marker with the board's."""
    return cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_ARUCO_MIP_36h12)


def single_side_mm() -> float:
    """Black square of the single marker: one module of white round it (8 + 2 modules a side)."""
    return SIDE_MM * 8 / 10


def aruco_sheet() -> Layout:
    """625 markers of 40 mm, 50 mm apart, 10 mm of white between them."""
    dictionary = aruco_dictionary()
    pitch, side = SIDE_MM / MARKERS, SIDE_MM / MARKERS * MARKER_SHARE
    modules = dictionary.markerSize + 2
    gap = np.array([0.0, (pitch - side) / 2])
    offsets = np.concatenate([gap[:1], gap[1] + side * np.arange(modules + 1) / modules])
    edges = np.append((pitch * np.arange(MARKERS)[:, None] + offsets).ravel(), SIDE_MM)
    step = modules + 2
    white = np.full((MARKERS * step, MARKERS * step), 255, np.uint8)
    for number in range(MARKERS**2):
        row, col = (step * k + 1 for k in divmod(number, MARKERS))
        marker = cv2.aruco.generateImageMarker(dictionary, number, modules)
        white[row : row + modules, col : col + modules] = marker
    return _sheet(white, edges)


def single_sheet() -> Layout:
    """One marker over the whole sheet."""
    dictionary = single_dictionary()
    modules = dictionary.markerSize + 2
    marker = cv2.aruco.generateImageMarker(dictionary, 0, modules)
    framed = np.pad(marker, 1, constant_values=255)
    return _sheet(framed, np.linspace(0, SIDE_MM, len(framed) + 1))


def puzzle_sheet(squares: int, pixels: int = 24) -> Layout:
    """A PuzzleBoard as its own printer makes it; ``pixels`` a square, so that its dots are round.

    Raises
    ------
    ImportError
        If calib-targets is not installed.
    """
    import calib_targets

    # With squares of an inch, dots per inch are pixels a square.
    side_mm = 25.4 * squares
    document = calib_targets.puzzleboard_document(
        squares,
        squares,
        25.4,
        page=calib_targets.PageSpec(
            size=calib_targets.PageSize.custom(width_mm=side_mm, height_mm=side_mm), margin_mm=0.0
        ),
        render=calib_targets.RenderOptions(png_dpi=pixels),
    )
    png = calib_targets.render_target_bundle(document).png_bytes
    grey = np.asarray(Image.open(io.BytesIO(png)).convert("L"))
    if grey.shape != (squares * pixels, squares * pixels):
        raise ValueError(f"calib-targets printed {grey.shape}, not {squares * pixels} a side")
    black_and_white = np.where(grey < 128, 0, 255).astype(np.uint8)
    return _sheet(black_and_white, np.linspace(0, SIDE_MM, squares * pixels + 1))


def _sheet(grey: NDArray[np.uint8], edges: NDArray[np.float64]) -> Layout:
    colors = np.repeat(grey[:, :, None], 3, axis=2)
    return Layout(SIDE_MM, SIDE_MM, edges, edges, colors)
