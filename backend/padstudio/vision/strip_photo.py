"""What a printer and a camera make of the pad's colours, measured on a photo of the test strip.

No ink reflects one channel alone and no camera channel sees one alone: part of the red layer shows
in the blue channel and the other way round. A photo of the test strip (`pad.sheets.strip`)
gives the 3 × 3 matrix of that mixture; its inverse un-mixes frames of the same printer and camera.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from padstudio.arrays import Array, Image
from padstudio.color import linear_from_srgb
from padstudio.errors import ImageError, PadFormatError
from padstudio.pad.crosstalk import check_matrix, separation_warnings
from padstudio.pad.sheets import strip
from padstudio.pad.sheets.paper import Box

_PX_PER_MM = 4
_LEAST_MARKERS = 3
_CLIPPED = 252.0
_DIM = 60.0


@dataclass(frozen=True, eq=False)
class Crosstalk:
    """The mixture of colours of one printer and one camera.

    Attributes
    ----------
    matrix : (3, 3) float64
        RGB order. Linear light in camera channel i, as a share of what white paper gives, is
        ``matrix[i] @ nominal + offset[i]`` for nominal channels 0 … 1.
    offset : (3,) float64
        What black gives.
    residual : float
        Root mean square misfit of the five full colours, same unit.
    red_separation, blue_separation : float
        In its own channel, the darkest patch that should be full less the brightest that should
        be dark, as a share of white.
    warnings : tuple of str
        What is wrong with the photo, or with the colours, in plain words.
    usable : bool
        The photo is well exposed, and the mixture can be undone.
    """

    matrix: Array
    offset: Array
    residual: float
    red_separation: float
    blue_separation: float
    warnings: tuple[str, ...]
    usable: bool = True


def estimate_crosstalk(bgr: Image) -> Crosstalk:
    """The mixture of colours from a photo of the test strip.

    Each patch is compared with the bare paper beside it, so that uneven light cancels out; the
    matrix is the least squares fit over black, red, blue, magenta and white in linear light.

    Parameters
    ----------
    bgr : (H, W, 3) uint8
        The photo, with at least three of the strip's four markers.

    Raises
    ------
    ImageError
        If the strip is not found.
    """
    flat = _flatten(bgr)
    patches = np.array([_median(flat, patch.box) for patch in strip.PATCHES])
    paper = np.array(
        [np.mean([_median(flat, gap) for gap in patch.gaps], axis=0) for patch in strip.PATCHES]
    )
    seen = dict(
        zip(
            [patch.name for patch in strip.PATCHES],
            linear_from_srgb(patches / 255) / np.maximum(linear_from_srgb(paper / 255), 1e-4),
            strict=True,
        )
    )
    matrix, offset, residual = _fit(seen)
    red = min(seen["red"][0], seen["magenta"][0]) - max(seen["black"][0], seen["blue"][0])
    blue = min(seen["blue"][2], seen["magenta"][2]) - max(seen["black"][2], seen["red"][2])
    faults = _photo_faults(paper, matrix)
    warnings = (*faults, *separation_warnings(float(red), float(blue)), *_grey_faults(seen))
    return Crosstalk(
        matrix=matrix,
        offset=offset,
        residual=residual,
        red_separation=float(red),
        blue_separation=float(blue),
        warnings=warnings,
        usable=not faults,
    )


def _flatten(bgr: Image) -> Image:
    """The strip as seen from straight above, RGB, `_PX_PER_MM` pixels a millimetre."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    grey = cv2.cvtColor(bgr, cv2.COLOR_BGR2GRAY)
    corners, numbers, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(grey)
    found = {} if numbers is None else dict(zip(numbers.ravel().tolist(), corners, strict=True))
    markers = [number for number in range(len(strip.MARKER_CORNERS_MM)) if number in found]
    if len(markers) < _LEAST_MARKERS:
        raise ImageError(
            f"{len(markers)} of the test strip's 4 markers are in the picture; photograph the "
            "whole strip, sharp and evenly lit",
            code="no_test_strip",
        )
    side = strip.MARKER_MM
    square = np.array([[0, 0], [side, 0], [side, side], [0, side]])
    on_strip = np.concatenate(
        [np.array(strip.MARKER_CORNERS_MM[number]) + square for number in markers]
    )
    in_image = np.concatenate([found[number].reshape(4, 2) for number in markers])
    homography, _ = cv2.findHomography(on_strip * _PX_PER_MM, in_image)
    size = (int(strip.WIDTH_MM * _PX_PER_MM), int(strip.HEIGHT_MM * _PX_PER_MM))
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    flat = cv2.warpPerspective(bgr, homography, size, flags=flags)
    return np.ascontiguousarray(flat[..., ::-1])


def _median(flat: Image, box: Box) -> Array:
    """(3,) median of the middle of a box."""
    x0, x1 = box.x0 + box.width * 0.25, box.x1 - box.width * 0.25
    y0, y1 = box.y0 + box.height * 0.25, box.y1 - box.height * 0.25
    rows = slice(int(y0 * _PX_PER_MM), int(y1 * _PX_PER_MM))
    cols = slice(int(x0 * _PX_PER_MM), int(x1 * _PX_PER_MM))
    median: Array = np.median(flat[rows, cols].reshape(-1, 3), axis=0)
    return median


def _fit(seen: dict[str, Array]) -> tuple[Array, Array, float]:
    names = ("black", "red", "blue", "magenta", "white")
    nominal = {patch.name: np.array(patch.rgb) / 255 for patch in strip.PATCHES}
    known = np.array([[*nominal[name], 1.0] for name in names])
    values = np.array([seen[name] for name in names])
    solution = np.linalg.lstsq(known, values, rcond=None)[0]
    residual = float(np.sqrt(np.mean((known @ solution - values) ** 2)))
    return solution[:3].T, solution[3], residual


def _photo_faults(paper: Array, matrix: Array) -> list[str]:
    """Why a photo gives no mixture that frames could be un-mixed by."""
    out = []
    if paper.max() >= _CLIPPED:
        out.append("the paper is overexposed: photograph the strip darker")
    if paper.min() < _DIM:
        out.append("the paper is underexposed: photograph the strip brighter")
    try:
        check_matrix(matrix)
    except PadFormatError as error:
        out.append(error.message)
    return out


def _grey_faults(seen: dict[str, Array]) -> list[str]:
    greys = [seen[patch.name].mean() for patch in strip.PATCHES if patch.name.startswith("grey")]
    if (np.diff(greys) <= 0.005).any():
        return ["neighbouring grey steps look alike: use fewer levels"]
    return []
