"""Compiled Gauss–Newton of `padstudio.vision.pose.least_squares`: all steps of a fit in one call.

A fit solves a dozen small systems; called one by one from Python, each costs more than its work.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.geometry.projection import PoseState, in_camera
from padstudio.geometry.small_matrices import solve, turned

# Weighted points above this share of the best one's trust tell the scatter.
_TELLING = 0.3
# Residuals of so many standard deviations weigh a quarter.
_CUT_OFF = 2.5
# A step that is shorter than so many standard deviations, squared, is the last.
_SETTLED = 0.01


class Sightings(NamedTuple):
    """Borders where they were seen.

    Attributes
    ----------
    points_mm, along_mm : (N, 3) float64
        As of `padstudio.vision.pose.edge_points_kernel.Borders`.
    rays : (N, 2) float64
        On the plane z = 1, undistorted.
    row_time : (N,) float64
        −0.5 … 0.5 of the frame.
    weight : (N,) float64
        Relative trust, 0 … 1.
    """

    points_mm: Array
    along_mm: Array
    rays: Array
    row_time: Array
    weight: Array


class Solution(NamedTuple):
    """What `fit` found.

    Attributes
    ----------
    solved : bool
    pose : PoseState
    rows : (N, 7) float64
        Residuals there, pixels, and their change with centre and attitude.
    inliers : (N,) bool
        Residuals within four of the last step's robust standard deviations.
    rms : float
        Root mean square of those, as they are trusted, pixels.
    """

    solved: bool
    pose: PoseState
    rows: Array
    inliers: NDArray[np.bool_]
    rms: float


@fast_jit
def linearize(seen: Sightings, pose: PoseState) -> Array:
    """See `least_squares`: residual and its change with centre and attitude, (N, 7)."""
    points, along, rays, rotation = seen.points_mm, seen.along_mm, seen.rays, pose.rotation
    out = np.empty((len(points), 7))
    for i in range(len(points)):
        s, px, py, pz = seen.row_time[i], points[i, 0], points[i, 1], points[i, 2]
        x, y, z = in_camera(px, py, pz, s, pose)
        px, py, pz = px + 0.2 * along[i, 0], py + 0.2 * along[i, 1], pz + 0.2 * along[i, 2]
        bx, by, bz = in_camera(px, py, pz, s, pose)
        u, v = x / z, y / z
        tu, tv = bx / bz - u, by / bz - v
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


@fast_jit
def normal_equations(rows: Array, row_time: Array, weight: Array, size: int) -> tuple[Array, Array]:
    """Weighted normal matrix (size, size) and right side of linearized rows (N, 7).

    What a row says of a change within the frame is what it says of the pose, times its time: the
    same products serve all blocks.
    """
    sums, pull = np.zeros((3, 6, 6)), np.zeros((2, 6))
    for i in range(len(rows)):
        w, s = weight[i], row_time[i]
        for a in range(6):
            t = w * rows[i, 1 + a]
            ts = t * s
            pull[0, a] += t * rows[i, 0]
            pull[1, a] += ts * rows[i, 0]
            for b in range(a + 1):
                sums[0, a, b] += t * rows[i, 1 + b]
                sums[1, a, b] += ts * rows[i, 1 + b]
                sums[2, a, b] += s * ts * rows[i, 1 + b]
    normal, right = np.empty((size, size)), np.empty(size)
    for a in range(size):
        right[a] = pull[a // 6, a % 6]
        for b in range(size):
            first, last = min(a % 6, b % 6), max(a % 6, b % 6)
            normal[a, b] = sums[a // 6 + b // 6, last, first]
    return normal, right


@fast_jit
def scatter(residual: Array, weight: Array) -> float:
    """Robust standard deviation: the median of |residual| of trusted points over 0.6745."""
    size = np.abs(residual[weight > _TELLING * weight.max()])
    middle = len(size) // 2
    return max(float(np.partition(size, middle)[middle]) / 0.6745, 1e-3)


@fast_jit
def trust_of(residual: Array, weight: Array, sigma: float) -> Array:
    """Inverse variances of residuals, those that stand out trusted little."""
    return weight / (1 + (residual / (_CUT_OFF * sigma)) ** 2) ** 2 / sigma**2


@fast_jit
def fit(
    seen: Sightings,
    start: PoseState,
    prior: Array,
    expected: Array,
    focal_px: float,
    iterations: int,
) -> Solution:
    """Robust Gauss–Newton for 6 or 12 parameters, as many as the prior has.

    ``prior`` holds the inverse variances of the parameters about what is ``expected`` of them.
    """
    size, sigma, pose = len(prior), 1.0, start
    rows = linearize(seen, pose) * focal_px
    for _ in range(iterations):
        residual = rows[:, 0].copy()
        sigma = scatter(residual, seen.weight)
        trust = trust_of(residual, seen.weight, sigma)
        normal, right = normal_equations(rows, seen.row_time, trust, size)
        for k in range(size):
            now = 0.0 if k < 6 else pose.shift[k - 6] if k < 9 else pose.rotvec[k - 9]
            normal[k, k] += prior[k]
            right[k] += prior[k] * (expected[k] - now)
        solved, step = solve(normal, right)
        if not solved:
            return Solution(False, pose, rows, np.zeros(len(rows), np.bool_), 0.0)
        shift, rotvec = pose.shift, pose.rotvec
        if size == 12:
            shift, rotvec = shift + step[6:9], rotvec + step[9:]
        rotation, centre = turned(pose.rotation, step[3:6]), pose.centre + step[:3]
        pose = PoseState(rotation, centre, shift, rotvec)
        rows = linearize(seen, pose) * focal_px
        if (step * right).sum() < _SETTLED:
            break
    inliers = np.abs(rows[:, 0]) < 4 * sigma
    solved = bool(np.isfinite(rows[:, 0]).all())
    return Solution(solved, pose, rows, inliers, rms_of(rows, seen, inliers))


@fast_jit
def rms_of(rows: Array, seen: Sightings, inliers: NDArray[np.bool_]) -> float:
    """Root mean square of residuals as they are trusted, of inliers alone."""
    squares = total = 0.0
    for i in range(len(rows)):
        if inliers[i]:
            squares += seen.weight[i] * rows[i, 0] * rows[i, 0]
            total += seen.weight[i]
    return math.sqrt(squares / max(total, 1e-12))
