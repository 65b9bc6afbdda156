"""What a pose's borders say of camera and print: which one change of them explains more.

The borders' places are fitted again by the pose alone, by a pose that changes while the shutter
rolls, and by the pose with one more unknown: the focal length, the lens's bend, the picture's
aspect, the print's stretch. Each lowers the sum of squares; what it lowers it by, in variances of
what the best of them leaves, tells whether it is there (nested models, likelihood ratio).

Whether a print is larger or smaller as a whole no frame tells: the camera is then as much higher.

References
----------
Wilks, S. S. (1938). The large-sample distribution of the likelihood ratio for testing composite
hypotheses. doi:10.1214/aoms/1177732360.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.pose.edge_points import EdgePoints

# So many borders tell.
_TELLING = 600
# Rounds of the fit.
_ROUNDS = 8
# Lines that run together tell of focal length and tilt, between which lie minima of their own.
_STARTS = {"focal": (0.0, 0.3, -0.3)}
# A border that is off by so many deviations is off, by however much more.
_OFF = 5.0
# What is left by the best explanation is at least this, pixels: lens, sensor and ink.
_LEAST_PX = 0.06
# Small changes for derivatives, of unknowns that are all of the size of radians.
_STEP = 1e-6

#: What is fitted beside the pose: camera and points on the pad, changed by an amount.
Change = Callable[[Camera, Array, float], tuple[Camera, Array]]


@dataclass(frozen=True)
class Explanation:
    """One model, fitted.

    Attributes
    ----------
    amount : float
        Of the change, as of `CHANGES`; 0 of the pose alone.
    rms_px : float
        What it leaves, root mean square, pixels.
    gain : float
        By how many variances it lowers the sum of squares against the pose alone.
    pose : MovingPose
    """

    amount: float
    rms_px: float
    gain: float
    pose: MovingPose


def _focal(camera: Camera, points: Array, amount: float) -> tuple[Camera, Array]:
    matrix = camera.matrix.copy()
    matrix[[0, 1], [0, 1]] *= np.exp(amount)
    return replace(camera, matrix=matrix), points


def _lens(camera: Camera, points: Array, amount: float) -> tuple[Camera, Array]:
    bends = np.zeros(max(4, len(camera.distortion)))
    bends[: len(camera.distortion)] = camera.distortion
    bends[0] += amount
    return replace(camera, distortion=bends), points


def _aspect(camera: Camera, points: Array, amount: float) -> tuple[Camera, Array]:
    matrix = camera.matrix.copy()
    matrix[0, 0] *= np.exp(amount / 2)
    matrix[1, 1] *= np.exp(-amount / 2)
    return replace(camera, matrix=matrix), points


def _stretch(camera: Camera, points: Array, amount: float) -> tuple[Camera, Array]:
    return camera, points * [np.exp(amount / 2), np.exp(-amount / 2), 1.0]


#: The changes by name: amounts are natural logarithms of ratios, the lens's its first coefficient.
CHANGES: Mapping[str, Change] = {
    "focal": _focal,
    "lens": _lens,
    "aspect": _aspect,
    "stretch": _stretch,
}


def explanations(
    edge_points: EdgePoints, camera: Camera, pose: MovingPose
) -> dict[str, Explanation]:
    """What each change explains, by its name, with ``pose`` and ``motion`` for none.

    Parameters
    ----------
    edge_points : EdgePoints
        Found with the pose.
    camera : Camera
        At the frame's size.
    pose : MovingPose
    """
    few = edge_points.thinned(_TELLING)
    still = MovingPose(pose.pose)
    fits = {"pose": _fitted(few, camera, still, None), "motion": _fitted(few, camera, pose, None)}
    for name, change in CHANGES.items():
        fits[name] = min(
            (_fitted(few, camera, still, change, start) for start in _STARTS.get(name, (0.0,))),
            key=lambda fit: _scatter(fit.residual),
        )
    # All are compared by the scatter of the best of them; borders that it does not explain are off.
    sigma = max(min(_scatter(fit.residual) for fit in fits.values()), _LEAST_PX)
    sums = {
        name: float((few.weight * np.minimum((fit.residual / sigma) ** 2, _OFF**2)).sum())
        for name, fit in fits.items()
    }
    return {
        name: Explanation(
            fit.amount, _rms(fit.residual, few.weight), sums["pose"] - sums[name], fit.pose
        )
        for name, fit in fits.items()
    }


@dataclass(frozen=True)
class _Fitted:
    pose: MovingPose
    amount: float
    residual: Array


def _fitted(
    edge_points: EdgePoints,
    camera: Camera,
    pose: MovingPose,
    change: Change | None,
    amount: float = 0.0,
) -> _Fitted:
    """Pose and amount by Levenberg and Marquardt with Geman and McClure's weights.

    The weights' scale falls from what nearly all borders fit to what half of them does, so that a
    few that agree by themselves do not hold the fit. Without a change the pose may move.
    """
    height = abs(float(pose.pose.position_mm[2]))
    count = 12 if change is None and not pose.still else 6
    sizes = np.array([height] * 3 + [1.0] * 3 + [height] * 3 + [1.0] * 3)[:count]

    def moved_by(step: Array) -> tuple[MovingPose, float]:
        extra = float(step[count]) if change is not None else 0.0
        return pose.moved(sizes * step[:count]), amount + extra

    def residual_of(step: Array) -> Array:
        return _residuals(edge_points, camera, *moved_by(step), change)

    unknowns, damping = count + (change is not None), 1e-4
    residual = residual_of(np.zeros(unknowns))
    for number in range(_ROUNDS):
        slopes = [(residual_of(_STEP * axis) - residual) / _STEP for axis in np.eye(unknowns)]
        spread = np.percentile(np.abs(residual), 90) if number < _ROUNDS // 2 else 0.0
        scale = 3 * max(float(spread), _scatter(residual), _LEAST_PX)
        root = np.sqrt(edge_points.weight) / (1 + (residual / scale) ** 2)
        jacobian = np.stack(slopes, axis=1) * root[:, None]
        normal, toward = jacobian.T @ jacobian, -jacobian.T @ (residual * root)
        for _ in range(4):
            held = normal + damping * np.diag(np.diag(normal) + 1e-9 * np.trace(normal))
            step = np.asarray(np.linalg.solve(held, toward), float)
            tried = residual_of(step)
            if _cost(tried, edge_points.weight, scale) < _cost(residual, edge_points.weight, scale):
                pose, amount = moved_by(step)
                residual, damping = tried, damping / 10
                break
            damping *= 10
    return _Fitted(pose, amount, residual)


def _cost(residual: Array, weight: Array, scale: float) -> float:
    """Geman and McClure's; infinite where a border is behind the camera."""
    squares = (residual / scale) ** 2
    cost = float((weight * squares / (1 + squares)).sum())
    return cost if np.isfinite(cost) else np.inf


def _rms(residual: Array, weight: Array) -> float:
    """Of all but outliers, pixels."""
    kept = weight * (np.abs(residual) < max(_OFF * _scatter(residual), _LEAST_PX))
    return float(np.sqrt((kept * residual**2).sum() / kept.sum()))


def _residuals(
    edge_points: EdgePoints, camera: Camera, pose: MovingPose, amount: float, change: Change | None
) -> Array:
    """Signed distances (N,) of measured steps from the borders' pictures, pixels."""
    borders = edge_points.borders
    ends = np.concatenate(
        [borders.points_mm - borders.along_mm, borders.points_mm + borders.along_mm]
    )
    if change is not None:
        camera, ends = change(camera, ends, amount)
    first, last = np.split(pose.project(camera, ends), 2)
    along = last - first
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    away = edge_points.xy - (first + last) / 2
    return np.asarray((away * normal).sum(axis=1), float)


def _scatter(residual: Array) -> float:
    """Standard deviation of residuals by their median, which outliers do not move."""
    return float(1.4826 * np.median(np.abs(residual)))
