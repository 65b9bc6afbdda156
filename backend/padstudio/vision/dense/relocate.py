"""Where a pad went that is not quite where it was expected: the picture that the pose predicts,
moved over the frame.

After frames that were dropped, and in gusts, a camera has turned by more than the reach of the
profiles across borders. Its height and attitude are still nearly as expected, so that the frame
shows what was predicted, but elsewhere: at the peak of their cross-correlation.

References
----------
Lewis, J. P. (1995). Fast template matching. Vision Interface 95.
"""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import lattice_of
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.frame.pyramid import Window
from padstudio.vision.pose.pattern.template import on_pad
from padstudio.vision.refine.refiner import Refiner

# Cells are compared at about this width, pixels, or less where the frame would be large.
_CELL_PX, _MOST_PX = 4.0, 512
# Fewer cells in view are alike elsewhere too.
_LEAST_CELLS = 40
# Rays are found at every so many pixels; between them they bend little.
_SPARSE = 8
# The light is taken off that is the mean of so many cells, and grey values beyond so many
# deviations are the ground's.
_EVEN_CELLS, _MOST_SIGMAS = 3.0, 2.0
# A peak above so many deviations of the correlation is no chance among its 10⁵ places.
_PEAK = 7.0
# Rays below the horizon by less than this cosine meet no pad.
_LEAST_DROP = 0.02

_Grey = NDArray[np.float32]


def relocate(refiner: Refiner, expected: MovingPose) -> MovingPose | None:
    """The expected pose, turned to where the frame shows what it predicts.

    Parameters
    ----------
    refiner : Refiner
    expected : MovingPose
        Its height right to some per cent, and its attitude but for the turn to some degrees.

    Returns
    -------
    MovingPose or None
        Right to about half a pixel at the scale of the comparison; None where no layer shows enough
        cells, or the frame shows nothing like them.
    """
    for layer in sorted(refiner.pad.layers, key=lambda item: -item.cell_mm):
        cell_px = refiner.camera.focal_px * layer.cell_mm / expected.pose.range_mm
        if cell_px < 1:
            continue
        window = refiner.pyramid.window(layer.channel, _level(refiner, cell_px))
        predicted = _predicted(refiner.pad, layer, refiner.camera, expected, window)
        shown = np.count_nonzero(predicted)
        if shown < _LEAST_CELLS * (cell_px / window.pixel) ** 2:
            continue
        moved = _shift(predicted, _grey(window), round(_EVEN_CELLS * cell_px / window.pixel))
        if moved is not None:
            return _turned(expected, refiner.camera, window, predicted, moved)
    return None


def _level(refiner: Refiner, cell_px: float) -> int:
    suits = math.floor(math.log2(max(cell_px / _CELL_PX, 1.0)))
    return max(suits, math.ceil(math.log2(max(refiner.pyramid.box.side / _MOST_PX, 1.0))))


def _predicted(pad: Pad, layer: Layer, camera: Camera, pose: MovingPose, window: Window) -> _Grey:
    """A layer's cells as a pose shows them, −1 … 1, and 0 beyond the pad, (h, w)."""
    height, width = len(window.values), window.width
    # A margin of one block a side, so that all pixels lie between rays.
    y, x = (
        _SPARSE * np.arange(-1, -(-side // _SPARSE) + 1) + (_SPARSE - 1) / 2
        for side in (height, width)
    )
    xy = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    rays = np.column_stack([camera.normalize(window.to_frame(xy)), np.ones(len(xy))])
    down = -(rays @ pose.pose.rotation[2]) / np.linalg.norm(rays, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        points = on_pad(pose.pose, rays)
    points = np.where((down > _LEAST_DROP)[:, None], points, 1e3 * max(pad.size_mm))
    places = lattice_of(pad, layer, points).reshape(len(y), len(x), 2).astype(np.float32)
    size = (_SPARSE * len(x), _SPARSE * len(y))
    within = slice(_SPARSE, _SPARSE + height), slice(_SPARSE, _SPARSE + width)
    # Pixels of the field have their centres at whole numbers.
    dense = cv2.resize(places, size, interpolation=cv2.INTER_LINEAR)[within] - np.float32(0.5)
    field = 2 * layer.field.astype(np.float32) / np.float32(pad.levels - 1) - 1
    columns, rows = np.ascontiguousarray(dense[..., 0]), np.ascontiguousarray(dense[..., 1])
    return np.asarray(cv2.remap(field, columns, rows, cv2.INTER_NEAREST), np.float32)


def _grey(window: Window) -> _Grey:
    """A window's grey values (h, w), but for their black."""
    last = window.first + window.step * window.width
    grey = window.gain * window.values[:, window.first : last : window.step].astype(np.float32)
    if window.weight:
        height, width = grey.shape
        share = math.ceil(width * window.scale)
        colours = window.colours[:, :share].astype(np.float32)
        if colours.shape != grey.shape:
            colours = np.asarray(cv2.resize(colours, (width, height)))
        grey += window.weight * colours
    return np.asarray(grey, np.float32)


def _shift(predicted: _Grey, grey: _Grey, even_px: int) -> Array | None:
    """By how many pixels (x, y) what is predicted lies elsewhere; None where it is nowhere."""
    around = (even_px | 1, even_px | 1)
    left = grey - cv2.blur(grey, around)
    bound = _MOST_SIGMAS * float(np.sqrt(np.mean(left * left)))
    template = (predicted - cv2.blur(predicted, around)) * (predicted != 0)
    match = _correlation(np.clip(left, -bound, bound), template)
    height, width = match.shape
    row, column = divmod(int(np.argmax(match)), width)
    if not match[row, column] > _PEAK * float(np.sqrt(np.mean(match * match))):
        return None
    beyond = np.array([column > width / 2, row > height / 2])
    whole = np.array([column, row]) - beyond * np.array([width, height])
    return np.asarray(whole + _within_pixel(match, row, column))


def _correlation(left: _Grey, template: _Grey) -> _Grey:
    """Cross-correlation of two pictures (h, w), by their shift; negative ones count from behind."""
    height, width = left.shape
    # Shifts of up to a third of the frame find nothing of its other side.
    below = cv2.getOptimalDFTSize(height + height // 3) - height
    beside = cv2.getOptimalDFTSize(width + width // 3) - width
    spectra = [
        cv2.dft(cv2.copyMakeBorder(plane, 0, below, 0, beside, cv2.BORDER_CONSTANT, value=0))
        for plane in (left, template)
    ]
    product = cv2.mulSpectrums(spectra[0], spectra[1], 0, conjB=True)
    match = cv2.idft(product, flags=cv2.DFT_SCALE | cv2.DFT_REAL_OUTPUT)
    return np.asarray(match, np.float32)


def _within_pixel(match: _Grey, row: int, column: int) -> Array:
    """Where a parabola through a peak and its neighbours has its top, (x, y)."""
    height, width = match.shape
    found = []
    for before, after in (
        (match[row, column - 1], match[row, (column + 1) % width]),
        (match[row - 1, column], match[(row + 1) % height, column]),
    ):
        bend = 2 * match[row, column] - before - after
        found.append(0.5 * float(after - before) / float(bend) if bend > 0 else 0.0)
    return np.array(found)


def _turned(
    pose: MovingPose, camera: Camera, window: Window, predicted: _Grey, moved: Array
) -> MovingPose:
    """The pose turned so that what it shows amid the overlap lies where it was found."""
    height, width = predicted.shape
    rows, columns = np.nonzero(predicted)
    xy = np.stack([columns, rows], axis=1).astype(float)
    there = xy + moved
    seen = ((there >= 0) & (there <= [width - 1, height - 1])).all(axis=1)
    amid = xy[seen].mean(axis=0) if seen.any() else xy.mean(axis=0)
    pixels = window.to_frame(np.stack([amid, amid + moved]))
    rays = np.column_stack([camera.normalize(pixels), np.ones(2)])
    before, after = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    axis = np.cross(after, before)
    sine = float(np.linalg.norm(axis))
    angle = math.atan2(sine, float(before @ after))
    # The camera turns the other way than what it sees.
    turn = axis * (angle / sine if sine > 0 else 0.0)
    return pose.moved(np.concatenate([np.zeros(3), turn]))
