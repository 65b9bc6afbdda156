"""What DJI cameras write of the flight beside or inside a video: position, height, exposure.

Each frame or second is one subtitle. The text in it differs from model to model; these forms are
known, and each value is looked for by all of them:

- ``[latitude: 22.1] [longitude: 113.9] [rel_alt: 1.3 abs_alt: 65.2]`` (Mini 3, Mavic 3, Air 2S),
  also with ``longtitude`` and ``altitude`` (Mavic Air, Mavic 2);
- ``GPS (113.9, 22.1, 15), D 24.5m, H 6.00m, H.S 0.00m/s`` (Mini, Mini 2, Phantom 4 RTK);
- ``GPS(113.9,22.1,16) BAROMETER:1.9`` (Mavic Pro, Phantom 4);
- ``GPS(22.1,113.9,469.8) BAROMETER(1.9)`` (Avata 2) and ``GPS(22.1,113.9,0.0M) BAROMETER:1.9M``
  (Matrice 300): here latitude comes first, and the third is a height over the sea;
- ``GPS(W: 96.1, N: 43.0, 715.9m) Hb: 1.9`` (Phantom 3, Inspire), ``ReH:1.9`` (Autel).

Which of two bare numbers is the latitude follows from the form, or from their range where one is
beyond 90 degrees; where neither tells, the file is refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from padstudio.media import video
from padstudio.media.telemetry.columns import Sample, Telemetry, TelemetryError

# Whole or not at all: no part of "1,432.86" is a number.
_EXPONENT = r"(?:[eE][-+]?\d++)?+"
_NUMBER = rf"([-+]?\d++(?:\.\d++)?+{_EXPONENT})(?!\.?\d)"
# After a label of its own a number may have a decimal comma.
_VALUE = rf"([-+]?\d++(?:[.,]\d++)?+{_EXPONENT})(?![.,]?\d)"
_FEET = r"(?:\s*(ft|FT|feet)\b)?"
_FOOT_M = 0.3048
_CUE = re.compile(
    r"(?<!\d)(\d{1,4}):(\d\d):(\d\d)[,.](\d{1,3})\s*-->\s*"
    r"\d{1,4}:\d\d:\d\d[,.]\d{1,3}[^\n]*\n"
)
_TAG = re.compile(r"<[^>\n]{1,200}>|\{[^}\n]{1,200}\}")
_FRAME = re.compile(r"(?:FrameCnt|SrtCnt)\s*:\s*(\d{1,9})(?!\d)")
_CLOCK = re.compile(r"\d{4}[-.]\d\d[-.]\d\d \d\d:\d\d:\d\d(?:[.,]\d{1,3})?")
_HEIGHT = (
    re.compile(rf"\brel_alt\s*:\s*{_VALUE}{_FEET}"),
    re.compile(rf"\bH\s+{_VALUE}\s*(m|ft|feet)\b(?!/s)"),
    re.compile(rf"\bBAROMETER\s*\(\s*{_NUMBER}\s*([mM]|ft|FT|feet)?\s*\)"),
    re.compile(rf"\b(?:BAROMETER|Hb|ReH)\s*:?\s*{_VALUE}{_FEET}"),
)
_ALTITUDE = (
    re.compile(rf"\b(?:abs_alt|altitude)\s*:\s*{_VALUE}{_FEET}"),
    re.compile(rf"\bGPS\s*\([^)]*,\s*{_NUMBER}\s*([mM]|ft|FT|feet)\s*\)"),
    re.compile(r"\bGPS\s*\([^)]*,\s*([-+]?\d+\.\d+)()\s*\)(?=[^\n]*\bBAROMETER\s*\()"),
)
_LATITUDE = re.compile(rf"\blatitude\s*:\s*{_VALUE}")
_LONGITUDE = re.compile(rf"\blongt?itude\s*:\s*{_VALUE}")
_GPS = re.compile(rf"\bGPS\s*\(\s*{_NUMBER}\s*,\s*{_NUMBER}")
_GPS_SIGNED = re.compile(rf"\bGPS\s*\(\s*([EW])\s*:\s*{_NUMBER}\s*,\s*([NS])\s*:\s*{_NUMBER}")
_LATITUDE_FIRST = re.compile(
    r"\bBAROMETER\s*\(|\bGPS\s*\([^)]*(?:[mM]|ft|FT|feet)\s*\)\s*BAROMETER\s*:"
)
_LONGITUDE_FIRST = re.compile(r"\bBAROMETER\s*:|\bD\s+[-+]?\d+(?:\.\d+)?\s*(?:m|ft|feet)\b")

Order = Literal["latitude_first", "longitude_first"]


@dataclass(frozen=True)
class _Cue:
    """What a subtitle says, a position of two bare numbers apart.

    Attributes
    ----------
    sample : Sample
    pair : (float, float) or None
        The numbers.
    order : {"latitude_first", "longitude_first"} or None
        As the form has them.
    """

    sample: Sample
    pair: tuple[float, float] | None
    order: Order | None


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
        (_seconds(cue.groups()), text[cue.end() : end])
        for cue, end in zip(cues, ends, strict=False)
    )
    if not telemetry.samples:
        raise TelemetryError(
            f"none of the {len(cues)} subtitles holds a height or a position in a form that DJI "
            "cameras write; leave this file out"
        )
    return telemetry


def read_embedded(source: str) -> Telemetry | None:
    """The telemetry in a video's subtitle stream; None where there is none."""
    telemetry = _collect(video.read_subtitles(source))
    return telemetry if telemetry.samples else None


def _collect(cues: Iterable[tuple[float, str]]) -> Telemetry:
    found, unread = [], 0
    for time_s, text in cues:
        cue = _read_cue(time_s, _TAG.sub(" ", text))
        if cue is None:
            unread += 1
        else:
            found.append(cue)
    samples = [*_placed(found)]
    samples.sort(key=lambda sample: sample.time_s)
    return Telemetry(tuple(samples), unread)


def _read_cue(time_s: float, text: str) -> _Cue | None:
    frame, clock = _FRAME.search(text), _CLOCK.search(text)
    place, pair = _position(text)
    height, altitude = _first(_HEIGHT, text), _first(_ALTITUDE, text)
    if height is None and altitude is None and place is None and pair is None:
        return None
    sample = Sample(
        time_s,
        int(frame[1]) if frame else None,
        height,
        altitude,
        place[0] if place else None,
        place[1] if place else None,
        clock[0] if clock else None,
    )
    order: Order | None = None
    if _LATITUDE_FIRST.search(text):
        order = "latitude_first"
    elif _LONGITUDE_FIRST.search(text):
        order = "longitude_first"
    return _Cue(sample, pair, order)


def _first(patterns: Sequence[re.Pattern[str]], text: str) -> float | None:
    for pattern in patterns:
        found = pattern.search(text)
        if found:
            unit_m = _FOOT_M if (found[2] or "")[:1] in ("f", "F") else 1.0
            return _number(found[1]) * unit_m
    return None


def _position(text: str) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    """Latitude and longitude, degrees, where labels tell them; else two bare numbers."""
    latitude, longitude = _LATITUDE.search(text), _LONGITUDE.search(text)
    signed, plain = _GPS_SIGNED.search(text), _GPS.search(text)
    if latitude and longitude:
        return _fix(_number(latitude[1]), _number(longitude[1])), None
    if signed:
        east, lon, north, lat = signed.groups()
        return (
            _fix(float(lat) * (1 if north == "N" else -1), float(lon) * (1 if east == "E" else -1)),
            None,
        )
    return None, (float(plain[1]), float(plain[2])) if plain else None


def _placed(cues: Sequence[_Cue]) -> Iterator[Sample]:
    """Samples with the positions of those that have two bare numbers, in one order for all."""
    pairs = [cue.pair for cue in cues if cue.pair is not None and any(cue.pair)]
    order = _order(cues, pairs) if pairs else None
    for cue in cues:
        place = None
        if cue.pair is not None and order is not None:
            place = _fix(*(cue.pair if order == "latitude_first" else cue.pair[::-1]))
        if place is None:
            yield cue.sample
        else:
            yield replace(cue.sample, latitude_deg=place[0], longitude_deg=place[1])


def _order(cues: Sequence[_Cue], pairs: Sequence[tuple[float, float]]) -> Order:
    """Which of two bare numbers is the latitude.

    Raises
    ------
    TelemetryError
        If nothing tells.
    """
    beyond = [max(abs(pair[place]) for pair in pairs) > 90 for place in (0, 1)]
    if beyond == [True, False]:
        return "longitude_first"
    if beyond == [False, True]:
        return "latitude_first"
    orders = {cue.order for cue in cues if cue.pair is not None}
    if len(orders) == 1 and (order := orders.pop()) is not None and not any(beyond):
        return order
    first, second = pairs[0]
    raise TelemetryError(
        f"GPS({first:g}, {second:g}): nothing tells which number is the latitude; label them "
        "[latitude: …] [longitude: …], or leave this file out",
        code="ambiguous_position",
    )


def _fix(latitude: float, longitude: float) -> tuple[float, float] | None:
    """None without a fix, where cameras write zeros, and where it is no place on earth."""
    if (latitude, longitude) == (0.0, 0.0) or abs(latitude) > 90 or abs(longitude) > 180:
        return None
    return latitude, longitude


def _number(text: str) -> float:
    return float(text.replace(",", "."))


def _seconds(parts: Sequence[str]) -> float:
    hours, minutes, seconds, fraction = parts
    whole = int(hours) * 3600 + int(minutes) * 60 + int(seconds)
    return whole + float(f"0.{fraction}")
