"""The pictures of the documents: kept small, and compared with what the pages show.

With ``PADSTUDIO_TAKE_PICTURES=1`` they are written to ``docs/images``; else they are compared with
those there, roughly: a page that has become another is to be taken anew.
"""

from __future__ import annotations

import os

import cv2
import numpy as np
from numpy.typing import NDArray
from places import ROOT

IMAGES = ROOT / "docs" / "images"
#: Taken on the way of the README's session.
SESSION = ("failing", "sweep")
#: Taken by a browser whose camera is over a pad.
LIVE = ("live",)
MOST_BYTES = 60_000
_WIDEST = 1000
_QUALITIES = (82, 70, 58, 46, 34)
# Of the kept picture; text and charts may grow a little.
_TALLER = 1.25
_SMALL = (64, 64)


def keep_or_compare(name: str, png: bytes) -> None:
    """Write a picture of a page, where that is wanted, and hold it to the kept one."""
    taken = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    assert taken is not None
    path = IMAGES / f"{name}.webp"
    if os.environ.get("PADSTUDIO_TAKE_PICTURES"):
        path.write_bytes(_small(taken))
    kept = cv2.imread(str(path))
    assert kept is not None, f"{path} is missing: take it with PADSTUDIO_TAKE_PICTURES=1"
    assert path.stat().st_size <= MOST_BYTES
    assert 1 / _TALLER < _slope(taken) / _slope(kept) < _TALLER
    # What is drawn is there: neither picture is blank.
    for picture in (taken, kept):
        assert cv2.resize(picture, _SMALL).std() > 5


def _slope(picture: NDArray[np.uint8]) -> float:
    return float(picture.shape[0] / picture.shape[1])


def _small(picture: NDArray[np.uint8]) -> bytes:
    """As WebP, as wide and as good as the bytes allow."""
    width = min(_WIDEST, picture.shape[1])
    while True:
        size = (width, round(width * _slope(picture)))
        smaller = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
        for quality in _QUALITIES:
            data = cv2.imencode(".webp", smaller, [cv2.IMWRITE_WEBP_QUALITY, quality])[1]
            if len(data) <= MOST_BYTES:
                return data.tobytes()
        width = round(0.85 * width)
