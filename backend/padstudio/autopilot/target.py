"""The pad as LANDING_TARGET has it: where it is, how it is turned, where the picture shows it.

Frames: *body* is the autopilots' x forward, y right, z down (FRD); *local* is north, east, down
(NED) from the vehicle's origin; both in metres.

References
----------
https://mavlink.io/en/services/landing_target.html
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.autopilot.vehicle import Mount
from padstudio.geometry.pose import Pose

#: The pad as a frame of the autopilots' kind: x up the page, y to its right, z into it.
R_PAD_TARGET = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


@dataclass(frozen=True, eq=False)
class Target:
    """The pad as the vehicle sees it.

    Attributes
    ----------
    position_m : (3,) float64
        The pad's centre.
    rotation : (3, 3) float64 or None
        Takes vectors of the pad as a frame x up the page, y right, z into it, to the same frame
        as the position; None where the attitude is not known.
    """

    position_m: Array
    rotation: Array | None

    def moved(self, position_m: Array, rotation: Array) -> Target:
        """The same in another frame, in which this one's origin and rotation are given."""
        turned = None if self.rotation is None else rotation @ self.rotation
        return Target(position_m + rotation @ self.position_m, turned)


@dataclass(frozen=True, eq=False)
class Sight:
    """Range and bearing of the pad's centre.

    Attributes
    ----------
    range_m : float
    bearing : (3,) float64
        Unit vector in the camera frame.
    """

    range_m: float
    bearing: Array

    @property
    def pad_in_camera_m(self) -> Array:
        """(3,) float64, the pad's centre in the camera frame, metres."""
        return self.range_m * self.bearing


def target_in_body(sight: Sight, pose: Pose | None, mount: Mount) -> Target:
    """The pad in the body frame of the vehicle that the camera is mounted on.

    Parameters
    ----------
    sight : Sight
    pose : Pose or None
        Where all of it can be used.
    mount : Mount
    """
    return Target(
        mount.position_m + mount.rotation @ sight.pad_in_camera_m,
        None if pose is None else mount.rotation @ pose.rotation.T @ R_PAD_TARGET,
    )


def picture_fields(
    sight: Sight, body: Target, pad_size_mm: tuple[float, float] | None
) -> dict[str, float]:
    """Where the picture has the pad: positive to the right and down; and how large it is."""
    distance_m = float(np.linalg.norm(body.position_m))
    x, y, z = sight.bearing
    width, height = pad_size_mm or (0.0, 0.0)
    return {
        "angle_x": math.atan2(x, z),
        "angle_y": math.atan2(y, z),
        "distance": distance_m,
        "size_x": 2 * math.atan2(width / 2000, distance_m),
        "size_y": 2 * math.atan2(height / 2000, distance_m),
    }


def position_fields(target: Target) -> dict[str, Any]:
    """The pad's centre, and its attitude as a quaternion, scalar first."""
    x, y, z = target.position_m
    if target.rotation is None:
        # Zeros are what MAVLink 2 reads where a field was not sent.
        return {"x": x, "y": y, "z": z, "q": [0.0] * 4}
    q = Pose(target.position_m, target.rotation).quaternion_xyzw
    return {"x": x, "y": y, "z": z, "q": [q[3], q[0], q[1], q[2]]}
