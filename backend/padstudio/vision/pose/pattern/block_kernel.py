"""Compiled blocks of pixels, and what a pattern shows at them.

Pixels go through in blocks that the processor's first cache holds; arrays of all they say would be
some hundred bytes a pixel, and a step's cost that of moving them about.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_inlined_jit, fast_jit
from padstudio.geometry.projection import PoseState

#: Terms of a shading; those that a layer's gain shares with it come first.
SHADE, GAIN = 6, 3
#: Pixels that are gathered at a time.
BLOCK = 64


class Texture(NamedTuple):
    """The pad's layers as brightness over the pad frame, at a frame's scale.

    Attributes
    ----------
    layers : (L, h, w) float32
        0 … 1, blurred as the camera does, in the order of ``pad.layers``.
    place : (4,) float64
        Texture pixel of pad points, mm: x = place[0] + place[1] X, y = place[2] + place[3] Y.
    """

    layers: NDArray[np.float32]
    place: Array


class Pixels(NamedTuple):
    """Pixels of the frame that show the pad.

    Attributes
    ----------
    rays : (3, N) float64
    row_time : (N,) float64
        When they were read, −0.5 … 0.5 of the frame; rising.
    shade : (6, N) float64
        Terms of a smooth shading.
    tile : (N,) int
        Part of the picture, as of `padstudio.vision.pose.covariance.tiles_of`.
    values : (C, N) float32
        Of the channels of ``pad.layers``, in their order.
    """

    rays: Array
    row_time: Array
    shade: Array
    tile: NDArray[np.intp]
    values: NDArray[np.float32]

    def thinned(self, most: int) -> Pixels:
        """At most ``most`` of the pixels, evenly spread."""
        stride = -(-len(self.row_time) // most)
        if stride <= 1:
            return self
        return Pixels(
            np.ascontiguousarray(self.rays[:, ::stride]),
            self.row_time[::stride].copy(),
            np.ascontiguousarray(self.shade[:, ::stride]),
            self.tile[::stride].copy(),
            np.ascontiguousarray(self.values[:, ::stride]),
        )


class Brightness(NamedTuple):
    """How each of C channels shows L layers.

    Attributes
    ----------
    terms : (C, 6 + 3 L) float64
        The shading, then each layer's gain.
    scale : (C,) float64
        Residuals beyond it are trusted little; 0 trusts all alike.
    """

    terms: Array
    scale: Array


class Block(NamedTuple):
    """Room for what some pixels say, n of `BLOCK`; those beyond their number are weighted 0.

    Attributes
    ----------
    rows : (M, n) float64
        Change with each parameter: of the pose, then the terms of brightness.
    met : (3, n) float64
        Slopes of the rays over the pad, and how far they reach, as of `meet_pad`.
    at : (2, n) float64
        Where they meet it, texture pixels.
    corners : (4, n) float32
        The texture's pixels about them, of one layer.
    slopes : (2 L, n) float64
        Of the layers, per mm along X and Y.
    left, weight, scratch : (n,) float64
        Residuals, what they are trusted, and the product of both.
    sums : (4,) float64
        As of `Equations`.
    """

    rows: Array
    met: Array
    at: Array
    corners: NDArray[np.float32]
    slopes: Array
    left: Array
    weight: Array
    scratch: Array
    sums: Array


@fast_jit
def room(size: int, layers: int) -> Block:
    """A block for a pose of so many parameters, and a pattern of so many layers."""
    return Block(
        np.zeros((size + SHADE + GAIN * layers, BLOCK)),
        np.zeros((3, BLOCK)),
        np.zeros((2, BLOCK)),
        np.zeros((4, BLOCK), np.float32),
        np.zeros((2 * layers, BLOCK)),
        np.zeros(BLOCK),
        np.zeros(BLOCK),
        np.zeros(BLOCK),
        np.zeros(4),
    )


@fast_inlined_jit
def show(
    block: Block, texture: Texture, pixels: Pixels, part: tuple[int, int], pose: PoseState
) -> None:
    """A block's terms of brightness, its rays and the layers' slopes; the last rows are terms."""
    layers, place, at = texture.layers, texture.place, block.at
    h, w = layers.shape[1:]
    first, count = part[0], part[1] - part[0]
    meet_pad(block, pixels, part, pose)
    # Beyond the texture's rim the rim's.
    for i in range(count):
        at[0, i] = min(max(place[0] + place[1] * at[0, i], 0.0), w - 1.001)
    for i in range(count):
        at[1, i] = min(max(place[2] + place[3] * at[1, i], 0.0), h - 1.001)
    terms = block.rows[len(block.rows) - SHADE - GAIN * len(layers) :]
    for a in range(SHADE):
        for i in range(count):
            terms[a, i] = pixels.shade[a, first + i]
    for k in range(len(layers)):
        look_up(block, layers[k], count)
        between(block, place[1], place[3], k)


@fast_inlined_jit
def meet_pad(block: Block, pixels: Pixels, part: tuple[int, int], pose: PoseState) -> None:
    """Where a block's rays meet the pad, mm, their slopes over it along X and Y, and their reach.

    A ray v of row time s has the direction d = R(v + s w × v). From the centre C it meets z = 0
    at the reach t = −C_z / d_z, at C_x − C_z d_x / d_z, and likewise along Y. Loops of one result
    each go through vector registers.
    """
    first, end = part
    x, y, z = pixels.rays[0, first:end], pixels.rays[1, first:end], pixels.rays[2, first:end]
    s, (slope_x, slope_y, reach), (at_x, at_y) = pixels.row_time[first:end], block.met, block.at
    a, b = rolled(pose, 2), rolled(pose, 0)
    for i in range(len(s)):
        reach[i] = 1 / (
            (a[0] + s[i] * a[3]) * x[i] + (a[1] + s[i] * a[4]) * y[i] + (a[2] + s[i] * a[5]) * z[i]
        )
    for i in range(len(s)):
        slope_x[i] = reach[i] * (
            (b[0] + s[i] * b[3]) * x[i] + (b[1] + s[i] * b[4]) * y[i] + (b[2] + s[i] * b[5]) * z[i]
        )
    b = rolled(pose, 1)
    for i in range(len(s)):
        slope_y[i] = reach[i] * (
            (b[0] + s[i] * b[3]) * x[i] + (b[1] + s[i] * b[4]) * y[i] + (b[2] + s[i] * b[5]) * z[i]
        )
    cx, cy, cz = pose.centre[0], pose.centre[1], pose.centre[2]
    mx, my, mz = pose.shift[0], pose.shift[1], pose.shift[2]
    for i in range(len(s)):
        reach[i] *= -(cz + s[i] * mz)
    for i in range(len(s)):
        at_x[i] = cx + s[i] * mx - (cz + s[i] * mz) * slope_x[i]
    for i in range(len(s)):
        at_y[i] = cy + s[i] * my - (cz + s[i] * mz) * slope_y[i]


@fast_inlined_jit
def rolled(pose: PoseState, k: int) -> tuple[float, float, float, float, float, float]:
    """The k-th row of the rotation, and its change with the row time."""
    r0, r1, r2 = pose.rotation[k, 0], pose.rotation[k, 1], pose.rotation[k, 2]
    w0, w1, w2 = pose.rotvec[0], pose.rotvec[1], pose.rotvec[2]
    return r0, r1, r2, r1 * w2 - r2 * w1, r2 * w0 - r0 * w2, r0 * w1 - r1 * w0


@fast_inlined_jit
def look_up(block: Block, layer: NDArray[np.float32], count: int) -> None:
    """A layer's pixels about those of a block."""
    at, corners = block.at, block.corners
    for i in range(count):
        # By way of signed ones, to which the processor turns figures at once.
        c, r = np.uintp(int(at[0, i])), np.uintp(int(at[1, i]))
        right, below = c + np.uintp(1), r + np.uintp(1)
        corners[0, i], corners[1, i] = layer[r, c], layer[r, right]
        corners[2, i], corners[3, i] = layer[below, c], layer[below, right]


@fast_inlined_jit
def between(block: Block, x_per_mm: float, y_per_mm: float, k: int) -> None:
    """What the k-th layer shows between its pixels, times what its gain shares with the shading,
    and its slopes."""
    (x, y), (here, aside, below, beyond) = block.at, block.corners
    along, down, top, low = block.slopes[2 * k], block.slopes[2 * k + 1], block.left, block.weight
    terms = block.rows[len(block.rows) - SHADE - GAIN * (len(block.slopes) // 2) :]
    shown = terms[SHADE + GAIN * k]
    for i in range(BLOCK):
        top[i] = here[i] + (x[i] - math.floor(x[i])) * (float(aside[i]) - float(here[i]))
    for i in range(BLOCK):
        low[i] = below[i] + (x[i] - math.floor(x[i])) * (float(beyond[i]) - float(below[i]))
    for i in range(BLOCK):
        down[i] = low[i] - top[i]
    for i in range(BLOCK):
        shown[i] = top[i] + (y[i] - math.floor(y[i])) * down[i]
    for i in range(BLOCK):
        steep = float(aside[i]) - float(here[i])
        more = float(beyond[i]) - float(below[i]) - steep
        along[i] = steep + (y[i] - math.floor(y[i])) * more
    for i in range(BLOCK):
        along[i] *= x_per_mm
        down[i] *= y_per_mm
    for a in range(1, GAIN):
        for i in range(BLOCK):
            terms[SHADE + GAIN * k + a, i] = shown[i] * terms[a, i]
