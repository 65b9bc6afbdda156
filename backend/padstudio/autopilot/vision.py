"""The vehicle over the pad, as VISION_POSITION_ESTIMATE has it.

The pad is the origin. Axes are x up the page, y to its right, z into it, turned about z by the
heading of the page: with its true heading they are north, east, down where the pad lies level.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.autopilot.target import R_PAD_TARGET
from padstudio.autopilot.vehicle import Mount
from padstudio.geometry.pose import Pose

#: Upper triangle of a 6 x 6 matrix by rows.
_TRIANGLE = np.triu_indices(6)


def body_over_pad(pose: Pose, mount: Mount, heading_deg: float) -> tuple[Array, Array]:
    """Position (3,) m of the body's origin, and rotation (3, 3) that takes body vectors there.

    Parameters
    ----------
    pose : Pose
        Of the camera.
    mount : Mount
    heading_deg : float
        Of up on the page, clockwise from north.
    """
    axes = _axes(heading_deg)
    rotation = axes @ pose.rotation @ mount.rotation.T
    return axes @ pose.position_mm / 1000 - rotation @ mount.position_m, rotation


def position_estimate_fields(
    pose: Pose, covariance: Array | None, mount: Mount, heading_deg: float
) -> dict[str, Any]:
    """Fields of the message: metres, radians, and the covariance of both.

    Parameters
    ----------
    pose : Pose
        Of the camera.
    covariance : (6, 6) float64 or None
        Position (mm, pad frame), then attitude (radians, about the camera's axes).
    mount : Mount
    heading_deg : float
        Of up on the page, clockwise from north.
    """
    position, rotation = body_over_pad(pose, mount, heading_deg)
    roll, pitch, yaw = (math.radians(angle) for angle in Pose(position * 1000, rotation).euler_deg)
    # A first element that is no number says that nothing is known.
    triangle = [math.nan] + [0.0] * 20
    if covariance is not None:
        J = _jacobian(pose, mount, heading_deg, roll, pitch)
        triangle = (J @ covariance @ J.T)[_TRIANGLE].tolist()
    return {
        "x": position[0],
        "y": position[1],
        "z": position[2],
        "roll": roll,
        "pitch": pitch,
        "yaw": yaw,
        "covariance": triangle,
    }


def _axes(heading_deg: float) -> Array:
    """(3, 3), takes pad vectors to the message's axes."""
    s, c = math.sin(math.radians(heading_deg)), math.cos(math.radians(heading_deg))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(turn @ R_PAD_TARGET.T)


def _jacobian(pose: Pose, mount: Mount, heading_deg: float, roll: float, pitch: float) -> Array:
    """(6, 6), of x, y, z, roll, pitch and yaw by the camera's position and attitude."""
    axes = _axes(heading_deg)
    x, y, z = mount.rotation.T @ mount.position_m
    lever = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sr, cr, tp, cp = math.sin(roll), math.cos(roll), math.tan(pitch), math.cos(pitch)
    # Rates of roll, pitch and yaw by those about the body's axes.
    rates = np.array([[1.0, sr * tp, cr * tp], [0.0, cr, -sr], [0.0, sr / cp, cr / cp]])
    J = np.zeros((6, 6))
    J[:3, :3] = axes / 1000
    J[:3, 3:] = axes @ pose.rotation @ lever
    J[3:, 3:] = rates @ mount.rotation
    return J
