"""Compiled least squares of `padstudio.geometry.planar_pnp`: poses from points."""

from __future__ import annotations

import math

import numpy as np

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.geometry.small_matrices import rotation_vector, solve, turned


@fast_jit
def misfit(
    points: Array, rays: Array, rotation: Array, centre: Array, normal: Array, right: Array
) -> float:
    """Sum of squares of points' pictures on the plane z = 1, with its normal equations.

    Infinite where a point lies behind the camera.
    """
    normal[:], right[:] = 0.0, 0.0
    total, j = 0.0, np.empty(6)
    for i in range(len(points)):
        dx, dy, dz = points[i] - centre
        x = dx * rotation[0, 0] + dy * rotation[1, 0] + dz * rotation[2, 0]
        y = dx * rotation[0, 1] + dy * rotation[1, 1] + dz * rotation[2, 1]
        z = dx * rotation[0, 2] + dy * rotation[1, 2] + dz * rotation[2, 2]
        if not z > 1e-9:
            return np.inf
        for axis in range(2):
            seen = x / z if axis == 0 else y / z
            off = rays[i, axis] - seen
            total += off * off
            g0, g1, g2 = (1 / z, 0.0, -seen / z) if axis == 0 else (0.0, 1 / z, -seen / z)
            for k in range(3):
                j[k] = -(g0 * rotation[k, 0] + g1 * rotation[k, 1] + g2 * rotation[k, 2])
            j[3], j[4], j[5] = -(y * g2 - z * g1), -(z * g0 - x * g2), -(x * g1 - y * g0)
            for a in range(6):
                right[a] += j[a] * off
                for b in range(6):
                    normal[a, b] += j[a] * j[b]
    return total


@fast_jit
def fit_points(
    points: Array, rays: Array, rotation: Array, centre: Array, most_steps: int
) -> tuple[float, Array, Array]:
    """Least squares for a still pose by Levenberg and Marquardt: sum of squares, and the pose."""
    normal, right = np.empty((6, 6)), np.empty(6)
    trial_normal, trial_right = np.empty((6, 6)), np.empty(6)
    error = misfit(points, rays, rotation, centre, normal, right)
    damping = 1e-6
    for _ in range(most_steps):
        damped = normal.copy()
        for k in range(6):
            damped[k, k] *= 1 + damping
        solved, step = solve(damped, right)
        trial_rotation, trial_centre = turned(rotation, step[3:6]), centre + step[:3]
        trial = np.inf
        if solved:
            trial = misfit(points, rays, trial_rotation, trial_centre, trial_normal, trial_right)
        if not trial <= error:
            if damping > 1e6:
                break
            damping = max(damping, 1e-6) * 10
            continue
        gained = error - trial
        rotation, centre, error = trial_rotation, trial_centre, trial
        normal[:], right[:] = trial_normal, trial_right
        damping *= 0.1
        if gained <= 1e-12 * error:
            break
    return error, rotation, centre


@fast_jit
def fit_mirrored(
    points: Array, rotation: Array, centre: Array, most_steps: int
) -> tuple[float, Array]:
    """The other planar pose that explains points as a pose shows them: sum of squares, rotation.

    It is sought from the plane mirrored about the line of sight to the points' middle. Where there
    is no other one the sum is infinite, and the rotation that of the mirrored plane.
    """
    rays, middle = np.empty((len(points), 2)), np.zeros(3)
    seen, sight = np.zeros(3), np.zeros(3)
    for i in range(len(points)):
        for k in range(3):
            seen[k] = 0.0
            for j in range(3):
                seen[k] += (points[i, j] - centre[j]) * rotation[j, k]
            sight[k] += seen[k] / len(points)
            middle[k] += points[i, k] / len(points)
        rays[i, 0], rays[i, 1] = seen[0] / seen[2], seen[1] / seen[2]
    distance = math.sqrt((sight * sight).sum())
    normal, sight = rotation[2].copy(), sight / distance
    axis = np.array(
        [
            normal[1] * sight[2] - normal[2] * sight[1],
            normal[2] * sight[0] - normal[0] * sight[2],
            normal[0] * sight[1] - normal[1] * sight[0],
        ]
    )
    sine = math.sqrt((axis * axis).sum())
    # Twice the angle between them; a plane seen straight on is its own mirror image.
    angle = 2 * math.atan2(sine, -(normal * sight).sum())
    other = turned(rotation, axis * (angle / max(sine, 1e-12)))
    start = np.empty(3)
    for k in range(3):
        start[k] = middle[k] - distance * (other[k] * sight).sum()
    squares, found, place = fit_points(points, rays, other, start, most_steps)
    if not squares < np.inf or place[2] <= 0:
        return np.inf, other
    return squares, found


@fast_jit
def spread(
    points: Array, rays: Array, moved: Array, rotation: Array, centre: Array, most_steps: int
) -> tuple[Array, float]:
    """What moves of points' rays do to a pose, which is found anew for each of them.

    Parameters
    ----------
    points : (N, 3) float64
    rays : (N, 2) float64
        Where the points are seen, on the plane z = 1.
    moved : (2 M, N, 2) float64
        The same after each of M moves, and after its contrary.
    rotation : (3, 3) float64
    centre : (3,) float64
        The pose, camera to pad.
    most_steps : int

    Returns
    -------
    covariance : (6, 6) float64
        Of the centre and of a rotation vector in the camera frame.
    unexplained : float
        Squares of the moves that no pose follows.
    """
    covariance, unexplained = np.zeros((6, 6)), 0.0
    step, turn = np.empty(6), np.zeros((3, 3))
    at_rest = _off(points, rays, rotation, centre)
    for m in range(len(moved)):
        squares, there, place = fit_points(points, moved[m], rotation, centre, most_steps)
        if not squares < np.inf or place[2] <= 0:
            there, place = rotation, centre
        for i in range(3):
            for j in range(3):
                turn[i, j] = 0.0
                for k in range(3):
                    turn[i, j] += rotation[k, i] * there[k, j]
        step[:3], step[3:] = place - centre, rotation_vector(turn)
        for i in range(6):
            for j in range(6):
                covariance[i, j] += step[i] * step[j] / 2
        unexplained += ((_off(points, moved[m], there, place) - at_rest) ** 2).sum() / 2
    return covariance, unexplained


@fast_jit
def _off(points: Array, rays: Array, rotation: Array, centre: Array) -> Array:
    """How far rays (N, 2) are from where a pose has its points, on the plane z = 1."""
    off, at = np.empty((len(points), 2)), np.empty(3)
    for i in range(len(points)):
        for k in range(3):
            at[k] = 0.0
            for j in range(3):
                at[k] += (points[i, j] - centre[j]) * rotation[j, k]
        off[i, 0], off[i, 1] = rays[i, 0] - at[0] / at[2], rays[i, 1] - at[1] / at[2]
    return off
