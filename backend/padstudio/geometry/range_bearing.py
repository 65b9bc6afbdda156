"""How far the pad is and in which direction, how sure both are, and whether the pose is, too.

A plane that is small in the picture hardly shows its attitude: the camera may stand anywhere on an
arc about it. Its distance and its direction are known all the same, far better than the position
and the attitude that they are made of, whose errors cancel in them.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.pose import Pose

#: ``full``: the whole pose can be used; ``bearing``: range and bearing alone.
Quality = Literal["full", "bearing"]

#: Most one standard deviation of a full pose: of the position, as a share of the range, and of the
#: attitude. Of each the root of the sum of squares over the axes, so that no axis is preferred.
MOST_POSITION_SHARE = 0.03
MOST_ATTITUDE_DEG = 3.0


def range_sigma_mm(pose: Pose, covariance: Array) -> float:
    """One standard deviation of the range, by linear propagation of the pose's covariance.

    Parameters
    ----------
    pose : Pose
    covariance : (6, 6) float64
        Position (mm, pad frame), then attitude (radians, about the camera's axes).
    """
    along = pose.position_mm / pose.range_mm
    return math.sqrt(max(float(along @ covariance[:3, :3] @ along), 0.0))


def bearing_sigma_deg(pose: Pose, covariance: Array) -> float:
    """One standard deviation of the bearing, degrees, in the direction in which it is least sure.

    Linear propagation, with b = −Rᵀ p / |p| for rotation R and position p; a turn δθ of the camera
    and a shift δp of its centre change it by b × δθ − (I − b bᵀ) Rᵀ δp / |p|.

    Parameters
    ----------
    pose : Pose
    covariance : (6, 6) float64
        As of `range_sigma_mm`.
    """
    bearing = pose.bearing
    across = np.eye(3) - np.outer(bearing, bearing)
    jacobian = np.hstack([-across @ pose.rotation.T / pose.range_mm, _cross_matrix(bearing)])
    spread = np.linalg.eigvalsh(jacobian @ covariance @ jacobian.T)[-1]
    return math.degrees(math.sqrt(max(float(spread), 0.0)))


def quality_of(
    range_mm: float, position_sigma_mm: Array | list[float], attitude_sigma_deg: Array | list[float]
) -> Quality:
    """Whether a whole pose can be used, or its range and bearing alone.

    Parameters
    ----------
    range_mm : float
    position_sigma_mm, attitude_sigma_deg : (3,) float64
        One standard deviation along each of any three axes at right angles.
    """
    shift = float(np.linalg.norm(position_sigma_mm))
    turn = float(np.linalg.norm(attitude_sigma_deg))
    # Not a number is not sure, either.
    is_full = shift <= MOST_POSITION_SHARE * range_mm and turn <= MOST_ATTITUDE_DEG
    return "full" if is_full else "bearing"


def _cross_matrix(v: Array) -> Array:
    """(3, 3), which times a vector is the cross product of ``v`` with it."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
