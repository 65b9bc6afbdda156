"""Compiled inner loops of the search for lattices; see `padstudio.geometry.projection`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit

# An edge weighs at most this much: an angle that a turn in the picture turns six times as far tells
# little but noise.
_MOST_WEIGHT = 6.0
# Edges seen along the plane by less than this sine, 3 degrees, lie beyond the horizon for all we
# know.
_LEAST_DEPTH = 0.05
#: Below this cosine of tilt, at 80 degrees, a plane is seen too flat to be read.
LEAST_COSINE = 0.17
# A climb begins with steps of about half the distance of starts, and ends where steps this small
# lead nowhere.
_FIRST_STEP_DEG, _LEAST_STEP_DEG = 6.0, 0.15
# Steps above this are led by a few of the edges.
_FINE_STEP_DEG = 1.0
# Axes are turned to fit the edges' angles in the picture: first and last cut-off, radians, and
# steps: the cut-off has reached its last value after half of them.
_FIRST_CUT, _LAST_CUT, _TURNS = 0.25, 0.05, 16
# So many edges tell how: three unknowns.
_TURNING_EDGES = 1200


class Edges(NamedTuple):
    """Edges as the search for planes takes them.

    Attributes
    ----------
    rays : (N, 3) float64
        Unit vectors.
    lines : (N, 3) float64
        As of `padstudio.vision.search.edges.EdgeSet`.
    """

    rays: Array
    lines: Array


@fast_jit
def coherence(normals: Array, edges: Edges) -> NDArray[np.complex128]:
    """See `padstudio.vision.search.plane_normals`: one complex coherence a normal, (H,)."""
    rays, lines = edges
    out = np.zeros(len(normals), np.complex128)
    depth = np.empty(len(rays))
    for h in range(len(normals)):
        n0, n1, n2 = normals[h]
        (a0, a1, a2), (b0, b1, b2) = basis_of(n0, n1, n2)
        deepest, front = 1e-3, 0
        for e in range(len(rays)):
            d = rays[e, 0] * n0 + rays[e, 1] * n1 + rays[e, 2] * n2
            depth[e] = d
            deepest = max(deepest, d)
            front += d > _LEAST_DEPTH
        real = imaginary = squares = nearness = 0.0
        for e in range(len(rays)):
            if depth[e] <= 0:
                continue
            near = (depth[e] / deepest) ** 2
            x = -(lines[e, 0] * b0 + lines[e, 1] * b1 + lines[e, 2] * b2)
            y = lines[e, 0] * a0 + lines[e, 1] * a1 + lines[e, 2] * a2
            size2 = max(x * x + y * y, 1e-9)
            weight = min(depth[e] / size2, _MOST_WEIGHT)
            u, v = (x * x - y * y) / size2, 2 * x * y / size2
            real += near * weight * (u * u - v * v)
            imaginary += near * weight * 2 * u * v
            squares += near * weight * weight
            nearness += near
        norm = math.sqrt(squares * nearness)
        if norm > 1e-9:
            share = front / len(rays)
            out[h] = complex(real / norm * share, imaginary / norm * share)
    return out


@fast_jit
def climb(normal: Array, few: Edges, edges: Edges) -> tuple[float, Array]:
    """See `plane_normals`: the nearest maximum of coherence, and the axes (3, 3) there.

    A normal walks there by shrinking steps, the large ones by a few of the edges; the axes are then
    turned until edges point along them.
    """
    around = np.empty((9, 3))
    best = normal.copy()
    step_deg = _FIRST_STEP_DEG
    while step_deg > _LEAST_STEP_DEG:
        size = math.tan(math.radians(step_deg * max(best[2], 0.25)))
        x, y, z = best
        (s0, s1, s2), (t0, t1, t2) = basis_of(x, y, z)
        for k in range(9):
            # The place itself comes first, so that it wins a draw.
            place = (k + 4) % 9
            i, j = size * (place // 3 - 1), size * (place % 3 - 1)
            a, b, c = x + i * s0 + j * t0, y + i * s1 + j * t1, z + i * s2 + j * t2
            norm = math.sqrt(a * a + b * b + c * c)
            around[k, 0], around[k, 1], around[k, 2] = a / norm, b / norm, c / norm
        found = np.abs(coherence(around, few if step_deg > _FINE_STEP_DEG else edges))
        k = int(np.argmax(found))
        if k == 0 or around[k, 2] < LEAST_COSINE:
            step_deg /= 2
        else:
            best[:] = around[k]
    mean = coherence(best.reshape(1, 3), edges)[0]
    axes = axes_at(best, math.atan2(mean.imag, mean.real) / 4)
    # Under strong perspective coherence peaks some degrees off the plane; angles do not.
    stride = max(1, len(edges.rays) // _TURNING_EDGES)
    rays, lines = edges.rays[::stride].copy(), edges.lines[::stride].copy()
    turned = turn_axes(axes, Edges(rays, lines))
    return abs(mean), turned if turned[2, 2] > LEAST_COSINE else axes


@fast_jit
def basis_of(
    x: float, y: float, z: float
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Two axes of the plane with a normal, the first one what it holds of the camera's x axis."""
    flat = math.sqrt(max(1 - x * x, 1e-12))
    s0, s1, s2 = (1 - x * x) / flat, -x * y / flat, -x * z / flat
    return (s0, s1, s2), (y * s2 - z * s1, z * s0 - x * s2, x * s1 - y * s0)


@fast_jit
def axes_at(normal: Array, angle: float) -> Array:
    """Axes (3, 3) of a plane, the first one at an angle from that of `basis_of`."""
    first, second = basis_of(normal[0], normal[1], normal[2])
    axes, c, s = np.empty((3, 3)), math.cos(angle), math.sin(angle)
    for k in range(3):
        axes[0, k] = c * first[k] + s * second[k]
        axes[1, k] = c * second[k] - s * first[k]
        axes[2, k] = normal[k]
    return axes


@fast_jit
def turn_axes(axes: Array, edges: Edges) -> Array:
    """See `plane_normals`: axes (3, 3) turned so that edges point along two of them.

    An edge with interpretation-plane normal l, seen along the ray x, is off the picture of axis a
    by the angle l·a / |x × a|. The squares of the smaller of an edge's two angles are summed over
    edges, those beyond a cut-off that shrinks from step to step trusted little.
    """
    rays, lines = edges
    out, cut = axes.copy(), _FIRST_CUT
    for _ in range(_TURNS):
        n00 = n01 = n02 = n11 = n12 = n22 = 1e-9
        g0 = g1 = g2 = 0.0
        for e in range(len(rays)):
            best, b0, b1, b2 = 1e9, 0.0, 0.0, 0.0
            for k in range(2):
                a0, a1, a2 = out[k]
                c0 = rays[e, 1] * a2 - rays[e, 2] * a1
                c1 = rays[e, 2] * a0 - rays[e, 0] * a2
                c2 = rays[e, 0] * a1 - rays[e, 1] * a0
                size = max(math.sqrt(c0 * c0 + c1 * c1 + c2 * c2), 1e-3)
                l0, l1, l2 = lines[e]
                angle = (l0 * a0 + l1 * a1 + l2 * a2) / size
                if abs(angle) < abs(best):
                    best = angle
                    b0, b1, b2 = a1 * l2 - a2 * l1, a2 * l0 - a0 * l2, a0 * l1 - a1 * l0
                    b0, b1, b2 = b0 / size, b1 / size, b2 / size
            share = 1 / (1 + (best / cut) ** 2)
            w = share * share
            n00, n01, n02 = n00 + w * b0 * b0, n01 + w * b0 * b1, n02 + w * b0 * b2
            n11, n12, n22 = n11 + w * b1 * b1, n12 + w * b1 * b2, n22 + w * b2 * b2
            g0, g1, g2 = g0 - w * b0 * best, g1 - w * b1 * best, g2 - w * b2 * best
        m0, m1, m2 = n11 * n22 - n12 * n12, n02 * n12 - n01 * n22, n01 * n12 - n02 * n11
        determinant = n00 * m0 + n01 * m1 + n02 * m2
        if not determinant > 1e-12:
            break
        m3, m4, m5 = n00 * n22 - n02 * n02, n01 * n02 - n00 * n12, n00 * n11 - n01 * n01
        w0 = (m0 * g0 + m1 * g1 + m2 * g2) / determinant
        w1 = (m1 * g0 + m3 * g1 + m4 * g2) / determinant
        w2 = (m2 * g0 + m4 * g1 + m5 * g2) / determinant
        for k in range(2):
            a0, a1, a2 = out[k]
            out[k, 0] += w1 * a2 - w2 * a1
            out[k, 1] += w2 * a0 - w0 * a2
            out[k, 2] += w0 * a1 - w1 * a0
        # First-order turns drift from right angles; these keep the first axis and the plane.
        out[0] /= math.sqrt((out[0] ** 2).sum())
        out[1] -= (out[0] * out[1]).sum() * out[0]
        out[1] /= math.sqrt((out[1] ** 2).sum())
        cut = max(_LAST_CUT, cut * 0.8)
    out[2, 0] = out[0, 1] * out[1, 2] - out[0, 2] * out[1, 1]
    out[2, 1] = out[0, 2] * out[1, 0] - out[0, 0] * out[1, 2]
    out[2, 2] = out[0, 0] * out[1, 1] - out[0, 1] * out[1, 0]
    return out


class OnPlane(NamedTuple):
    """Edges on a plane at distance 1, as the search for lattices takes them.

    Attributes
    ----------
    u, v : (N,) float64
        Places along the plane's axes, in spacings of its lines.
    on_u, on_v : (N,) bool
        Edges that count for lines of constant u, and of constant v.
    """

    u: Array
    v: Array
    on_u: NDArray[np.bool_]
    on_v: NDArray[np.bool_]


@fast_jit
def lattice_equations(fit: Array, edges: OnPlane, gate: float) -> tuple[Array, Array, int]:
    """See `lattice`: normal matrix (8, 8), right side, fewer family's edges."""
    u, v, on_u, on_v = edges
    normal, right, counts = np.zeros((8, 8)), np.zeros(8), np.zeros(2, np.int64)
    for k in range(len(u)):
        if not (on_u[k] or on_v[k]):
            continue
        w = max(fit[2, 0] * u[k] + fit[2, 1] * v[k] + 1.0, 0.05)
        for axis in range(2):
            if not (on_u[k] if axis == 0 else on_v[k]):
                continue
            value = (fit[axis, 0] * u[k] + fit[axis, 1] * v[k] + fit[axis, 2]) / w
            line = np.round(value)
            off = value - line
            if abs(off) >= gate:
                continue
            counts[axis] += 1
            weight = 1 / (1 + (off / 0.08) ** 2)
            first = 3 * axis
            row = (u[k], v[k], 1.0, -line * u[k], -line * v[k])
            for a in range(5):
                at = first + a if a < 3 else 3 + a
                right[at] += weight * row[a] * line
                for b in range(5):
                    normal[at, first + b if b < 3 else 3 + b] += weight * row[a] * row[b]
    return normal, right, min(counts[0], counts[1])
