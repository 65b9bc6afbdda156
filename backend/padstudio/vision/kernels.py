"""Compiled inner loops of the refinement.

Importing Numba takes half a second, so callers import this module where they first need it. Each
loop is the plain form of an equation that the calling module documents.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio.pad.jit import jit
from padstudio.vision.types import Array

_STEPS = 13
_BESIDE = 3


@jit
def picture(
    x: float, y: float, z: float, s: float, pose: Array, matrix: Array, lens: Array
) -> tuple[float, float]:
    """Pixel of a pad point at moment s, NaN behind the camera.

    ``pose`` (6, 3) holds the rotation, the centre, and the shift and turn within the frame.
    """
    k1, k2, p1, p2, k3, k4, k5, k6 = lens
    dx = x - pose[3, 0] - s * pose[4, 0]
    dy = y - pose[3, 1] - s * pose[4, 1]
    dz = z - pose[3, 2] - s * pose[4, 2]
    x = dx * pose[0, 0] + dy * pose[1, 0] + dz * pose[2, 0]
    y = dx * pose[0, 1] + dy * pose[1, 1] + dz * pose[2, 1]
    z = dx * pose[0, 2] + dy * pose[1, 2] + dz * pose[2, 2]
    w0, w1, w2 = s * pose[5, 0], s * pose[5, 1], s * pose[5, 2]
    x, y, z = x - (w1 * z - w2 * y), y - (w2 * x - w0 * z), z - (w0 * y - w1 * x)
    if z <= 1e-6:
        return np.nan, np.nan
    u, v = x / z, y / z
    r2 = u * u + v * v
    radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
    du = u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u)
    dv = v * radial + p1 * (r2 + 2 * v * v) + 2 * p2 * u * v
    px = matrix[0, 0] * du + matrix[0, 1] * dv + matrix[0, 2]
    return px, matrix[1, 1] * dv + matrix[1, 2]


@jit
def stacked(rotation: Array, centre: Array, shift: Array, turn: Array) -> Array:
    """A moving pose as `picture` takes it."""
    pose = np.empty((6, 3))
    pose[:3], pose[3], pose[4], pose[5] = rotation, centre, shift, turn
    return pose


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
    out, pose = np.empty((len(points), 2)), stacked(rotation, centre, shift, turn)
    for i in range(len(points)):
        x, y, z = points[i]
        px, py = picture(x, y, z, 0.0, pose, matrix, lens)
        for _ in range(rounds - 1):
            s = min(0.6, max(-0.6, (py - (height - 1) / 2) / height))
            px, py = picture(x, y, z, s, pose, matrix, lens)
        out[i, 0], out[i, 1] = px, py
    return out


@jit
def project_borders(
    points: Array,
    along: Array,
    across: Array,
    rotation: Array,
    centre: Array,
    shift: Array,
    turn: Array,
    matrix: Array,
    lens: Array,
    height: int,
    rounds: int,
) -> tuple[Array, Array, Array]:
    """As `project`, with the pixels' change over two small steps from each point, (N, 2) each."""
    middle = project(points, rotation, centre, shift, turn, matrix, lens, height, rounds)
    pose = stacked(rotation, centre, shift, turn)
    first, second = np.empty(middle.shape), np.empty(middle.shape)
    for i in range(len(points)):
        x, y, z = points[i]
        s = min(0.6, max(-0.6, (middle[i, 1] - (height - 1) / 2) / height)) if rounds > 1 else 0.0
        # The same moment for all three: what one step changes of it is next to nothing.
        a, b = picture(x, y, z, s, pose, matrix, lens)
        ax, ay = picture(x + along[i, 0], y + along[i, 1], z + along[i, 2], s, pose, matrix, lens)
        bx, by = picture(
            x + across[i, 0], y + across[i, 1], z + across[i, 2], s, pose, matrix, lens
        )
        first[i, 0], first[i, 1] = ax - a, ay - b
        second[i, 0], second[i, 1] = bx - a, by - b
    return middle, first, second


@jit
def find_steps(
    values: NDArray[Any], middle: Array, reach: Array, side: Array, sign: Array
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
