"""What a frame that is read says of the print and the light on it: contrast, crosstalk, sharpness.

Everything is measured on cells whose levels the pose tells. Contrast is in linear light as a share
of what full cells give, so that neither exposure nor even light change it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array, Image
from padstudio.color import linear_from_srgb
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.identity import pad_id
from padstudio.pad.layout import lattice_mm
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells.sampling import CellGrid, read_cells
from padstudio.vision.cells.visible import visible_range
from padstudio.vision.detector import Detector
from padstudio.vision.frame.pyramid import Box, Pyramid
from padstudio.vision.reasons.clues import Sharpness, sharpness_of
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Reason

Verdict = Literal["good", "fair", "bad", "unknown"]

# Light is compared within squares of a grid of so many a side, that hold so many cells of a level.
_SQUARES, _LEAST_CELLS = 5, 4
# Shares of what perfect inks would give, below which contrast is fair, and bad: the latter as of
# test strips (`padstudio.pad.crosstalk`).
_FAIR_CONTRAST, _BAD_CONTRAST = 0.4, 0.15
# Shares of a layer's own contrast that the other one adds: from a half on, thresholds between
# levels would lie within what the other layer does.
_FAIR_CROSSTALK, _BAD_CROSSTALK = 0.2, 0.5
# Light in the darkest square over that in the brightest.
_FAIR_LIGHT, _BAD_LIGHT = 0.4, 0.15
# A square whose contrast is below this part of the median's has glare or haze over it.
_GLARE, _FAIR_GLARE, _BAD_GLARE = 0.5, 0.03, 0.3
# Width of borders as a share of the cells: from one on, neighbours mix.
_FAIR_STEP, _BAD_STEP = 0.6, 1.0
# Borders have two directions, so that between them steps look this much flatter; where the factor
# is much larger, motion rather than focus has flattened those of one direction.
_BETWEEN, _MOTION = math.sqrt(2), 2.0
_SAMPLE_PX = 512
# Cells must be so wide that colours of neighbours, which cameras store coarsely, do not mix.
_LEAST_MIXING_PX = 6.0
_SHAPE = (Reason.PRINT_SCALE, Reason.WRONG_CAMERA)


@dataclass(frozen=True)
class PrintItem:
    """One thing that was measured.

    Attributes
    ----------
    code : str
        Stable, for programs: ``contrast_red``, ``sharpness``, …
    name : str
        For people.
    verdict : {"good", "fair", "bad", "unknown"}
    text : str
        What was measured, with its figures.
    advice : str
        What to do; empty where nothing is to be done.
    figure : float or None
        The figure that the verdict rests on.
    """

    code: str
    name: str
    verdict: Verdict
    text: str
    advice: str = ""
    figure: float | None = None


@dataclass(frozen=True, eq=False)
class _Shown:
    """A channel at the cells of the finest layer that can be read."""

    layer: Layer
    values: NDArray[np.float32]
    own: NDArray[np.int16]
    other: NDArray[np.int16] | None
    squares: NDArray[np.intp]


def check_print(bgr: Image, detector: Detector) -> list[PrintItem]:
    """Measure a print in a frame.

    Takes several times as long as reading it: the frame is looked at twice.

    Parameters
    ----------
    bgr : (H, W, 3) uint8
    detector : Detector

    Returns
    -------
    list of PrintItem
        Empty where the pad is not read, or too small for its cells to be measured.

    Raises
    ------
    ImageError, CameraMismatchError
        As `Detector.detect`.
    """
    found = detector.detect(bgr, reasons=True)
    if found.pose is None or found.layer == "outline":
        return []
    pad = next(pad for pad in detector.pads if pad_id(pad) == found.pad_id)
    camera = detector.camera.for_frame(bgr.shape[1], bgr.shape[0])
    return list(_items(Pyramid(bgr), pad, camera, found, detector.params.refine.least_cell_px))


def _items(
    pyramid: Pyramid, pad: Pad, camera: Camera, found: Detection, least_px: float
) -> Iterator[PrintItem]:
    assert found.pose is not None
    pose = MovingPose(found.pose)
    layers = sorted(pad.layers, key=lambda item: item.cell_mm)
    grids = {layer: _cells(pyramid, camera, pad, layer, pose, layer) for layer in layers}
    sizes = {layer: grid.cell_px for layer, grid in grids.items() if grid is not None}
    readable = [layer for layer, size in sizes.items() if size >= least_px]
    if not readable:
        return
    lattice = readable[0]
    cell_px = sizes[lattice]
    shown = [_shown(pyramid, camera, pad, layer, pose, lattice) for layer in layers]
    seen = [item for item in shown if item is not None]
    for item in seen:
        yield from _contrast(item, pad.levels)
    if cell_px >= _LEAST_MIXING_PX:
        for item in seen:
            yield from _crosstalk(item, pad.levels)
    if seen:
        yield from _light(seen[0], pad.levels)
    grid = grids[lattice]
    if grid is not None:
        yield _sharpness(pyramid, lattice, grid)
    finest = layers[0]
    yield _size(sizes.get(finest, 0.0), least_px, found.pose.range_mm, has_coarse=lattice != finest)
    yield from _shape(found, camera)


def _cells(
    pyramid: Pyramid, camera: Camera, pad: Pad, layer: Layer, pose: MovingPose, lattice: Layer
) -> CellGrid | None:
    """A layer's channel at the cells of a lattice."""
    rows, cols = visible_range(pad, lattice, camera, pose.pose)
    if rows[0] >= rows[1] or cols[0] >= cols[1]:
        return None

    def to_pixels(coordinates: Array) -> Array:
        return pose.project(camera, lattice_mm(pad, lattice, coordinates))

    return read_cells(pyramid, layer.channel, to_pixels, cols, rows)


def _shown(
    pyramid: Pyramid, camera: Camera, pad: Pad, layer: Layer, pose: MovingPose, lattice: Layer
) -> _Shown | None:
    grid = _cells(pyramid, camera, pad, layer, pose, lattice)
    if grid is None:
        return None
    own = _levels(layer, lattice, grid)
    others = [item for item in pad.layers if item is not layer]
    other = _levels(others[0], lattice, grid) if others else None
    use = grid.seen & (own >= 0)
    if not use.any():
        return None
    place = np.indices(own.shape)[:, use]
    low, high = place.min(axis=1, keepdims=True), place.max(axis=1, keepdims=True)
    row, col = (place - low) * _SQUARES // (high - low + 1)
    squares = np.asarray(row * _SQUARES + col, np.intp)
    beside = None if other is None else other[use]
    return _Shown(layer, grid.values[use], own[use], beside, squares)


def _levels(layer: Layer, lattice: Layer, grid: CellGrid) -> NDArray[np.int16]:
    """A layer's levels at the centres of a lattice's cells; -1 beyond it."""
    height, width = grid.values.shape
    scale = lattice.cell_mm / layer.cell_mm
    rows, cols = (
        np.floor((first + np.arange(count) + 0.5) * scale).astype(np.intp)
        for first, count in ((grid.row0, height), (grid.column0, width))
    )
    inside = np.ix_((rows >= 0) & (rows < layer.rows), (cols >= 0) & (cols < layer.cols))
    levels = np.full((height, width), -1, np.int16)
    levels[inside] = layer.field[np.ix_(rows[inside[0].ravel()], cols[inside[1].ravel()])]
    return levels


def _extremes(shown: _Shown, count: int) -> Array:
    """Mean light of dark and of full cells, and their grey values, (N, 4), in each square that has
    enough of both."""
    light = linear_from_srgb(shown.values / 255)
    found = []
    for square in np.unique(shown.squares):
        here = shown.squares == square
        dark, full = (here & (shown.own == level) for level in (0, count - 1))
        if min(dark.sum(), full.sum()) >= _LEAST_CELLS:
            pairs = ((light, dark), (light, full), (shown.values, dark), (shown.values, full))
            found.append([float(values[which].mean()) for values, which in pairs])
    return np.array(found, float).reshape(-1, 4)


def _contrast(shown: _Shown, count: int) -> Iterator[PrintItem]:
    ends, channel = _extremes(shown, count), shown.layer.channel
    if not len(ends):
        return
    dark, full, grey_dark, grey_full = ends.T
    share = float(np.median((full - dark) / np.maximum(full, 1e-4)))
    apart = float(np.median(grey_full - grey_dark))
    text = (
        f"{channel} cells are {apart:.0f} grey values apart, {share:.0%} of what perfect inks "
        "would give"
    )
    if count > 2:
        text += f"; {count} levels are {apart / (count - 1):.0f} apart in the mean"
    verdict = _verdict(share, _FAIR_CONTRAST, _BAD_CONTRAST)
    advice = {
        "fair": "avoid haze and reflections; if it stays so, print with more ink or fresh toner",
        "bad": "print anew with purer or more ink, on matt paper, and keep reflections away",
    }.get(verdict, "")
    yield PrintItem(f"contrast_{channel}", f"Contrast, {channel}", verdict, text, advice, share)


def _crosstalk(shown: _Shown, count: int) -> Iterator[PrintItem]:
    """Least squares for the light as a sum of what both layers add, in each square by itself."""
    if shown.other is None:
        return
    use = shown.other >= 0
    shares = []
    for square in np.unique(shown.squares):
        here = use & (shown.squares == square)
        own, other = (levels[here] / (count - 1) for levels in (shown.own, shown.other))
        if here.sum() < 4 * _LEAST_CELLS or min(np.ptp(own), np.ptp(other)) == 0:
            continue
        light = linear_from_srgb(shown.values[here] / 255)
        terms = np.column_stack([np.ones_like(own), own, other])
        (_, gain, added), *_ = np.linalg.lstsq(terms, light, rcond=None)
        if gain > 0:
            shares.append(float(added / gain))
    if not shares:
        return
    share, channel = float(np.median(shares)), shown.layer.channel
    verdict = _verdict(-abs(share), -_FAIR_CROSSTALK, -_BAD_CROSSTALK)
    text = f"the other layer changes {channel} by {share:.0%} of what {channel} cells do"
    advice = ""
    if verdict != "good":
        advice = (
            "photograph the test strip beside the print and store what it says with the pad "
            "(Design), or use purer inks"
        )
    yield PrintItem(f"crosstalk_{channel}", f"Crosstalk, {channel}", verdict, text, advice, share)


def _light(shown: _Shown, count: int) -> Iterator[PrintItem]:
    ends = _extremes(shown, count)
    if len(ends) < 4:
        return
    dark, full = ends.T[:2]
    share = float(full.min() / max(full.max(), 1e-4))
    contrast = (full - dark) / np.maximum(full, 1e-4)
    glare = float((contrast < _GLARE * np.median(contrast)).mean())
    verdict = _verdict(share, _FAIR_LIGHT, _BAD_LIGHT)
    text = f"the darkest part of the print gets {share:.0%} of the light of the brightest"
    advice = "" if verdict == "good" else "light it evenly: no shadow across it, no lamp close by"
    yield PrintItem("light", "Light", verdict, text, advice, share)
    verdict = _verdict(-glare, -_FAIR_GLARE, -_BAD_GLARE)
    text = f"{glare:.0%} of the print lies in glare or haze"
    advice = "" if verdict == "good" else "turn the print or the lamp, or expose less; matt paper"
    yield PrintItem("glare", "Glare", verdict, text, advice, glare)


def _sharpness(pyramid: Pyramid, layer: Layer, grid: CellGrid) -> PrintItem:
    x, y = np.median(grid.xy[grid.seen], axis=0)
    half = _SAMPLE_PX // 2
    box = Box(
        max(0, int(x) - half), max(0, int(y) - half),
        min(pyramid.width, int(x) + half), min(pyramid.height, int(y) + half),
    )  # fmt: skip
    sharpness: Sharpness = sharpness_of(pyramid.plane(layer.channel, 0, box).values)
    is_motion = sharpness.most_px > _MOTION * sharpness.least_px
    width = sharpness.most_px / _BETWEEN if is_motion else sharpness.least_px
    share = width / grid.cell_px
    verdict = _verdict(-share, -_FAIR_STEP, -_BAD_STEP)
    text = f"borders of cells are {width:.1f} px wide, and the cells {grid.cell_px:.1f} px"
    advice = ""
    if verdict != "good":
        advice = "hold it still, or expose for less time" if is_motion else "focus on the print"
    return PrintItem("sharpness", "Sharpness", verdict, text, advice, width)


def _size(cell_px: float, least_px: float, range_mm: float, *, has_coarse: bool) -> PrintItem:
    most_m = range_mm * cell_px / least_px / 1000
    text = f"the smallest cells are {cell_px:.1f} px wide; {least_px:g} are needed"
    if has_coarse:
        return PrintItem(
            "cell_size", "Cell size", "fair", f"{text}: only larger ones are read from here",
            f"come nearer than {most_m:.2g} m for all that the print can give", cell_px,
        )  # fmt: skip
    text += f": this camera reads them up to about {most_m:.2g} m away"
    verdict = _verdict(cell_px, 1.3 * least_px, least_px)
    advice = "" if verdict == "good" else "come nearer"
    return PrintItem("cell_size", "Cell size", verdict, text, advice, cell_px)


def _shape(found: Detection, camera: Camera) -> Iterator[PrintItem]:
    """Proportions and flatness, as the second look tells them."""
    ruler = (
        "whether all of it is too large, no camera can tell: lay a ruler on the printed one, and "
        "store what it says with the pad (Design)"
    )
    told = [item for item in found.warnings if item.reason in _SHAPE]
    if camera.nominal:
        text = "a camera that is not calibrated cannot tell whether the print is out of proportion"
        yield PrintItem("scale", "Print scale", "unknown", text, ruler)
    elif told:
        advice = f"{told[0].advice}; {ruler}"
        yield PrintItem("scale", "Print scale", "bad", told[0].detail, advice)
    else:
        text = "width and height of the print agree with the camera, as far as this view shows"
        yield PrintItem("scale", "Print scale", "good", text, ruler)
    for item in found.warnings:
        if item.reason == Reason.WARPED:
            yield PrintItem("flatness", "Flatness", "fair", item.detail, item.advice)


def _verdict(value: float, fair: float, bad: float) -> Verdict:
    """Of a figure that is better the larger it is."""
    return "bad" if value < bad else "fair" if value < fair else "good"
