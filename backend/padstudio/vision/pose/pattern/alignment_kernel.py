"""Compiled inner loop of `image_alignment`: the frame against the pattern, pixel by pixel.

One pass over the pixels keeps every intermediate value in the processor's registers; arrays of
them would be some hundred bytes a pixel, and a step's cost that of moving them about.
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
    rays : (N, 3) float64
    row_time : (N,) float64
        When they were read, −0.5 … 0.5 of the frame.
    shade : (N, 6) float64
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
            np.ascontiguousarray(self.rays[::stride]),
            self.row_time[::stride].copy(),
            np.ascontiguousarray(self.shade[::stride]),
            self.tile[::stride].copy(),
            np.ascontiguousarray(self.values[:, ::stride]),
        )

    def between(self, first: int, end: int) -> Pixels:
        """Those of some places in their order."""
        return Pixels(
            self.rays[first:end],
            self.row_time[first:end],
            self.shade[first:end],
            self.tile[first:end],
            np.ascontiguousarray(self.values[:, first:end]),
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


class Block(NamedTuple):
    """Room for what some pixels say, n of `BLOCK`; those beyond their number are weighted 0.

    Attributes
    ----------
    rows : (M, n) float64
        Change with each parameter: of the pose, then the terms of brightness.
    reach : (14, n) float64
        As of `meet_pad`: x, then y.
    slopes : (2 L, n) float64
        Of the layers, per texture pixel.
    left, weight : (n,) float64
        Residuals, and what they are trusted.
    """

    rows: Array
    reach: Array
    slopes: Array
    left: Array
    weight: Array


@fast_jit
def blurred_cells(
    cells: NDArray[np.float32], cell_px: float, sigma_px: float, out: NDArray[np.float32]
) -> None:
    """Rows of cells (n, w) drawn ``cell_px`` high and blurred by a Gaussian, added to (h, w)."""
    n, w = cells.shape
    bend = 1 / (sigma_px * math.sqrt(2.0))
    for y in range(len(out)):
        # Four standard deviations hold all but a ten-thousandth of the light.
        first = max(0, int((y + 0.5 - 4 * sigma_px) / cell_px))
        last = min(n, int((y + 0.5 + 4 * sigma_px) / cell_px) + 1)
        for k in range(first, last):
            upper, lower = k * cell_px - y - 0.5, (k + 1) * cell_px - y - 0.5
            share = np.float32(0.5 * (math.erf(lower * bend) - math.erf(upper * bend)))
            for x in range(w):
                out[y, x] += share * cells[k, x]


@fast_inlined_jit
def meet_pad(ray: Array, s: float, pose: PoseState, out: Array) -> None:
    """Where a ray meets the pad, mm, and how that moves with the pose: (2, 7) into ``out``.

    A ray v of row time s meets z = 0 at C + t d, with d = R(v + s w × v) and t = −C_z / d_z.
    """
    rotation, centre, shift, rotvec = pose
    v0 = ray[0] + s * (rotvec[1] * ray[2] - rotvec[2] * ray[1])
    v1 = ray[1] + s * (rotvec[2] * ray[0] - rotvec[0] * ray[2])
    v2 = ray[2] + s * (rotvec[0] * ray[1] - rotvec[1] * ray[0])
    dx = rotation[0, 0] * v0 + rotation[0, 1] * v1 + rotation[0, 2] * v2
    dy = rotation[1, 0] * v0 + rotation[1, 1] * v1 + rotation[1, 2] * v2
    dz = rotation[2, 0] * v0 + rotation[2, 1] * v1 + rotation[2, 2] * v2
    reach = -(centre[2] + s * shift[2]) / dz
    slopex, slopey = dx / dz, dy / dz
    out[0, 0] = centre[0] + s * shift[0] + reach * dx
    out[1, 0] = centre[1] + s * shift[1] + reach * dy
    out[0, 1], out[0, 2], out[0, 3] = 1.0, 0.0, -slopex
    out[1, 1], out[1, 2], out[1, 3] = 0.0, 1.0, -slopey
    for k in range(3):
        # The k-th unit vector times the ray.
        c0 = ray[2] if k == 1 else -ray[1] if k == 2 else 0.0
        c1 = ray[0] if k == 2 else -ray[2] if k == 0 else 0.0
        c2 = ray[1] if k == 0 else -ray[0] if k == 1 else 0.0
        tx = rotation[0, 0] * c0 + rotation[0, 1] * c1 + rotation[0, 2] * c2
        ty = rotation[1, 0] * c0 + rotation[1, 1] * c1 + rotation[1, 2] * c2
        tz = rotation[2, 0] * c0 + rotation[2, 1] * c1 + rotation[2, 2] * c2
        out[0, 4 + k] = reach * (tx - slopex * tz)
        out[1, 4 + k] = reach * (ty - slopey * tz)


@fast_inlined_jit
def shown_at(layer: NDArray[np.float32], x: float, y: float) -> tuple[float, float, float]:
    """The value of a picture between its pixels and its slopes there; beyond its rim the rim's."""
    h, w = layer.shape
    x, y = min(max(x, 0.0), w - 1.001), min(max(y, 0.0), h - 1.001)
    c, r = np.uintp(x), np.uintp(y)
    fx, fy = x - c, y - r
    here, right = layer[r, c], layer[r, c + 1]
    below, beyond = layer[r + 1, c], layer[r + 1, c + 1]
    top, low = here + fx * (right - here), below + fx * (beyond - below)
    along = right - here + fy * (beyond - below - right + here)
    return float(top + fy * (low - top)), float(along), float(low - top)


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
        1 adds up all of them, which takes less time.
    """
    channels, linear = len(pixels.values), SHADE + GAIN * len(texture.layers)
    width = size + linear
    normal = np.zeros((channels, width, width))
    right, sums = np.zeros((channels, tiles, width)), np.zeros((channels, 4))
    residuals, met = np.empty(pixels.values.shape, np.float32), np.empty((2, 7))
    block = Block(
        np.zeros((width, BLOCK)),
        np.zeros((14, BLOCK)),
        np.zeros((2 * len(texture.layers), BLOCK)),
        np.zeros(BLOCK),
        np.zeros(BLOCK),
    )
    for first in range(0, len(pixels.rays), BLOCK):
        end = min(first + BLOCK, len(pixels.rays))
        for i in range(first, end):
            meet_pad(pixels.rays[i], pixels.row_time[i], pose, met)
            for k in range(7):
                block.reach[k, i - first], block.reach[7 + k, i - first] = met[0, k], met[1, k]
        part = slice(first, end)
        show(block, texture, pixels.shade[part], size)
        for c in range(channels):
            known = brightness.terms[c]
            compare(block, pixels.values[c, part], known, brightness.scale[c], sums[c])
            for i in range(first, end):
                residuals[c, i] = block.left[i - first]
            if size > 0:
                pose_jacobian(block, known, texture.place, pixels.row_time[part], size, sums[c])
            gather(block, pixels.tile[part], normal[c], right[c])
    return Equations(normal, right, sums, residuals)


@fast_jit
def show(block: Block, texture: Texture, shade: Array, size: int) -> None:
    """A block's terms of brightness, and the layers' slopes."""
    terms, slopes, reach, place = block.rows[size:], block.slopes, block.reach, texture.place
    for i in range(len(shade)):
        for a in range(SHADE):
            terms[a, i] = shade[i, a]
    for k in range(len(texture.layers)):
        layer, base = texture.layers[k], SHADE + GAIN * k
        for i in range(len(shade)):
            x, y = place[0] + place[1] * reach[0, i], place[2] + place[3] * reach[7, i]
            shown, slopes[2 * k, i], slopes[2 * k + 1, i] = shown_at(layer, x, y)
            for a in range(GAIN):
                terms[base + a, i] = shown * shade[i, a]


@fast_jit
def compare(
    block: Block, values: NDArray[np.float32], known: Array, scale: float, sums: Array
) -> None:
    """Residuals of a block of pixels and what they are trusted; beyond the block's end nothing."""
    left, weight = block.left, block.weight
    terms = block.rows[len(block.rows) - len(known) :]
    left[:], weight[:] = 0.0, 0.0
    left[: len(values)] = values
    for a in range(len(known)):
        for i in range(len(values)):
            left[i] -= known[a] * terms[a, i]
    bend = 1 / (scale * scale) if scale > 0 else 0.0
    for i in range(len(values)):
        share = 1.0 / (1 + bend * left[i] * left[i])
        weight[i] = share * share
        sums[0] += weight[i] * left[i] * left[i]
        sums[1] += weight[i]
        sums[2] += weight[i] * (4 * share - 3)


@fast_jit
def pose_jacobian(
    block: Block, known: Array, place: Array, row_time: Array, size: int, sums: Array
) -> None:
    """Change of a block's pixels with the pose, into the first ``size`` of its rows."""
    rows, slopes, reach = block.rows, block.slopes, block.reach
    for i in range(len(row_time)):
        along = down = 0.0
        for k in range(len(slopes) // 2):
            gain = 0.0
            for a in range(GAIN):
                gain += known[SHADE + GAIN * k + a] * rows[size + a, i]
            along += gain * slopes[2 * k, i] * place[1]
            down += gain * slopes[2 * k + 1, i] * place[3]
        sums[3] += along * along + down * down
        for a in range(6):
            rows[a, i] = along * reach[1 + a, i] + down * reach[8 + a, i]
        for a in range(6, size):
            rows[a, i] = row_time[i] * rows[a - 6, i]


@fast_jit
def gather(block: Block, tile: NDArray[np.intp], normal: Array, right: Array) -> None:
    """Add a block's normal equations; whole blocks at a time go through vector registers."""
    rows, weight, left = block.rows, block.weight, block.left
    weighted = np.empty(BLOCK)
    for a in range(len(rows)):
        for i in range(BLOCK):
            weighted[i] = weight[i] * rows[a, i]
        for b in range(a + 1):
            total = 0.0
            for i in range(BLOCK):
                total += weighted[i] * rows[b, i]
            normal[a, b] += total
        if len(right) == 1:
            total = 0.0
            for i in range(BLOCK):
                total += weighted[i] * left[i]
            right[0, a] += total
    if len(right) > 1:
        for i in range(len(tile)):
            pull = weight[i] * left[i]
            for a in range(len(rows)):
                right[tile[i], a] += pull * rows[a, i]


@fast_jit
def without_brightness(
    normal: Array, right: Array, size: int, held: float
) -> tuple[Array, Array, Array, Array]:
    """Normal equations of the pose alone: the Schur complement of the L terms of brightness.

    Parameters
    ----------
    normal : (size + L, size + L) float64
        Lower triangle.
    right : (size + L,) float64
    size : int
    held : float
        Terms are held to what they are by this share of what the picture says of them, so that
        those it says nothing of, as of a layer out of view, can be solved for.

    Returns
    -------
    normal : (size, size) float64
    right : (size,) float64
    shared : (L, size) float64
        What of a step of the pose brightness takes over.
    change : (L,) float64
        Of brightness, while the pose stays.
    """
    linear = len(right) - size
    work = np.empty((linear, linear + size + 1))
    for a in range(linear):
        for b in range(linear):
            work[a, b] = normal[size + max(a, b), size + min(a, b)]
        work[a, a] += max(held * work[a, a], 1e-9)
        for k in range(size):
            work[a, linear + k] = normal[size + a, k]
        work[a, linear + size] = right[size + a]
    # Gauss-Jordan; a positive definite matrix needs no pivots.
    for p in range(linear):
        work[p, p:] /= work[p, p]
        for a in range(linear):
            if a != p:
                work[a, p:] -= work[a, p] * work[p, p:]
    shared, change = work[:, linear : linear + size].copy(), work[:, linear + size].copy()
    inner, pull = np.empty((size, size)), right[:size].copy()
    for a in range(size):
        for b in range(size):
            inner[a, b] = normal[max(a, b), min(a, b)]
        for k in range(linear):
            across = normal[size + k, a]
            pull[a] -= across * change[k]
            for b in range(size):
                inner[a, b] -= across * shared[k, b]
    return inner, pull, shared, change
