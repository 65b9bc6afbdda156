"""The vehicle under the camera: how the camera sits on it, and where it was.

Frames: *body* is the autopilots' x forward, y right, z down (FRD); *local* is north, east, down
(NED) from the vehicle's origin; both in metres.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import SpecError
from padstudio.media.telemetry.vehicle_table import read_rows

#: Over a longer gap between two poses of the vehicle nothing is known of it.
MAX_GAP_S = 0.5


def _downward() -> Array:
    return np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


@dataclass(frozen=True, eq=False)
class Mount:
    """How the camera sits on the vehicle.

    Attributes
    ----------
    rotation : (3, 3) float64
        Takes camera vectors to body vectors. By default the camera looks straight down, and up in
        the picture is forward.
    position_m : (3,) float64
        The camera's centre in the body frame.

    Raises
    ------
    SpecError
        If the matrix is no rotation.
    """

    rotation: Array = field(default_factory=_downward)
    position_m: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        product = self.rotation @ self.rotation.T
        if not np.allclose(product, np.eye(3), atol=1e-6) or np.linalg.det(self.rotation) < 0:
            raise SpecError("the camera's mount must be a rotation", code="invalid_mount")

    @classmethod
    def downward(cls, turned_deg: float, position_m: Array) -> Mount:
        """A camera that looks straight down, turned clockwise as seen from above.

        At 0 up in the picture is forward, at 90 it is to the right.
        """
        s, c = math.sin(math.radians(turned_deg)), math.cos(math.radians(turned_deg))
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return cls(turn @ _downward(), position_m)

    @classmethod
    def leaning(cls, turned_deg: float, lean_deg: tuple[float, float], position_m: Array) -> Mount:
        """A camera whose optical axis leans from straight down.

        Parameters
        ----------
        turned_deg : float
            Heading of up in the picture in the body frame, clockwise from forward as seen from
            above.
        lean_deg : (forward, right)
            By which the optical axis leans, each in (-90, 90), seen from the side and from behind.
        position_m : (3,) float64

        Raises
        ------
        SpecError
            If an angle is out of range.
        """
        if not all(abs(lean) < 90 for lean in lean_deg):
            raise SpecError(
                "a camera leans by less than 90 degrees from straight down", code="invalid_mount"
            )
        forward, right = (math.tan(math.radians(lean)) for lean in lean_deg)
        s, c = math.sin(math.radians(turned_deg)), math.cos(math.radians(turned_deg))
        axis = np.array([forward, right, 1.0])
        down = -np.array([c, s, -(c * forward + s * right)])
        axis, down = axis / np.linalg.norm(axis), down / np.linalg.norm(down)
        return cls(np.stack([np.cross(down, axis), down, axis], axis=1), position_m)


DOWNWARD = Mount()


class VehicleTrack:
    """Poses of the vehicle over time.

    Parameters
    ----------
    time_s : (N,) float64
        Rising; on the clock of the records.
    position_m : (N, 3) float64
        In the local frame.
    quaternion_wxyz : (N, 4) float64
        Takes body vectors to local vectors; scalar first, as autopilots log it.

    Raises
    ------
    SpecError
        If there are fewer than two, or times do not rise.
    """

    def __init__(self, time_s: Array, position_m: Array, quaternion_wxyz: Array) -> None:
        norms = np.linalg.norm(quaternion_wxyz, axis=-1, keepdims=True)
        finite = all(np.isfinite(a).all() for a in (time_s, position_m, quaternion_wxyz))
        if len(time_s) < 2 or not finite or (np.diff(time_s) <= 0).any() or (norms < 0.5).any():
            raise SpecError(
                "the vehicle's track needs two poses or more, finite, with rising times and unit "
                "quaternions",
                code="invalid_vehicle_track",
            )
        self._time_s, self._position_m = time_s, position_m
        unit = quaternion_wxyz / norms
        # Neighbours on one side of the sphere, so that the mean of two lies between them.
        signs = np.where(np.sum(unit[1:] * unit[:-1], axis=1) < 0, -1.0, 1.0)
        self._quaternion = unit * np.cumprod(np.r_[1.0, signs])[:, None]

    @property
    def start_s(self) -> float:
        """Time of the first pose."""
        return float(self._time_s[0])

    @property
    def end_s(self) -> float:
        """Time of the last pose."""
        return float(self._time_s[-1])

    @property
    def usual_gap_s(self) -> float:
        """From one pose to the next, the median."""
        return float(np.median(np.diff(self._time_s)))

    @classmethod
    def from_csv(cls, lines: Iterable[str]) -> VehicleTrack:
        """Read a table, as `padstudio.media.telemetry.vehicle_table.read_rows`.

        Raises
        ------
        SpecError
            If a column is missing or a cell is no number, naming it.
        """
        rows = read_rows(lines)
        return cls(rows[:, 0], rows[:, 1:4], rows[:, 4:8])

    def at(self, time_s: float) -> tuple[Array, Array] | None:
        """Position (3,) m and rotation (3, 3) local from body at a time, between its neighbours.

        None before the first pose, after the last, and in gaps longer than `MAX_GAP_S`.
        """
        after = int(np.searchsorted(self._time_s, time_s))
        after = max(after, 1) if time_s == self._time_s[0] else after
        if not 0 < after < len(self._time_s):
            return None
        before = after - 1
        gap_s = self._time_s[after] - self._time_s[before]
        if gap_s > MAX_GAP_S:
            return None
        share = (time_s - self._time_s[before]) / gap_s
        position = (1 - share) * self._position_m[before] + share * self._position_m[after]
        return position, attitude_between(self._quaternion[before], self._quaternion[after], share)


def attitude_between(before: Array, after: Array, share: float) -> Array:
    """(3, 3) rotation at a share of the way between two unit quaternions (4,), scalar first.

    They are close in time, so that the chord and the arc between them agree.
    """
    sign = -1.0 if before @ after < 0 else 1.0
    q = (1 - share) * before + sign * share * after
    return _rotation(q / np.linalg.norm(q))


def _rotation(q: Array) -> Array:
    """(3, 3) rotation of a unit quaternion, scalar first."""
    w, v = q[0], q[1:]
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.asarray(np.eye(3) + 2 * w * cross + 2 * cross @ cross, float)
