"""A layer's cells read with a known pose, and what they say of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import lattice_mm
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells.evidence import Evidence, judge
from padstudio.vision.cells.sampling import CellGrid, read_cells
from padstudio.vision.cells.visible import visible_range
from padstudio.vision.frame.pyramid import Pyramid


@dataclass(frozen=True, eq=False)
class LayerRead:
    """A layer's cells read with a known pose.

    Attributes
    ----------
    layer : Layer
    cells : CellGrid
    count : int
        Y, the pad's number of levels.
    expected : (R, C) int8
        Levels that the pad has there.
    places : int
        Places and turns among which this one was chosen.
    evidence : Evidence
    """

    layer: Layer
    cells: CellGrid
    count: int
    expected: NDArray[np.int8]
    places: int
    evidence: Evidence

    @property
    def wrong_cells(self) -> str:
        """How many cells differ from the pad, for a sentence: ``3 of 40 red cells``."""
        return f"{self.evidence.wrong} of {self.evidence.read} {self.layer.channel} cells"


def read_layer(
    pyramid: Pyramid, camera: Camera, pad: Pad, layer: Layer, pose: MovingPose, places: int
) -> LayerRead | None:
    """Read a layer's visible cells where a pose puts them, and compare them with the pad.

    Parameters
    ----------
    pyramid : Pyramid
    camera : Camera
        At the frame's size.
    pad : Pad
    layer : Layer
    pose : MovingPose
    places : int
        Places and turns among which this one was chosen.

    Returns
    -------
    LayerRead or None
        None where no cell of the layer lies in the frame.
    """
    rows, cols = visible_range(pad, layer, camera, pose.pose)
    if rows[0] >= rows[1] or cols[0] >= cols[1]:
        return None

    def to_pixels(coordinates: Array) -> Array:
        return pose.project(camera, lattice_mm(pad, layer, coordinates))

    cells = read_cells(pyramid, layer.channel, to_pixels, cols, rows)
    if cells is None:
        return None
    expected = layer.field[rows[0] : rows[1], cols[0] : cols[1]].astype(np.int8)
    evidence = judge(cells.levels(pad.levels), expected, pad.levels, places)
    return LayerRead(layer, cells, pad.levels, expected, places, evidence)


def judge_together(reads: list[LayerRead]) -> Evidence:
    """The evidence of all cells of several layers, read with one pose.

    At one place of the pad layers have different cells, so chance would have to meet them all.
    """
    count = reads[0].count
    levels = np.concatenate([read.cells.levels(count).ravel() for read in reads])
    expected = np.concatenate([read.expected.ravel() for read in reads])
    places = max(read.places for read in reads)
    return judge(levels[None], expected[None], count, places)
