"""Compiled inner loops of the refinement.

Importing Numba takes half a second, so callers import this module where they first need it. Each
loop is the plain form of an equation that the calling module documents.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.pad.jit import jit
from padstudio.vision.types import Array

_STEPS = 13
_BESIDE = 3


@jit
def project(
    points: Array,
    rotation: Array,
    centre: Array,
    shift: Array,
    turn: Array,
    matrix: Array,
    lens: Array,
    height: int,
    rounds: int,
) -> Array:
    """Pixels (N, 2) of pad points under a moving pose and a radial-tangential lens of 8 terms."""
    out = np.empty((len(points), 2))
    k1, k2, p1, p2, k3, k4, k5, k6 = lens
    for i in range(len(points)):
        s = 0.0
        px = py = np.nan
        for _ in range(rounds):
            dx = points[i, 0] - centre[0] - s * shift[0]
            dy = points[i, 1] - centre[1] - s * shift[1]
            dz = points[i, 2] - centre[2] - s * shift[2]
            x = dx * rotation[0, 0] + dy * rotation[1, 0] + dz * rotation[2, 0]
            y = dx * rotation[0, 1] + dy * rotation[1, 1] + dz * rotation[2, 1]
            z = dx * rotation[0, 2] + dy * rotation[1, 2] + dz * rotation[2, 2]
            if s != 0.0:
                w0, w1, w2 = s * turn[0], s * turn[1], s * turn[2]
                x, y, z = x - (w1 * z - w2 * y), y - (w2 * x - w0 * z), z - (w0 * y - w1 * x)
            if z <= 1e-6:
                px = py = np.nan
                break
            u, v = x / z, y / z
            r2 = u * u + v * v
            radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
            du = u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u)
            dv = v * radial + p1 * (r2 + 2 * v * v) + 2 * p2 * u * v
            px = matrix[0, 0] * du + matrix[0, 1] * dv + matrix[0, 2]
            py = matrix[1, 1] * dv + matrix[1, 2]
            s = min(0.6, max(-0.6, (py - (height - 1) / 2) / height))
        out[i, 0], out[i, 1] = px, py
    return out


@jit
def find_steps(
    values: NDArray[np.float32], middle: Array, reach: Array, side: Array, sign: Array
) -> Array:
    """See `padstudio.vision.borders`: shift in units of reach, rise and spent slope, (N, 3)."""
    h, w = values.shape
    out = np.zeros((len(middle), 3))
    profile = np.empty(_STEPS)
    for i in range(len(middle)):
        for k in range(_STEPS):
            t = -1 + 2 * k / (_STEPS - 1)
            total = 0.0
            for b in range(_BESIDE):
                f = (b - 1) / (_BESIDE - 1)
                x = middle[i, 0] + f * side[i, 0] + t * reach[i, 0]
                y = middle[i, 1] + f * side[i, 1] + t * reach[i, 1]
                x, y = min(max(x, 0.0), w - 1.001), min(max(y, 0.0), h - 1.001)
                c, r = int(x), int(y)
                fx, fy = x - c, y - r
                top = values[r, c] * (1 - fx) + values[r, c + 1] * fx
                low = values[r + 1, c] * (1 - fx) + values[r + 1, c + 1] * fx
                total += top * (1 - fy) + low * fy
            profile[k] = total / _BESIDE
        weighted = power = rise = spent = 0.0
        for k in range(_STEPS - 1):
            slope = (profile[k + 1] - profile[k]) * sign[i]
            spent += abs(slope)
            if slope > 0:
                rise += slope
                power += slope * slope
                weighted += slope * slope * (-1 + (2 * k + 1) / (_STEPS - 1))
        if power > 0:
            out[i, 0] = weighted / power
        out[i, 1], out[i, 2] = rise, spent
    return out


@jit
def linearize(
    points: Array,
    along: Array,
    rays: Array,
    moment: Array,
    rotation: Array,
    centre: Array,
    shift: Array,
    turn: Array,
) -> Array:
    """See `padstudio.vision.refine`: residual and its change with centre and turn, (N, 7)."""
    out = np.empty((len(points), 7))
    seen = np.empty((2, 3))
    for i in range(len(points)):
        s = moment[i]
        for k in range(2):
            f = 0.2 * k
            dx = points[i, 0] + f * along[i, 0] - centre[0] - s * shift[0]
            dy = points[i, 1] + f * along[i, 1] - centre[1] - s * shift[1]
            dz = points[i, 2] + f * along[i, 2] - centre[2] - s * shift[2]
            x = dx * rotation[0, 0] + dy * rotation[1, 0] + dz * rotation[2, 0]
            y = dx * rotation[0, 1] + dy * rotation[1, 1] + dz * rotation[2, 1]
            z = dx * rotation[0, 2] + dy * rotation[1, 2] + dz * rotation[2, 2]
            w0, w1, w2 = s * turn[0], s * turn[1], s * turn[2]
            seen[k, 0] = x - (w1 * z - w2 * y)
            seen[k, 1] = y - (w2 * x - w0 * z)
            seen[k, 2] = z - (w0 * y - w1 * x)
        x, y, z = seen[0]
        u, v = x / z, y / z
        tu, tv = seen[1, 0] / seen[1, 2] - u, seen[1, 1] / seen[1, 2] - v
        length = max(math.sqrt(tu * tu + tv * tv), 1e-15)
        nu, nv = -tv / length, tu / length
        out[i, 0] = (rays[i, 0] - u) * nu + (rays[i, 1] - v) * nv
        g0, g1, g2 = nu / z, nv / z, -(nu * u + nv * v) / z
        for k in range(3):
            out[i, 1 + k] = -(g0 * rotation[k, 0] + g1 * rotation[k, 1] + g2 * rotation[k, 2])
        out[i, 4] = -(y * g2 - z * g1)
        out[i, 5] = -(z * g0 - x * g2)
        out[i, 6] = -(x * g1 - y * g0)
    return out


@jit
def normal_equations(rows: Array, moment: Array, weight: Array, size: int) -> tuple[Array, Array]:
    """Weighted normal matrix (size, size) and right side of linearized rows (N, 7)."""
    normal, right, j = np.zeros((size, size)), np.zeros(size), np.empty(12)
    for i in range(len(rows)):
        w = weight[i]
        if w <= 0:
            continue
        for k in range(6):
            j[k] = rows[i, 1 + k]
            j[6 + k] = moment[i] * j[k]
        for a in range(size):
            t = w * j[a]
            right[a] += t * rows[i, 0]
            for b in range(a + 1):
                normal[a, b] += t * j[b]
    for a in range(size):
        for b in range(a):
            normal[b, a] = normal[a, b]
    return normal, right


@jit
def look_up(layer: NDArray[np.float32], x: Array, y: Array) -> tuple[Array, Array]:
    """See `padstudio.vision.pattern`: bilinear values (N,), and slopes (N, 2) over a pixel."""
    h, w = layer.shape
    value, slope, near = np.empty(len(x)), np.empty((len(x), 2)), np.empty(5)
    for i in range(len(x)):
        for k in range(5):
            # The place itself, then half a pixel to the left, right, top and bottom of it.
            px = x[i] + (0.5 if k == 2 else -0.5 if k == 1 else 0.0)
            py = y[i] + (0.5 if k == 4 else -0.5 if k == 3 else 0.0)
            px, py = min(max(px, 0.0), w - 1.001), min(max(py, 0.0), h - 1.001)
            c, r = int(px), int(py)
            fx, fy = px - c, py - r
            top = layer[r, c] * (1 - fx) + layer[r, c + 1] * fx
            low = layer[r + 1, c] * (1 - fx) + layer[r + 1, c + 1] * fx
            near[k] = top * (1 - fy) + low * fy
        value[i] = near[0]
        slope[i, 0], slope[i, 1] = near[2] - near[1], near[4] - near[3]
    return value, slope
