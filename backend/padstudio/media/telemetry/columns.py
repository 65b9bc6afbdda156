"""What telemetry of any kind becomes: columns over time, and heights at other times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from padstudio.errors import StudioError

#: Where telemetry is from; ``srt`` and ``csv`` are on the flight's clock, logs on their own.
Kind = Literal["srt", "csv", "ulog", "dataflash", "tlog"]
ON_FLIGHT_CLOCK: tuple[Kind, ...] = ("srt", "csv")


class TelemetryError(StudioError):
    """A file is no telemetry."""

    code = "invalid_telemetry"
    status = 422


@dataclass(frozen=True)
class Sample:
    """What one subtitle says.

    Attributes
    ----------
    time_s : float
        Since the video's start.
    frame : int or None
        The camera's own count, from 1.
    height_m : float or None
        Over the point of take-off.
    altitude_m : float or None
        Over the sea.
    latitude_deg, longitude_deg : float or None
        WGS 84; None where the drone had no fix.
    clock : str or None
        The camera's own date and time.
    """

    time_s: float
    frame: int | None = None
    height_m: float | None = None
    altitude_m: float | None = None
    latitude_deg: float | None = None
    longitude_deg: float | None = None
    clock: str | None = None


@dataclass(frozen=True)
class Telemetry:
    """The samples of one flight, in the order of time.

    Attributes
    ----------
    samples : tuple of Sample
    unread : int
        Subtitles of no known form.
    """

    samples: tuple[Sample, ...]
    unread: int = 0


def to_dict(telemetry: Telemetry) -> dict[str, Any]:
    """Columns of equal length, JSON-serialisable, as `Sample`'s attributes; ``kind`` is srt."""
    samples = telemetry.samples
    names = ("time_s", "frame", "height_m", "altitude_m", "latitude_deg", "longitude_deg", "clock")
    columns = {name: [getattr(sample, name) for sample in samples] for name in names}
    return {"kind": "srt", **columns, "unread": telemetry.unread}


def height_at(columns: dict[str, Any], times_s: Sequence[float]) -> list[float | None]:
    """Heights at other times, m, linear between samples; None outside of them.

    Where the camera wrote no height over the point of take-off, it is its altitude over the sea,
    which rises and falls as the height does.

    Parameters
    ----------
    columns : dict
        As `to_dict`.
    times_s : sequence of float
    """
    heights_m = columns["height_m"]
    if all(height is None for height in heights_m):
        heights_m = columns["altitude_m"]
    known = [
        (time, height)
        for time, height in zip(columns["time_s"], heights_m, strict=True)
        if height is not None
    ]
    if not known:
        return [None] * len(times_s)
    at, heights = np.array(sorted(known)).T
    inside = (np.asarray(times_s) >= at[0]) & (np.asarray(times_s) <= at[-1])
    values = np.interp(times_s, at, heights)
    return [float(v) if ok else None for v, ok in zip(values, inside, strict=True)]
