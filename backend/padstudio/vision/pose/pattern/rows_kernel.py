"""Compiled half of `padstudio.vision.pose.pattern.posterior`: the pattern row by row."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_inlined_jit, fast_jit
from padstudio.geometry.projection import PoseState
from padstudio.vision.pose.noise_kernel import TILES
from padstudio.vision.pose.pattern.alignment_kernel import (
    Equations,
    gather,
    linearize,
    pull_tiles,
)
from padstudio.vision.pose.pattern.block_kernel import (
    BLOCK,
    GAIN,
    SHADE,
    Block,
    Brightness,
    Pixels,
    Texture,
    room,
    show,
)
from padstudio.vision.pose.pattern.solver_kernel import moved
from padstudio.vision.pose.row_motion_kernel import intervals_over


class RowEquations(NamedTuple):
    """Equations of pose and brightness, and of the pose by intervals of rows.

    Attributes
    ----------
    whole : Equations
        Of six parameters of the pose, their right sides by tile.
    normal : (C, 3, I, 6, 6) float64
        Sums of Jᵀ J, of f Jᵀ J and of f² Jᵀ J, where f goes from 0 to 1 in an interval.
    pull : (C, 2, I, 6) float64
        Sums of Jᵀ r and of f Jᵀ r.
    first, width : float
        Row time of the first interval's beginning, and their length.
    """

    whole: Equations
    normal: Array
    pull: Array
    first: float
    width: float


@fast_jit
def match_rows(
    pixels: Pixels, texture: Texture, pose: PoseState, brightness: Brightness, sway: Array
) -> RowEquations:
    """Equations about a pose, and a shaking besides.

    Parameters
    ----------
    pixels : Pixels
    texture : Texture
    pose : PoseState
    brightness : Brightness
    sway : (I + 1, 3) float64
        Rotation vectors of a shaking at the intervals' ends; (0, 3) of none.
    """
    time, channels, block = pixels.row_time, len(pixels.values), room(6, len(texture.layers))
    first, width, count = intervals_over(time[0], time[-1])
    size = len(block.rows)
    whole, right = np.zeros((channels, size, size)), np.zeros((channels, TILES**2, size))
    sums, residuals = np.zeros((channels, 4)), np.empty(pixels.values.shape, np.float32)
    normal, pull = np.zeros((channels, 3, count, 6, 6)), np.zeros((channels, 2, count, 6))
    end = 0
    for k in range(count):
        begin, start = end, first + k * width
        end = int(np.searchsorted(time, start + width)) if k + 1 < count else len(time)
        here = swayed(pose, sway, k, (start, width)) if len(sway) else pose
        for low in range(begin, end, BLOCK):
            part = low, min(low + BLOCK, end)
            show(block, texture, pixels, part, here)
            for c in range(channels):
                linearize(block, pixels, part, brightness, c, here.rotation)
                sums[c] += block.sums
                residuals[c, low : part[1]] = block.left[: part[1] - low]
                gather(block, whole[c])
                pull_tiles(block, pixels.tile[low : part[1]], right[c])
                gather_rows(block, (time[low : part[1]] - start) / width, normal[c], pull[c], k)
    return RowEquations(Equations(whole, right, sums, residuals), normal, pull, first, width)


@fast_jit
def swayed(pose: PoseState, sway: Array, k: int, rows: tuple[float, float]) -> PoseState:
    """A pose with the shaking over an interval of rows, from its beginning on and so long."""
    start, width = rows
    turn = np.zeros(12)
    turn[9:] = (sway[k + 1] - sway[k]) / width
    turn[3:6] = sway[k] - start * turn[9:]
    return moved(pose, turn)


@fast_inlined_jit
def gather_rows(block: Block, f: Array, normal: Array, pull: Array, k: int) -> None:
    """Add a block's equations of the pose to an interval's."""
    rows, weight, weighted, later = block.rows, block.weight, block.at[0], block.at[1]
    for i in range(len(f)):
        later[i] = f[i]
    for i in range(len(f), BLOCK):
        later[i] = 0.0
    for a in range(6):
        once = twice = 0.0
        for i in range(BLOCK):
            weighted[i] = weight[i] * rows[a, i]
        for i in range(BLOCK):
            here = block.scratch[i] * rows[a, i]
            once += here
            twice += here * later[i]
        pull[0, k, a], pull[1, k, a] = pull[0, k, a] + once, pull[1, k, a] + twice
        for b in range(a + 1):
            t0 = t1 = t2 = 0.0
            for i in range(BLOCK):
                here = weighted[i] * rows[b, i]
                t0 += here
                t1 += here * later[i]
                t2 += here * later[i] * later[i]
            normal[0, k, a, b] += t0
            normal[1, k, a, b] += t1
            normal[2, k, a, b] += t2
            if a != b:
                normal[0, k, b, a] += t0
                normal[1, k, b, a] += t1
                normal[2, k, b, a] += t2


@fast_jit
def blur_variance(
    pixels: Pixels,
    texture: Texture,
    pose: PoseState,
    terms: Array,
    stride: int,
    left: NDArray[np.float32],
) -> float:
    """By how much a picture is blurrier than the pattern, texture pixels squared.

    A blur adds half its variance times the pattern's Laplacian.

    Parameters
    ----------
    pixels : Pixels
        Of which each ``stride``-th is looked at.
    texture : Texture
    pose : PoseState
    terms : (C, 6 + 3 L) float64
        As of `padstudio.vision.pose.pattern.block_kernel.Brightness`.
    stride : int
    left : (C, N) float32
        Residuals.
    """
    layers, place, rotation = texture.layers, texture.place, pose.rotation
    h, w = layers.shape[1:]
    bend, across, along = np.empty(len(layers)), 0.0, 0.0
    for i in range(0, len(pixels.row_time), stride):
        x, y, z = pixels.rays[0, i], pixels.rays[1, i], pixels.rays[2, i]
        down = rotation[2, 0] * x + rotation[2, 1] * y + rotation[2, 2] * z
        reach = -pose.centre[2] / down
        there_x = rotation[0, 0] * x + rotation[0, 1] * y + rotation[0, 2] * z
        there_y = rotation[1, 0] * x + rotation[1, 1] * y + rotation[1, 2] * z
        at_x = place[0] + place[1] * (pose.centre[0] + reach * there_x)
        at_y = place[2] + place[3] * (pose.centre[1] + reach * there_y)
        column = int(min(max(at_x + 0.5, 1.0), w - 2.0))
        row = int(min(max(at_y + 0.5, 1.0), h - 2.0))
        for k in range(len(layers)):
            around = layers[k, row - 1, column] + layers[k, row + 1, column]
            around += layers[k, row, column - 1] + layers[k, row, column + 1]
            bend[k] = (around - 4 * layers[k, row, column]) / 2
        for c in range(len(terms)):
            change = 0.0
            for k in range(len(layers)):
                change += terms[c, SHADE + GAIN * k] * bend[k]
            along += change * left[c, i]
            across += change * change
    return along / max(across, 1e-9)
