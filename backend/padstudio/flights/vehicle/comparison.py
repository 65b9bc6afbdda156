"""A vehicle's log beside a flight's poses: the clock, the mounting, heights and attitudes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.flights.results.height_fit import compare_heights
from padstudio.flights.vehicle.clock import ClockMatch, match_clocks
from padstudio.flights.vehicle.motion import Motion
from padstudio.flights.vehicle.mount import MountEstimate, estimate_mount
from padstudio.flights.vehicle.ours import OurPoses
from padstudio.media.telemetry.columns import ON_FLIGHT_CLOCK
from padstudio.media.telemetry.vehicle_log import Series

#: Most rows of the columns that are told, and attitudes that the mounting is fitted to.
POINTS, _ATTITUDES = 2000, 3000


@dataclass(frozen=True)
class _Log:
    """A log's series, on its own clock."""

    height: Series | None
    attitude: Series | None

    @classmethod
    def of(cls, columns: Mapping[str, Any]) -> _Log:
        heights = columns["height_m"]
        if all(height is None for height in heights):
            # Which rises and falls as the height does.
            heights = columns["altitude_m"]
        turns = [columns.get(name) or [] for name in ("qw", "qx", "qy", "qz")]
        attitude = None
        if turns[0]:
            attitude = Series.of(columns["time_s"], np.array(turns, float).T)
        return cls(Series.of(columns["time_s"], np.array(heights, float)), attitude)

    @property
    def motion(self) -> Motion:
        height, attitude = self.height, self.attitude
        return Motion(
            None if height is None else height.time_s,
            None if height is None else height.values[:, 0],
            None if attitude is None else attitude.time_s,
            None if attitude is None else _unit(attitude.values),
        )


def compare(ours: OurPoses, columns: Mapping[str, Any]) -> dict[str, Any]:
    """Compare poses with a log.

    Parameters
    ----------
    ours : OurPoses
    columns : mapping
        As of `padstudio.media.telemetry.reading.read`.

    Returns
    -------
    dict
        JSON-serialisable.

        - ``kind``.
        - ``clock``: the fields of `ClockMatch`, and ``is_flights``: the times are the flight's.
        - ``mount``: None (``mount_reason`` says why), or ``rotation``, ``turned_deg``,
          ``lean_forward_deg``, ``lean_right_deg``, ``sigma_deg``, ``residual_deg``,
          ``undetermined``, as of `MountEstimate`.
        - ``fit``: None, or the fields of `HeightComparison`; ``scale_error``: None, or ``value``,
          ``low``, ``high``, the share by which poses are too large.
        - ``columns`` of equal length, None where a value is not known: ``frame``, ``time_s``,
          ``pose_m``, ``vehicle_m`` (the log's height, shifted by the median of the difference),
          ``residual_mm`` (pose less the fitted line), ``tilt_deg``, ``heading_deg``,
          ``vehicle_tilt_deg``, ``vehicle_heading_deg`` (the camera's as log and mounting say it),
          ``attitude_residual_deg``.
    """
    log = _Log.of(columns)
    clock = clock_of(ours, columns)
    kind = columns.get("kind", "srt")
    found: dict[str, Any] = {
        "kind": kind,
        "clock": asdict(clock) | {"is_flights": kind in ON_FLIGHT_CLOCK},
        "mount": None,
        "mount_reason": clock.reason or ("" if len(ours.frame) else "no frame has a pose"),
        "fit": None,
        "scale_error": None,
        "columns": {},
    }
    if clock.offset_s is None or not len(ours.frame):
        return found
    times_s = ours.time_s + clock.offset_s
    mount, turned = _mount(ours, log, times_s)
    found |= {"mount_reason": mount} if isinstance(mount, str) else {"mount": _told(mount)}
    heights = _heights(ours, log, times_s)
    found |= {key: heights.pop(key) for key in ("fit", "scale_error")}
    attitudes = {} if isinstance(mount, str) else _attitudes(ours, mount, turned)
    chosen = np.unique(np.linspace(0, len(times_s) - 1, POINTS).round().astype(int))
    table = {"frame": ours.frame, "time_s": ours.time_s} | heights | attitudes
    found["columns"] = {name: _plain(values[chosen]) for name, values in table.items()}
    return found


def clock_of(ours: OurPoses, columns: Mapping[str, Any]) -> ClockMatch:
    """The clock of a log: that of the flight, or matched by the motion; as of `compare`."""
    if columns.get("kind", "srt") in ON_FLIGHT_CLOCK:
        return ClockMatch(offset_s=0.0)
    own = Motion(ours.time_s, ours.height_m, ours.time_s, ours.quaternion_wxyz)
    return match_clocks(own, _Log.of(columns).motion)


def _mount(ours: OurPoses, log: _Log, times_s: Array) -> tuple[MountEstimate | str, Array]:
    """The mounting, or why there is none, and the log's attitudes (N, 3, 3) at our times."""
    if log.attitude is None:
        return "the log holds no attitude", np.zeros((0, 3, 3))
    turns = log.attitude.at(times_s)
    turned = np.full((len(times_s), 3, 3), np.nan)
    known = np.isfinite(turns).all(axis=1)
    turned[known] = _matrices(_unit(turns[known]))
    places = np.flatnonzero(known)
    if len(places) > _ATTITUDES:
        places = places[np.linspace(0, len(places) - 1, _ATTITUDES).round().astype(int)]
    return estimate_mount(_matrices(ours.quaternion_wxyz[places]), turned[places]), turned


def _told(mount: MountEstimate) -> dict[str, Any]:
    forward, right = mount.lean_deg
    return {
        "rotation": mount.rotation.tolist(),
        "turned_deg": mount.turned_deg,
        "lean_forward_deg": forward,
        "lean_right_deg": right,
        "sigma_deg": mount.sigma_deg.tolist(),
        "residual_deg": mount.residual_deg,
        "undetermined": mount.undetermined.tolist(),
    }


def _heights(ours: OurPoses, log: _Log, times_s: Array) -> dict[str, Any]:
    empty = np.full(len(times_s), np.nan)
    vehicle_m = empty if log.height is None else log.height.at(times_s)[:, 0]
    known = np.isfinite(vehicle_m)
    fit = compare_heights(vehicle_m[known], 1000 * ours.height_m[known]) if known.any() else None
    shift_m = float(np.median((ours.height_m - vehicle_m)[known])) if known.any() else 0.0
    line_mm = empty if fit is None else 1000 * fit.slope * vehicle_m + fit.offset_mm
    error = None
    if fit is not None:
        error = {"value": fit.slope - 1, "low": fit.slope_low - 1, "high": fit.slope_high - 1}
    return {
        "pose_m": ours.height_m,
        "vehicle_m": vehicle_m + shift_m,
        "residual_mm": 1000 * ours.height_m - line_mm,
        "fit": None if fit is None else asdict(fit),
        "scale_error": error,
    }


def _attitudes(ours: OurPoses, mount: MountEstimate, turned: Array) -> dict[str, Any]:
    own = _matrices(ours.quaternion_wxyz)
    told = mount.attitudes(turned)
    cosine = (np.einsum("nij,nij->n", own, told) - 1) / 2
    return {
        "tilt_deg": _tilt_deg(own),
        "heading_deg": _heading_deg(own),
        "vehicle_tilt_deg": _tilt_deg(told),
        "vehicle_heading_deg": _heading_deg(told),
        "attitude_residual_deg": np.degrees(np.arccos(np.clip(cosine, -1, 1))),
    }


def _tilt_deg(rotations: Array) -> Array:
    axis = rotations[:, :, 2]
    return np.asarray(np.degrees(np.arctan2(np.hypot(axis[:, 0], axis[:, 1]), -axis[:, 2])))


def _heading_deg(rotations: Array) -> Array:
    up = -rotations[:, :, 1]
    return np.asarray(np.degrees(np.arctan2(up[:, 0], up[:, 1])) % 360.0)


def _unit(q: Array) -> Array:
    return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True))


def _matrices(q: Array) -> Array:
    """(N, 3, 3) rotations of unit quaternions (N, 4), scalar first."""
    w, x, y, z = q.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _plain(values: Any) -> list[Any]:
    """As JSON has them, None for what is not known."""
    return [None if value != value else value for value in values.tolist()]
