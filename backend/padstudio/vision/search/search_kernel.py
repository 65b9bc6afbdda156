"""Compiled inner loops of the search for lattices; see `padstudio.geometry.projection`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit


@fast_jit
def coherence(
    normals: Array, lines: Array, rays: Array, firsts: Array, most_weight: float, least_depth: float
) -> NDArray[np.complex128]:
    """See `padstudio.vision.search.plane_normals`: one complex coherence a normal, (H,)."""
    out = np.zeros(len(normals), np.complex128)
    depth = np.empty(len(rays))
    for h in range(len(normals)):
        n0, n1, n2 = normals[h]
        a0, a1, a2 = firsts[h]
        b0, b1, b2 = n1 * a2 - n2 * a1, n2 * a0 - n0 * a2, n0 * a1 - n1 * a0
        deepest, front = 1e-3, 0
        for e in range(len(rays)):
            d = rays[e, 0] * n0 + rays[e, 1] * n1 + rays[e, 2] * n2
            depth[e] = d
            deepest = max(deepest, d)
            front += d > least_depth
        real = imaginary = squares = nearness = 0.0
        for e in range(len(rays)):
            if depth[e] <= 0:
                continue
            near = (depth[e] / deepest) ** 2
            x = -(lines[e, 0] * b0 + lines[e, 1] * b1 + lines[e, 2] * b2)
            y = lines[e, 0] * a0 + lines[e, 1] * a1 + lines[e, 2] * a2
            size2 = max(x * x + y * y, 1e-9)
            weight = min(depth[e] / size2, most_weight)
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
def climb(
    normal: Array,
    lines: Array,
    rays: Array,
    most_weight: float,
    least_depth: float,
    least_cosine: float,
    least_step_deg: float,
) -> Array:
    """See `plane_normals`: the normal (3,) of the nearest maximum of coherence."""
    around, first = np.empty((9, 3)), np.empty((9, 3))
    best = normal.copy()
    step_deg = 6.0
    while step_deg > least_step_deg:
        size = math.tan(math.radians(step_deg * max(best[2], 0.25)))
        x, y, z = best
        length = math.sqrt(max(1 - x * x, 1e-12))
        s0, s1, s2 = (1 - x * x) / length, -x * y / length, -x * z / length
        t0, t1, t2 = y * s2 - z * s1, z * s0 - x * s2, x * s1 - y * s0
        for k in range(9):
            # The place itself comes first, so that it wins a draw.
            place = (k + 4) % 9
            i, j = size * (place // 3 - 1), size * (place % 3 - 1)
            a, b, c = x + i * s0 + j * t0, y + i * s1 + j * t1, z + i * s2 + j * t2
            norm = math.sqrt(a * a + b * b + c * c)
            a, b, c = a / norm, b / norm, c / norm
            flat = math.sqrt(max(1 - a * a, 1e-12))
            around[k, 0], around[k, 1], around[k, 2] = a, b, c
            first[k, 0], first[k, 1], first[k, 2] = (1 - a * a) / flat, -a * b / flat, -a * c / flat
        found = np.abs(coherence(around, lines, rays, first, most_weight, least_depth))
        k = int(np.argmax(found))
        if k == 0 or around[k, 2] < least_cosine:
            step_deg /= 2
        else:
            best[:] = around[k]
    return best


@fast_jit
def turn_axes(
    axes: Array, lines: Array, rays: Array, first_cut: float, last_cut: float, steps: int
) -> Array:
    """See `plane_normals`: axes (3, 3) turned so that edges point along two of them.

    An edge with interpretation-plane normal l, seen along the ray x, is off the picture of axis a
    by the angle l·a / |x × a|. The squares of the smaller of an edge's two angles are summed over
    edges, those beyond a cut-off that shrinks from step to step trusted little.
    """
    out, cut = axes.copy(), first_cut
    for _ in range(steps):
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
        cut = max(last_cut, cut * 0.8)
    out[2, 0] = out[0, 1] * out[1, 2] - out[0, 2] * out[1, 1]
    out[2, 1] = out[0, 2] * out[1, 0] - out[0, 0] * out[1, 2]
    out[2, 2] = out[0, 0] * out[1, 1] - out[0, 1] * out[1, 0]
    return out


@fast_jit
def lattice_equations(
    fit: Array,
    u: Array,
    v: Array,
    on_u: NDArray[np.bool_],
    on_v: NDArray[np.bool_],
    gate: float,
) -> tuple[Array, Array, int]:
    """See `lattice`: normal matrix (8, 8), right side, fewer family's edges."""
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
