"""What a vehicle's own log says of its flight: attitude, local position, height, place on earth.

Frames: *body* is x forward, y right, z down (FRD); *local* is north, east, down (NED) from an
origin of the vehicle's; metres.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from padstudio.arrays import Array
from padstudio.media.telemetry.columns import Kind, TelemetryError

#: Rows a second that are kept: vehicles turn and climb slower than that tells.
_ROWS_HZ = 25.0
# Between two values so many times as far apart as usual nothing is known; nor further than this.
_GAP, _LEAST_GAP_S = 4.0, 0.5
# A clock that goes back by more was started again.
_RESTART_S = 1.0


@dataclass(frozen=True, eq=False)
class Series:
    """Values over time.

    Attributes
    ----------
    time_s : (N,) float64
        Rising.
    values : (N, K) float64
    """

    time_s: Array
    values: Array

    @classmethod
    def of(cls, time_s: ArrayLike, values: ArrayLike) -> Series | None:
        """What is finite and in order; None where there is not so much as two.

        Raises
        ------
        TelemetryError
            If the clock begins again.
        """
        times, table = np.asarray(time_s, float), np.asarray(values, float)
        table = table if table.ndim == 2 else table[:, None]
        known = np.isfinite(times) & np.isfinite(table).all(axis=1)
        times, table = times[known], table[known]
        if len(times) < 2:
            return None
        if (np.diff(times) < -_RESTART_S).any():
            raise TelemetryError(
                "the clock of the log goes back: the vehicle was started again within it; send the "
                "part of the flight alone"
            )
        rising = np.r_[True, times[1:] > np.maximum.accumulate(times)[:-1]]
        times, table = times[rising], table[rising]
        return cls(times, table) if len(times) > 1 else None

    @property
    def max_gap_s(self) -> float:
        """Between two values further apart nothing is known."""
        return max(_LEAST_GAP_S, _GAP * float(np.median(np.diff(self.time_s))))

    def at(self, times_s: Array) -> Array:
        """(M, K) values at other times, linear between neighbours; NaN outside and in gaps."""
        after = np.clip(np.searchsorted(self.time_s, times_s), 1, len(self.time_s) - 1)
        gap_s = self.time_s[after] - self.time_s[after - 1]
        inside = (times_s >= self.time_s[0]) & (times_s <= self.time_s[-1])
        inside &= gap_s <= self.max_gap_s
        share = ((times_s - self.time_s[after - 1]) / gap_s)[:, None]
        found = (1 - share) * self.values[after - 1] + share * self.values[after]
        found[~inside] = np.nan
        return np.asarray(found)


@dataclass(frozen=True, eq=False)
class VehicleLog:
    """A log, each of its series None where it is not held.

    Attributes
    ----------
    kind : str
        As of `padstudio.media.telemetry.columns.Kind`.
    attitude : Series
        Unit quaternions, scalar first, that take body vectors to local vectors.
    local : Series
        North, east, down, m.
    height : Series
        Over the point of take-off or the local origin, m.
    place : Series
        Latitude and longitude (degrees, WGS 84) and altitude over the sea (m).
    """

    kind: Kind
    attitude: Series | None = None
    local: Series | None = None
    height: Series | None = None
    place: Series | None = None

    def to_dict(self) -> dict[str, Any]:
        """Columns of equal length, JSON-serialisable; time counts from the first row of a log.

        Those of `padstudio.media.telemetry.columns.Sample`, and ``qw``, ``qx``, ``qy``, ``qz``,
        ``north_m``, ``east_m``, ``down_m``; None where a value is not known.

        Raises
        ------
        TelemetryError
            If there is neither attitude nor height.
        """
        base = self.attitude or self.local or self.height
        if base is None or (self.attitude is None and self.height is None):
            raise TelemetryError(
                f"the {self.kind} log holds neither attitude nor height of the vehicle; log them, "
                "or leave this file out"
            )
        every = max(1, round(1 / _ROWS_HZ / float(np.median(np.diff(base.time_s)))))
        times = base.time_s[::every]
        zero_s = 0.0 if self.kind == "csv" else float(times[0])
        columns: dict[str, Any] = {"kind": self.kind, "time_s": (times - zero_s).tolist()}
        columns |= {name: [None] * len(times) for name in ("frame", "clock")}
        for names, series in (
            (("height_m",), self.height),
            (("latitude_deg", "longitude_deg", "altitude_m"), self.place),
            (("qw", "qx", "qy", "qz"), self._even(self.attitude)),
            (("north_m", "east_m", "down_m"), self.local),
        ):
            table = (
                np.full((len(times), len(names)), np.nan) if series is None else series.at(times)
            )
            for name, values in zip(names, table.T.tolist(), strict=True):
                columns[name] = [None if value != value else value for value in values]
        return columns | {"unread": 0}

    @staticmethod
    def _even(attitude: Series | None) -> Series | None:
        """Neighbours on one side of the sphere, so that the mean of two lies between them."""
        if attitude is None:
            return None
        q = attitude.values
        signs = np.where(np.sum(q[1:] * q[:-1], axis=1) < 0, -1.0, 1.0)
        return Series(attitude.time_s, q * np.cumprod(np.r_[1.0, signs])[:, None])


def quaternion_wxyz(roll_rad: Array, pitch_rad: Array, yaw_rad: Array) -> Array:
    """(N, 4) rotations Rz(yaw) Ry(pitch) Rx(roll), scalar first."""
    (sr, sp, sy), (cr, cp, cy) = (
        [function(angle / 2) for angle in (roll_rad, pitch_rad, yaw_rad)]
        for function in (np.sin, np.cos)
    )
    return np.column_stack(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def columns_of(rows: Sequence[Sequence[float]], count: int) -> Array:
    """(N, count) table of rows, of none, too."""
    return np.asarray(rows, float).reshape(-1, count)
