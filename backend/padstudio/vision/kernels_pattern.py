"""Compiled inner loop of `padstudio.vision.align`: the frame against the pattern, pixel by pixel.

One pass over the pixels keeps every intermediate value in the processor's registers; arrays of
them would be some hundred bytes a pixel, and a step's cost that of moving them about.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.pad.jit import fast_jit
from padstudio.vision.types import Array

#: Terms of a shading; those that a layer's gain shares with it come first.
SHADE, GAIN = 6, 3


@fast_jit
def blurred_cells(
    cells: NDArray[np.float32], cell_px: float, sigma_px: float, length: int
) -> NDArray[np.float32]:
    """Rows of cells (n, w) drawn ``cell_px`` high and blurred by a Gaussian, (length, w)."""
    n, w = cells.shape
    out = np.zeros((length, w), np.float32)
    bend = 1 / (sigma_px * math.sqrt(2.0))
    for y in range(length):
        # Four standard deviations hold all but a ten-thousandth of the light.
        first = max(0, int((y + 0.5 - 4 * sigma_px) / cell_px))
        last = min(n, int((y + 0.5 + 4 * sigma_px) / cell_px) + 1)
        for k in range(first, last):
            upper, lower = k * cell_px - y - 0.5, (k + 1) * cell_px - y - 0.5
            share = np.float32(0.5 * (math.erf(lower * bend) - math.erf(upper * bend)))
            for x in range(w):
                out[y, x] += share * cells[k, x]
    return out


@fast_jit
def meet_pad(
    ray: Array, s: float, rotation: Array, centre: Array, shift: Array, turn: Array, out: Array
) -> None:
    """Where a ray meets the pad, mm, and how that moves with centre and turn: (2, 7) into ``out``.

    A ray v of moment s meets z = 0 at C + t d, with d = R(v + s w × v) and t = −C_z / d_z.
    """
    v0 = ray[0] + s * (turn[1] * ray[2] - turn[2] * ray[1])
    v1 = ray[1] + s * (turn[2] * ray[0] - turn[0] * ray[2])
    v2 = ray[2] + s * (turn[0] * ray[1] - turn[1] * ray[0])
    dx = rotation[0, 0] * v0 + rotation[0, 1] * v1 + rotation[0, 2] * v2
    dy = rotation[1, 0] * v0 + rotation[1, 1] * v1 + rotation[1, 2] * v2
    dz = rotation[2, 0] * v0 + rotation[2, 1] * v1 + rotation[2, 2] * v2
    reach = -(centre[2] + s * shift[2]) / dz
    leanx, leany = dx / dz, dy / dz
    out[0, 0] = centre[0] + s * shift[0] + reach * dx
    out[1, 0] = centre[1] + s * shift[1] + reach * dy
    out[0, 1], out[0, 2], out[0, 3] = 1.0, 0.0, -leanx
    out[1, 1], out[1, 2], out[1, 3] = 0.0, 1.0, -leany
    for k in range(3):
        # The k-th unit vector times the ray.
        c0 = ray[2] if k == 1 else -ray[1] if k == 2 else 0.0
        c1 = ray[0] if k == 2 else -ray[2] if k == 0 else 0.0
        c2 = ray[1] if k == 0 else -ray[0] if k == 1 else 0.0
        tx = rotation[0, 0] * c0 + rotation[0, 1] * c1 + rotation[0, 2] * c2
        ty = rotation[1, 0] * c0 + rotation[1, 1] * c1 + rotation[1, 2] * c2
        tz = rotation[2, 0] * c0 + rotation[2, 1] * c1 + rotation[2, 2] * c2
        out[0, 4 + k] = reach * (tx - leanx * tz)
        out[1, 4 + k] = reach * (ty - leany * tz)


@fast_jit
def bilinear(layer: NDArray[np.float32], x: float, y: float) -> float:
    """The value of a picture between its pixels; beyond its rim that of the rim."""
    h, w = layer.shape
    x, y = min(max(x, 0.0), w - 1.001), min(max(y, 0.0), h - 1.001)
    c, r = int(x), int(y)
    fx, fy = x - c, y - r
    top = layer[r, c] * (1 - fx) + layer[r, c + 1] * fx
    low = layer[r + 1, c] * (1 - fx) + layer[r + 1, c + 1] * fx
    return float(top * (1 - fy) + low * fy)


@fast_jit
def match_pattern(
    rays: Array,
    moment: Array,
    shade: Array,
    tile: NDArray[np.intp],
    tiles: int,
    values: NDArray[np.float32],
    layers: NDArray[np.float32],
    place: Array,
    rotation: Array,
    centre: Array,
    shift: Array,
    turn: Array,
    known: Array,
    scale: Array,
    size: int,
) -> tuple[Array, Array, Array, NDArray[np.float32]]:
    """Normal equations of pose and brightness, for each of C channels.

    Parameters
    ----------
    rays, moment, shade, tile : (N, 3), (N,), (N, 6) float64, (N,) int
        As of `padstudio.vision.pattern.Pixels`; tiles are 0 … ``tiles`` − 1.
    values : (C, N) float32
    layers : (L, h, w) float32
    place : (4,) float64
        Texture pixel of pad points: x = place[0] + place[1] X, y = place[2] + place[3] Y.
    rotation, centre, shift, turn
        As of `padstudio.vision.motion.MovingPose`.
    known : (C, 6 + 3 L) float64
        Brightness: the shading, then each layer's gain.
    scale : (C,) float64
        Residuals beyond it are trusted little; 0 trusts all alike.
    size : int
        Parameters of the pose that are sought: 0, 6 or 12.

    Returns
    -------
    normal : (C, M, M) float64
        Lower triangle, M = size + 6 + 3 L.
    right : (C, tiles, M) float64
    sums : (C, 4) float64
        Of weighted squared residuals, of weights, of the weights' steepness (as of
        `padstudio.vision.covariance.newton_share`), and of squared slopes per mm.
    residuals : (C, N) float32
    """
    count, linear = len(layers), SHADE + GAIN * len(layers)
    width = size + linear
    normal = np.zeros((len(values), width, width))
    right, sums = np.zeros((len(values), tiles, width)), np.zeros((len(values), 4))
    residuals = np.empty(values.shape, np.float32)
    row, met, slopes = np.empty(width), np.empty((2, 7)), np.empty((count, 2))
    for i in range(len(rays)):
        meet_pad(rays[i], moment[i], rotation, centre, shift, turn, met)
        x, y = place[0] + place[1] * met[0, 0], place[2] + place[3] * met[1, 0]
        for a in range(SHADE):
            row[size + a] = shade[i, a]
        for k in range(count):
            shown = bilinear(layers[k], x, y)
            for a in range(GAIN):
                row[size + SHADE + GAIN * k + a] = shown * shade[i, a]
            if size > 0:
                layer = layers[k]
                slopes[k, 0] = bilinear(layer, x + 0.5, y) - bilinear(layer, x - 0.5, y)
                slopes[k, 1] = bilinear(layer, x, y + 0.5) - bilinear(layer, x, y - 0.5)
        for c in range(len(values)):
            left = float(values[c, i])
            for a in range(linear):
                left -= known[c, a] * row[size + a]
            residuals[c, i] = left
            share = 1.0
            if scale[c] > 0:
                share = 1 / (1 + (left / scale[c]) ** 2)
            weight = share * share
            if size > 0:
                along, down = 0.0, 0.0
                for k in range(count):
                    gain = 0.0
                    for a in range(GAIN):
                        gain += known[c, SHADE + GAIN * k + a] * shade[i, a]
                    along += gain * slopes[k, 0] * place[1]
                    down += gain * slopes[k, 1] * place[3]
                sums[c, 3] += along * along + down * down
                for a in range(6):
                    row[a] = along * met[0, 1 + a] + down * met[1, 1 + a]
                for a in range(6, size):
                    row[a] = moment[i] * row[a - 6]
            sums[c, 0] += weight * left * left
            sums[c, 1] += weight
            sums[c, 2] += weight * (4 * share - 3)
            for a in range(width):
                t = weight * row[a]
                right[c, tile[i], a] += t * left
                for b in range(a + 1):
                    normal[c, a, b] += t * row[b]
    return normal, right, sums, residuals
