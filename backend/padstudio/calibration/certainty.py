"""How sure a calibrated camera is: of each parameter, and of where it puts things in its picture.

A camera turned a little shows nearly the same as one with another principal point. What counts is
what is left when a turn has taken up what it can: the projection uncertainty of
https://mrcal.secretsauce.net/uncertainty.html.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from padstudio.arrays import Array
from padstudio.calibration.patches import Patches
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose

#: The picture is divided into so many columns and rows.
GRID = (16, 10)
# Steps of the differences: pixels, parts of coefficients; and of a pose, parts of the height and
# radians.
_STEP_PX, _STEP = 1e-2, 1e-5
# Demosaicing and compression of colours at half the scale shift a channel as a whole by up to a
# tenth of a pixel in simulated pictures, which no residual shows.
_SHIFT_PX = 0.1
# What residuals do not show of a lens's error, as a factor: in simulated pictures with noise,
# mosaic and compression it was 1 to 5 times what they say.
_HIDDEN = 2.0


@dataclass(frozen=True, eq=False)
class LensSigma:
    """One standard deviation of a calibrated camera.

    Attributes
    ----------
    matrix : (4,) float64
        Of fx, fy, cx, cy, pixels.
    distortion : (K,) float64
        Of each coefficient.
    picture_px : (R, C) float64
        Of where directions are seen, over the picture's grid, pixels; NaN where the lens shows
        none.
    """

    matrix: Array
    distortion: Array
    picture_px: Array


def lens_sigma(views: Sequence[Patches], camera: Camera, poses: Sequence[Pose]) -> LensSigma:
    """Standard deviations by the residuals' scatter and the least squares' normal equations.

    Parameters
    ----------
    views : sequence of Patches
    camera : Camera
        As fitted to them.
    poses : sequence of Pose
    """
    free = 4 + len(camera.distortion)
    normal, squares, count = np.zeros((free, free)), 0.0, 0
    scores, residuals = [], []
    for view, pose in zip(views, poses, strict=True):
        lens, place, rest = _jacobians(view.points_mm, view.pixels, camera, pose)
        # What a picture's own pose can take up tells nothing of the lens (Schur complement).
        taken_up = lens.T @ place @ np.linalg.pinv(place.T @ place)
        normal += lens.T @ lens - taken_up @ (place.T @ lens)
        scores.append(lens.T @ rest - taken_up @ (place.T @ rest))
        squares += float(rest @ rest)
        count += len(rest) - 6
        residuals.append(rest)
    variance = _HIDDEN**2 * squares / max(count - free, 1)
    inverse = np.linalg.pinv(normal, hermitian=True)
    # Errors that all patches of a picture have in common (sandwich estimator, clustered).
    common = inverse @ np.einsum("vi,vj->ij", scores, scores) @ inverse
    common *= len(scores) / max(len(scores) - 1, 1)
    # What no camera at rest over a flat pad explains leads all pictures astray alike.
    astray = max(1.0, excess(views, residuals))
    covariance = astray**2 * (variance * inverse + common)
    covariance[[2, 3], [2, 3]] += _SHIFT_PX**2
    sigma = np.sqrt(np.maximum(np.diag(covariance), 0))
    return LensSigma(sigma[:4], sigma[4:], _picture_sigma(camera, covariance))


def excess(views: Sequence[Patches], residuals: Sequence[Array]) -> float:
    """Residuals over what the borders of each patch scatter, root mean squares.

    In simulated pictures it was 0.7 to 1; of a camera that moved while its shutter rolled, and of
    paper that was bent by three millimetres in a metre, 3 to 4.

    Parameters
    ----------
    views : sequence of Patches
    residuals : sequence of float64
        Of each picture's patches, in X and Y, of any shape.
    """
    rests = np.concatenate([np.ravel(each) for each in residuals])
    scatter = np.concatenate([view.sigma_px for view in views])
    return float(np.sqrt(np.mean(rests**2) / max(np.mean(scatter**2), 1e-12)))


def grid_pixels(camera: Camera) -> Array:
    """Middles (R · C, 2) of the picture's grid."""
    x = (np.arange(GRID[0]) + 0.5) * camera.width / GRID[0] - 0.5
    y = (np.arange(GRID[1]) + 0.5) * camera.height / GRID[1] - 0.5
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def _jacobians(
    points: Array, pixels: Array, camera: Camera, pose: Pose
) -> tuple[Array, Array, Array]:
    """Changes of a picture's points with lens (2N, 4 + K) and pose (2N, 6), and residuals (2N,)."""
    there = pose.to_camera(points)
    here = camera.project(there)
    lens = [(each.project(there) - here).ravel() / step for each, step in _varied(camera)]
    moving, place = MovingPose(pose), []
    reach = max(abs(float(pose.position_mm[2])), 1.0)
    for k in range(6):
        step = np.zeros(6)
        step[k] = _STEP * (reach if k < 3 else 1.0)
        moved = moving.moved(step).pose
        place.append((camera.project(moved.to_camera(points)) - here).ravel() / step[k])
    # Of a length with the turns, so that their product is well conditioned.
    scaled = np.stack(place, axis=1) * np.repeat([reach, 1.0], 3)
    return np.stack(lens, axis=1), scaled, (pixels - here).ravel()


def _varied(camera: Camera) -> list[tuple[Camera, float]]:
    """Cameras with one parameter changed each, and by how much."""
    out = []
    for row, col in ((0, 0), (1, 1), (0, 2), (1, 2)):
        matrix = camera.matrix.copy()
        matrix[row, col] += _STEP_PX
        out.append((replace(camera, matrix=matrix), _STEP_PX))
    for k in range(len(camera.distortion)):
        lens = camera.distortion.copy()
        lens[k] += _STEP
        out.append((replace(camera, distortion=lens), _STEP))
    return out


def _picture_sigma(camera: Camera, covariance: Array) -> Array:
    """`LensSigma.picture_px`, from the covariance of all parameters."""
    pixels = grid_pixels(camera)
    rays = camera.normalize(pixels)
    seen = camera.has_ray(pixels, rays)
    there = np.column_stack([rays[seen], np.ones(int(seen.sum()))])
    there /= np.linalg.norm(there, axis=1, keepdims=True)
    change, turn, _ = _jacobians(there, pixels[seen], camera, Pose(np.zeros(3), np.eye(3)))
    left = change - turn[:, 3:] @ np.linalg.lstsq(turn[:, 3:], change, rcond=None)[0]
    each = left.reshape(-1, 2, left.shape[1])
    variance = np.einsum("nik,kl,nil->n", each, covariance, each)
    out = np.full(len(pixels), np.nan)
    out[seen] = np.sqrt(np.maximum(variance, 0))
    return out.reshape(GRID[1], GRID[0])
