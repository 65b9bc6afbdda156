"""Compiled inner loop of `image_alignment`: the frame against the pattern, pixel by pixel."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_inlined_jit, fast_jit
from padstudio.geometry.projection import PoseState
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


class Equations(NamedTuple):
    """Normal equations of pose and brightness, for each of C channels; M = size + 6 + 3 L.

    Attributes
    ----------
    normal : (C, M, M) float64
        Lower triangle.
    right : (C, tiles, M) float64
    sums : (C, 4) float64
        Of weighted squared residuals, of weights, of the weights' steepness (as of
        `padstudio.vision.pose.covariance.newton_share`), and of squared slopes per mm.
    residuals : (C, N) float32
    """

    normal: Array
    right: Array
    sums: Array
    residuals: NDArray[np.float32]


@fast_jit
def match_pattern(
    pixels: Pixels,
    texture: Texture,
    pose: PoseState,
    brightness: Brightness,
    size: int,
    tiles: int,
) -> Equations:
    """Normal equations of pose and brightness.

    Parameters
    ----------
    pixels : Pixels
        Their tiles are 0 … ``tiles`` − 1.
    texture : Texture
    pose : PoseState
    brightness : Brightness
    size : int
        Parameters of the pose that are sought: 0, 6 or 12.
    tiles : int
        1 adds up all of them, which takes less time; 0 does so, too, and leaves the normal matrix
        out, which takes a third.
    """
    channels, layers = len(pixels.values), len(texture.layers)
    block = room(size, layers)
    width = len(block.rows)
    normal = np.zeros((channels, width, width))
    right, sums = np.zeros((channels, max(tiles, 1), width)), np.zeros((channels, 4))
    residuals = np.empty(pixels.values.shape, np.float32)
    for first in range(0, len(pixels.row_time), BLOCK):
        end = min(first + BLOCK, len(pixels.row_time))
        show(block, texture, pixels, (first, end), pose)
        for c in range(channels):
            linearize(block, pixels, (first, end), brightness, c, pose.rotation)
            sums[c] += block.sums
            residuals[c, first:end] = block.left[: end - first]
            if tiles > 0:
                gather(block, normal[c])
            if tiles > 1:
                pull_tiles(block, pixels.tile[first:end], right[c])
            else:
                for a in range(width):
                    right[c, 0, a] += dot(block.scratch, block.rows[a])
    return Equations(normal, right, sums, residuals)


@fast_inlined_jit
def linearize(
    block: Block,
    pixels: Pixels,
    part: tuple[int, int],
    brightness: Brightness,
    c: int,
    rotation: Array,
) -> None:
    """A block's rows and residuals in a channel; its scratch holds those as they are trusted."""
    known, rows, first = brightness.terms[c], block.rows, part[0]
    size = len(rows) - len(known)
    slopes = 0.0
    if size > 0:
        pose_jacobian(block, known, pixels, part, rotation)
        for i in range(part[1] - first):
            slopes += rows[0, i] * rows[0, i] + rows[1, i] * rows[1, i]
    for k in range(6, size):
        for i in range(part[1] - first):
            rows[k, i] = pixels.row_time[first + i] * rows[k - 6, i]
    compare(block, pixels.values[c, first : part[1]], known, brightness.scale[c])
    block.sums[3] = slopes
    for i in range(BLOCK):
        block.scratch[i] = block.weight[i] * block.left[i]


@fast_inlined_jit
def compare(block: Block, values: NDArray[np.float32], known: Array, scale: float) -> None:
    """Residuals of a block of pixels and what they are trusted; beyond the block's end nothing."""
    left, weight = block.left, block.weight
    terms = block.rows[len(block.rows) - len(known) :]
    for i in range(len(values), BLOCK):
        left[i] = weight[i] = 0.0
    for i in range(len(values)):
        left[i] = values[i]
    for a in range(len(known)):
        for i in range(len(values)):
            left[i] -= known[a] * terms[a, i]
    bend = 1 / (scale * scale) if scale > 0 else 0.0
    squares = weights = steep = 0.0
    for i in range(len(values)):
        share = 1.0 / (1 + bend * left[i] * left[i])
        weight[i] = share * share
        squares += weight[i] * left[i] * left[i]
        weights += weight[i]
        steep += weight[i] * (4 * share - 3)
    block.sums[0], block.sums[1], block.sums[2] = squares, weights, steep


@fast_inlined_jit
def pose_jacobian(
    block: Block, known: Array, pixels: Pixels, part: tuple[int, int], rotation: Array
) -> None:
    """Change of a block's pixels with centre and attitude, into the first six of its rows.

    The centre moves the meeting point by itself, its height by the slopes; a turn w moves the
    ray's direction by R(w × v), and with g the gradient g · R(w × v) = w · (v × Rᵀ g).
    """
    rows, (slope_x, slope_y, reach) = block.rows, block.met
    shade = rows[len(rows) - len(known) :]
    along, down, high, gain = rows[0], rows[1], rows[2], block.left
    for i in range(BLOCK):
        along[i] = down[i] = 0.0
    for k in range(len(block.slopes) // 2):
        base = SHADE + GAIN * k
        for i in range(BLOCK):
            gain[i] = known[base] + known[base + 1] * shade[1, i] + known[base + 2] * shade[2, i]
        for i in range(BLOCK):
            along[i] += gain[i] * block.slopes[2 * k, i]
        for i in range(BLOCK):
            down[i] += gain[i] * block.slopes[2 * k + 1, i]
    for i in range(BLOCK):
        high[i] = -(along[i] * slope_x[i] + down[i] * slope_y[i])
    first, end = part
    for k in range(3):
        # About each axis the ray's other two parts count, and the gradient along those.
        m, n = (k + 1) % 3, (k + 2) % 3
        one, other = pixels.rays[m, first:end], pixels.rays[n, first:end]
        a0, a1, a2 = rotation[0, m], rotation[1, m], rotation[2, m]
        b0, b1, b2 = rotation[0, n], rotation[1, n], rotation[2, n]
        turn = rows[3 + k]
        for i in range(len(one)):
            turn[i] = one[i] * (b0 * along[i] + b1 * down[i] + b2 * high[i])
        for i in range(len(one)):
            turn[i] -= other[i] * (a0 * along[i] + a1 * down[i] + a2 * high[i])
        for i in range(len(one)):
            turn[i] *= reach[i]


@fast_inlined_jit
def gather(block: Block, normal: Array) -> None:
    """Add a block's normal matrix; whole blocks at a time go through vector registers."""
    rows, weight, weighted = block.rows, block.weight, block.at[0]
    for a in range(len(rows)):
        for i in range(BLOCK):
            weighted[i] = weight[i] * rows[a, i]
        # Four at a time load the weighted row once.
        for b in range(0, a - 2, 4):
            t0 = t1 = t2 = t3 = 0.0
            for i in range(BLOCK):
                t0 += weighted[i] * rows[b, i]
                t1 += weighted[i] * rows[b + 1, i]
                t2 += weighted[i] * rows[b + 2, i]
                t3 += weighted[i] * rows[b + 3, i]
            normal[a, b], normal[a, b + 1] = normal[a, b] + t0, normal[a, b + 1] + t1
            normal[a, b + 2], normal[a, b + 3] = normal[a, b + 2] + t2, normal[a, b + 3] + t3
        for b in range((a + 1) // 4 * 4, a + 1):
            normal[a, b] += dot(weighted, rows[b])


@fast_inlined_jit
def pull_tiles(block: Block, tile: NDArray[np.intp], right: Array) -> None:
    """Add a block's right sides, each to its tile's."""
    for i in range(len(tile)):
        for a in range(len(block.rows)):
            right[tile[i], a] += block.scratch[i] * block.rows[a, i]


@fast_inlined_jit
def dot(one: Array, other: Array) -> float:
    """Scalar product of two rows of a block."""
    total = 0.0
    for i in range(BLOCK):
        total += one[i] * other[i]
    return total
