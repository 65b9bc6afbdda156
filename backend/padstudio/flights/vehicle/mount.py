"""How a camera sits on its vehicle, from the attitudes of both.

At every time A = Y · B · X: A takes camera vectors to the pad, B body vectors to the local frame of
the vehicle, X camera vectors to the body (the mounting) and Y local vectors to the pad. X and Y are
fitted together, robustly; that the pad lies level, or how it is turned, is not assumed.

X is determined where the vehicle turned about two axes: what turned about one alone looks the same
under any mounting that is turned about that axis.

References
----------
Y. C. Shiu and S. Ahmad, "Calibration of wrist-mounted robotic sensors by solving homogeneous
transform equations of the form AX = XB", IEEE Transactions on Robotics and Automation 5 (1989),
doi:10.1109/70.88014.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from padstudio.arrays import Array

# Fewer attitudes than this say too little.
_LEAST = 20
_ROUNDS = 25
# Residuals beyond so many deviations count less (Huber, 95 % efficiency).
_HUBER = 1.345
# The vehicle has to turn about two axes by so much, degrees, and by so many times the residual.
_LEAST_TURN_DEG, _LEAST_TURN_RESIDUALS = 1.0, 3.0
# A mounting that fits worse is none: the camera hangs on a gimbal, or the log is another's.
_MOST_RESIDUAL_DEG = 5.0


@dataclass(frozen=True, eq=False)
class MountEstimate:
    """A mounting.

    Attributes
    ----------
    rotation : (3, 3) float64
        Takes camera vectors to body vectors (x forward, y right, z down).
    pad_from_local : (3, 3) float64
        Takes local vectors (north, east, down) to the pad frame.
    sigma_deg : (3,) float64
        One standard deviation about the body's axes; large where the motion does not tell.
    residual_deg : float
        Root mean square angle between the poses' attitudes and the log's under this mounting.
    undetermined : (K, 3) float64
        Axes in the body frame about which the mounting is not determined: none, one or three.
    """

    rotation: Array
    pad_from_local: Array
    sigma_deg: Array
    residual_deg: float
    undetermined: Array

    @property
    def turned_deg(self) -> float:
        """By which up in the picture is turned from forward to the right."""
        up = -self.rotation[:, 1]
        return float(np.degrees(np.arctan2(up[1], up[0])))

    @property
    def lean_deg(self) -> tuple[float, float]:
        """By which the optical axis leans from straight down, forward and to the right."""
        x, y, z = self.rotation[:, 2]
        return float(np.degrees(np.arctan2(x, z))), float(np.degrees(np.arctan2(y, z)))

    def attitudes(self, local_from_body: Array) -> Array:
        """(N, 3, 3) pad from camera, as the log's attitudes (N, 3, 3) say it."""
        return np.asarray(self.pad_from_local @ local_from_body @ self.rotation)


def estimate_mount(pad_from_camera: Array, local_from_body: Array) -> MountEstimate | str:
    """Fit the mounting.

    Parameters
    ----------
    pad_from_camera, local_from_body : (N, 3, 3) float64
        Attitudes at the same times.

    Returns
    -------
    MountEstimate or str
        Why there is none.
    """
    if len(pad_from_camera) < _LEAST:
        return f"{len(pad_from_camera)} attitudes are known on both sides; {_LEAST} are needed"
    x, y = _start(pad_from_camera, local_from_body)
    for _ in range(_ROUNDS):
        residuals = _residuals(pad_from_camera, local_from_body, x, y)
        step, normal, scale = _step(residuals, np.swapaxes(y @ local_from_body @ x, 1, 2))
        x, y = x @ _turn(step[:3]), _turn(step[3:]) @ y
        if np.abs(step).max() < 1e-9:
            break
    residuals = _residuals(pad_from_camera, local_from_body, x, y)
    residual_deg = float(np.degrees(np.sqrt(np.mean(np.sum(residuals**2, axis=1)))))
    if residual_deg > _MOST_RESIDUAL_DEG:
        return (
            f"no fixed mounting explains the attitudes of both, to {residual_deg:.1f}°: the camera "
            "hangs on a gimbal, or the log is of another flight"
        )
    covariance = np.linalg.pinv(normal, rcond=1e-12, hermitian=True)[:3, :3] * scale**2
    covariance = x @ covariance @ x.T * _memory(residuals)
    free = _undetermined(local_from_body, residual_deg)
    sigma_deg = np.degrees(np.sqrt(np.maximum(np.diag(covariance), 0.0)))
    # About an axis that nothing tells, nothing is known: as if drawn from all turns.
    sigma_deg = np.sqrt(sigma_deg**2 + np.sum((free * 180 / np.sqrt(3)) ** 2, axis=0))
    return MountEstimate(x, y, sigma_deg, residual_deg, free)


def _start(a: Array, b: Array) -> tuple[Array, Array]:
    """X by the turns between attitudes far apart (Kabsch), and Y by their mean under it."""
    count = len(a)
    far = (np.arange(count) + max(1, count // 3)) % count
    ours = _vectors(np.swapaxes(a, 1, 2) @ a[far])
    theirs = _vectors(np.swapaxes(b, 1, 2) @ b[far])
    x = _nearest_rotation(theirs.T @ ours)
    y = _nearest_rotation((a @ x.T @ np.swapaxes(b, 1, 2)).sum(axis=0))
    return x, y


def _residuals(a: Array, b: Array, x: Array, y: Array) -> Array:
    """(N, 3) rotation vectors from our attitudes to those that the log's ask for, camera frame."""
    return _vectors(np.swapaxes(a, 1, 2) @ y @ b @ x)


def _step(residuals: Array, camera_from_pad: Array) -> tuple[Array, Array, float]:
    """One step of robust Gauss-Newton: (6,) of X and Y, the normal matrix, the residuals' scale."""
    size = np.linalg.norm(residuals, axis=1)
    # Of three components, whose length has a median of 1.54 deviations.
    scale = max(float(np.median(size)) / 1.538, 1e-9)
    weights = np.minimum(1.0, _HUBER * np.sqrt(3) * scale / np.maximum(size, 1e-12))
    jacobian = np.concatenate(
        [np.broadcast_to(np.eye(3), camera_from_pad.shape), camera_from_pad], axis=2
    )
    weighted = jacobian * weights[:, None, None]
    normal = np.einsum("nki,nkj->ij", weighted, jacobian)
    gradient = np.einsum("nki,nk->i", weighted, residuals)
    step = -np.linalg.lstsq(normal, gradient, rcond=1e-10)[0]
    return step, normal, scale


def _memory(residuals: Array) -> float:
    """By how much variances grow as residuals of neighbours are alike."""
    centred = residuals - residuals.mean(axis=0)
    power = float(np.sum(centred**2))
    total = 1.0
    for lag in range(1, len(centred) // 2):
        alike = float(np.sum(centred[lag:] * centred[:-lag])) / max(power, 1e-30)
        if alike < 0.05:
            break
        total += 2 * alike
    return total


def _undetermined(b: Array, residual_deg: float) -> Array:
    """(K, 3) axes, body frame, about which the vehicle's turning does not tell the mounting."""
    mean = _nearest_rotation(b.sum(axis=0))
    turns = np.degrees(_vectors(mean.T @ b))
    variances, axes = np.linalg.eigh(turns.T @ turns / len(turns))
    least = max(_LEAST_TURN_DEG, _LEAST_TURN_RESIDUALS * residual_deg)
    told = np.sqrt(np.maximum(variances, 0)) > least
    if told.sum() >= 2:
        return np.zeros((0, 3))
    # Turning about one axis tells the other two; no turning tells none.
    free: Array = np.array(axes[:, 2:].T if told.any() else np.eye(3), np.float64)
    return free


def _nearest_rotation(matrix: Array) -> Array:
    u, _, vt = np.linalg.svd(matrix)
    return np.asarray(u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt)


def _vectors(rotations: Array) -> Array:
    """(N, 3) rotation vectors of matrices (N, 3, 3)."""
    found = [cv2.Rodrigues(np.ascontiguousarray(each))[0].ravel() for each in rotations]
    return np.array(found, np.float64).reshape(-1, 3)


def _turn(vector: Array) -> Array:
    return np.asarray(cv2.Rodrigues(np.ascontiguousarray(vector))[0])
