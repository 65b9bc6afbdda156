"""Stage `pose`: from a first pose to the best one the picture allows, layer by layer.

Coarse layers first: their borders bring the pose near enough to tell the finer layer's borders
apart. A layer counts only where its cells, read with the refined pose, agree with the pad.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.borders import Borders, Measured, layer_borders, measure
from padstudio.vision.cells import CellGrid, read_cells
from padstudio.vision.evidence import Evidence, judge
from padstudio.vision.motion import MovingPose
from padstudio.vision.params import DetectorParams
from padstudio.vision.planes import Pyramid
from padstudio.vision.refine import Fit, better_of, fit_pose
from padstudio.vision.types import Array
from padstudio.vision.view import to_pad, visible_range

# Profiles reach this far, and are taken where a cell is about this wide, pixels of the plane.
_REACH_PX = 6.0
_CELL_PX = 9.0


@dataclass(frozen=True, eq=False)
class LayerRead:
    """A layer's cells read with a known pose."""

    layer: Layer
    cells: CellGrid
    expected: np.ndarray[tuple[int, ...], np.dtype[np.int8]]
    evidence: Evidence
    area_mm2: float


@dataclass(frozen=True, eq=False)
class Measurement:
    """A refined pose and what it rests on.

    Attributes
    ----------
    fit : Fit
    layer : Layer
        The finest layer that was measured.
    measured : Measured
        Its borders.
    camera : Camera
        At the frame's size.
    cell_px : float
        Median width of a cell of the layer, frame pixels.
    """

    fit: Fit
    layer: Layer
    measured: Measured
    camera: Camera
    cell_px: float


def refine_pose(
    pyramid: Pyramid, camera: Camera, pad: Pad, start: MovingPose, params: DetectorParams
) -> Measurement | None:
    """Measure the borders of every readable layer, the coarse ones first.

    Returns
    -------
    Measurement or None
        None where no layer shows enough borders.
    """
    best: Measurement | None = None
    pose = start
    for layer in sorted(pad.layers, key=lambda item: -item.cell_mm):
        found = _refine_layer(pyramid, camera, pad, layer, pose, params)
        if found is None:
            continue
        read = read_layer(pyramid, camera, pad, layer, found.fit.pose, places=1)
        if read is None or not read.evidence.suffices(0.0):
            continue
        best, pose = found, found.fit.pose
    return best


def read_layer(
    pyramid: Pyramid, camera: Camera, pad: Pad, layer: Layer, pose: MovingPose, places: int
) -> LayerRead | None:
    """Read a layer's visible cells where a pose puts them, and compare them with the pad.

    Parameters
    ----------
    places : int
        Among how many places this one was chosen; it weakens the evidence.
    """
    rows, cols = visible_range(pad, layer, camera, pose.pose)
    if rows[0] >= rows[1] or cols[0] >= cols[1]:
        return None

    def to_pixels(coordinates: Array) -> Array:
        return pose.project(camera, to_pad(pad, layer, coordinates))

    cells = read_cells(pyramid, layer.channel, to_pixels, cols, rows)
    if cells is None:
        return None
    expected = layer.field[rows[0] : rows[1], cols[0] : cols[1]].astype(np.int8)
    evidence = judge(cells.levels(pad.levels), expected, pad.levels, places)
    area = float(cells.seen.sum()) * layer.cell_mm**2
    return LayerRead(layer, cells, expected, evidence, area)


def _refine_layer(
    pyramid: Pyramid,
    camera: Camera,
    pad: Pad,
    layer: Layer,
    pose: MovingPose,
    params: DetectorParams,
) -> Measurement | None:
    borders, cell_px = _visible_borders(camera, pad, layer, pose, params.refine.most_borders)
    if len(borders.step) < 12 or cell_px < params.refine.least_cell_px:
        return None
    level = max(0, math.floor(math.log2(cell_px / _CELL_PX))) if cell_px > _CELL_PX else 0
    best: tuple[Fit, Measured] | None = None
    for step in (level, level, max(0, level - 1)):
        plane = pyramid.plane(layer.channel, step)
        measured = measure(borders, plane, camera, pose, _REACH_PX)
        fit = fit_pose(pose, measured, camera, motion=False)
        if fit is None:
            break
        if params.refine.motion:
            fit = better_of(fit, fit_pose(fit.pose, measured, camera, motion=True))
        pose, best = fit.pose, (fit, measured)
    return None if best is None else Measurement(best[0], layer, best[1], camera, cell_px)


def _visible_borders(
    camera: Camera, pad: Pad, layer: Layer, pose: MovingPose, most: int
) -> tuple[Borders, float]:
    """Borders in view, thinned evenly, and the median width of a cell across them, pixels."""
    rows, cols = visible_range(pad, layer, camera, pose.pose)
    borders = layer_borders(pad, layer, rows, cols)
    pixels = pose.project(camera, borders.points_mm)
    with np.errstate(invalid="ignore"):
        inside = (
            (pixels[:, 0] > 1)
            & (pixels[:, 1] > 1)
            & (pixels[:, 0] < camera.width - 2)
            & (pixels[:, 1] < camera.height - 2)
        )
    which = np.flatnonzero(inside)
    if not len(which):
        return borders.take(which), 0.0
    which = which[:: max(1, -(-len(which) // most))]
    chosen = borders.take(which)
    moved = pose.project(camera, chosen.points_mm + 0.05 * chosen.across_mm)
    cell_px = 20 * float(np.nanmedian(np.linalg.norm(moved - pixels[which], axis=1)))
    return chosen, cell_px
