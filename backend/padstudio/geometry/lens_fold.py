"""Whether a lens is one to one in its picture.

A polynomial that was fitted to pictures with nothing near their rims may turn back there: two rays
then have one pixel, and pixels beyond have none. Nothing is measured there (`Camera.has_ray`), and
such a calibration wants to be made again.
"""

from __future__ import annotations

import numpy as np

from padstudio.geometry.camera import Camera

# Pixels along each side of the grid that is asked.
_GRID = 41
# A fisheye sees to the side and behind itself, where the plane z = 1 has no points; its polynomial
# must rise up to here, radians.
_SIDEWAYS = np.pi / 2


def folded_share(camera: Camera) -> float:
    """How much of the picture lies where the lens folds back, 0 … 1."""
    if not camera.distorted:
        return 0.0
    across = np.linspace(-0.5, camera.width - 0.5, _GRID)
    down = np.linspace(-0.5, camera.height - 0.5, _GRID)
    pixels = np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)
    if camera.model == "fisheye":
        return float(np.mean(_radii(camera, pixels) > _fisheye_reach(camera)))
    return float(np.mean(~camera.has_ray(pixels, camera.normalize(pixels))))


def fold_note(camera: Camera) -> str | None:
    """What a user must know of it, or None where the lens is one to one."""
    share = folded_share(camera)
    if not share:
        return None
    return (
        f"the lens folds back within {max(share, 0.01):.0%} of the picture, where nothing is "
        "measured; calibrate again with the pad in every corner"
    )


def _radii(camera: Camera, pixels: np.ndarray) -> np.ndarray:
    y = (pixels[:, 1] - camera.matrix[1, 2]) / camera.matrix[1, 1]
    return np.asarray(np.hypot((pixels[:, 0] - camera.matrix[0, 2]) / camera.matrix[0, 0], y))


def _fisheye_reach(camera: Camera) -> float:
    """The radius on the plane of the picture at which the polynomial turns; endless if later."""
    k = np.zeros(4)
    k[: len(camera.distortion)] = camera.distortion
    angle = np.linspace(0, _SIDEWAYS, 2001)
    t = angle * angle
    slope = 1 + t * (3 * k[0] + t * (5 * k[1] + t * (7 * k[2] + t * 9 * k[3])))
    turn = int(np.argmax(slope <= 0))
    if slope[turn] > 0:
        return np.inf
    a, t0 = angle[turn], t[turn]
    return float(a * (1 + t0 * (k[0] + t0 * (k[1] + t0 * (k[2] + t0 * k[3])))))
