"""What DJI cameras write of the flight beside or inside a video: position, height, exposure.

Each frame or second is one subtitle. The text in it differs from model to model; these forms are
known, and each value is looked for by all of them:

- ``[latitude: 22.1] [longitude: 113.9] [rel_alt: 1.3 abs_alt: 65.2]`` (Mini 3, Mavic 3, Air 2S),
  also with ``longtitude`` and ``altitude`` (Mavic Air, Mavic 2);
- ``GPS (113.9, 22.1, 15), D 24.5m, H 6.00m, H.S 0.00m/s`` (Mini, Mini 2, Phantom 4 RTK);
- ``GPS(113.9,22.1,16) BAROMETER:1.9`` (Mavic Pro, Phantom 4);
- ``GPS(W: 96.1, N: 43.0, 715.9m) Hb: 1.9`` (Phantom 3, Inspire).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from padstudio.errors import StudioError
from padstudio.media import video
from padstudio.media.remote import read_bytes

#: Bytes of a telemetry file; an hour takes about 40 MB.
MAX_BYTES = 256_000_000

_NUMBER = r"([-+]?\d+(?:\.\d+)?)"
_CUE = re.compile(
    r"(\d+):(\d\d):(\d\d)[,.](\d{1,3})\s*-->\s*(\d+):(\d\d):(\d\d)[,.](\d{1,3})[^\n]*\n"
)
_TAG = re.compile(r"<[^>\n]{1,200}>|\{[^}\n]{1,200}\}")
_FRAME = re.compile(r"(?:FrameCnt|SrtCnt)\s*:\s*(\d+)")
_CLOCK = re.compile(r"\d{4}[-.]\d\d[-.]\d\d \d\d:\d\d:\d\d(?:[.,]\d{1,3})?")
_HEIGHT = (
    re.compile(rf"\brel_alt\s*:\s*{_NUMBER}"),
    re.compile(rf"\bH\s+{_NUMBER}\s*m\b(?!/s)"),
    re.compile(rf"\b(?:BAROMETER|Hb)\s*:?\s*{_NUMBER}"),
)
_ALTITUDE = (
    re.compile(rf"\b(?:abs_alt|altitude)\s*:\s*{_NUMBER}"),
    re.compile(rf"\bGPS\s*\([^)]*,\s*{_NUMBER}\s*[mM]\s*\)"),
)
_LATITUDE = re.compile(rf"\blatitude\s*:\s*{_NUMBER}")
_LONGITUDE = re.compile(rf"\blongt?itude\s*:\s*{_NUMBER}")
_GPS = re.compile(rf"\bGPS\s*\(\s*{_NUMBER}\s*,\s*{_NUMBER}")
_GPS_SIGNED = re.compile(rf"\bGPS\s*\(\s*([EW])\s*:\s*{_NUMBER}\s*,\s*([NS])\s*:\s*{_NUMBER}")


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


def parse_srt(text: str) -> Telemetry:
    """Read an SRT file's text.

    Raises
    ------
    TelemetryError
        If no subtitle in it is of a known form.
    """
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    cues = list(_CUE.finditer(text))
    ends = [*(cue.start() for cue in cues), len(text)][1:]
    telemetry = _collect(
        (_seconds(cue.groups()[:4]), text[cue.end() : end])
        for cue, end in zip(cues, ends, strict=False)
    )
    if not telemetry.samples:
        raise TelemetryError(
            f"none of the {len(cues)} subtitles holds a height or a position in a form that DJI "
            "cameras write; leave this file out"
        )
    return telemetry


def read(source: str) -> Telemetry:
    """Read a stored SRT file; raises as `parse_srt`."""
    data = read_bytes(source, MAX_BYTES)
    if len(data) > MAX_BYTES:
        raise TelemetryError(f"the telemetry has more than {MAX_BYTES // 1_000_000} MB")
    return parse_srt(data.decode("utf-8-sig", "replace"))


def read_embedded(source: str) -> Telemetry | None:
    """The telemetry in a video's subtitle stream; None where there is none."""
    telemetry = _collect(video.read_subtitles(source))
    return telemetry if telemetry.samples else None


def to_dict(telemetry: Telemetry) -> dict[str, Any]:
    """Columns of equal length, JSON-serialisable, named as `Sample`'s attributes."""
    samples = telemetry.samples
    names = ("time_s", "frame", "height_m", "altitude_m", "latitude_deg", "longitude_deg", "clock")
    columns = {name: [getattr(sample, name) for sample in samples] for name in names}
    return {**columns, "unread": telemetry.unread}


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


def _collect(cues: Iterator[tuple[float, str]]) -> Telemetry:
    samples, unread = [], 0
    for time_s, text in cues:
        sample = _sample(time_s, _TAG.sub(" ", text))
        if sample is None:
            unread += 1
        else:
            samples.append(sample)
    samples.sort(key=lambda sample: sample.time_s)
    return Telemetry(tuple(samples), unread)


def _sample(time_s: float, text: str) -> Sample | None:
    frame, clock = _FRAME.search(text), _CLOCK.search(text)
    latitude, longitude = _position(text)
    height, altitude = _first(_HEIGHT, text), _first(_ALTITUDE, text)
    if height is None and altitude is None and latitude is None:
        return None
    return Sample(
        time_s,
        int(frame[1]) if frame else None,
        height,
        altitude,
        latitude,
        longitude,
        clock[0] if clock else None,
    )


def _first(patterns: Sequence[re.Pattern[str]], text: str) -> float | None:
    for pattern in patterns:
        found = pattern.search(text)
        if found:
            return float(found[1])
    return None


def _position(text: str) -> tuple[float | None, float | None]:
    """Latitude and longitude, degrees; both None without a fix."""
    latitude, longitude = _LATITUDE.search(text), _LONGITUDE.search(text)
    signed, plain = _GPS_SIGNED.search(text), _GPS.search(text)
    if latitude and longitude:
        place = float(latitude[1]), float(longitude[1])
    elif signed:
        east, lon, north, lat = signed.groups()
        place = (
            float(lat) * (1 if north == "N" else -1),
            float(lon) * (1 if east == "E" else -1),
        )
    elif plain:
        place = float(plain[2]), float(plain[1])
    else:
        return None, None
    # Without a fix, cameras write zeros.
    if place == (0.0, 0.0) or abs(place[0]) > 90 or abs(place[1]) > 180:
        return None, None
    return place


def _seconds(parts: Sequence[str]) -> float:
    hours, minutes, seconds, fraction = parts
    whole = int(hours) * 3600 + int(minutes) * 60 + int(seconds)
    return whole + float(f"0.{fraction}")
