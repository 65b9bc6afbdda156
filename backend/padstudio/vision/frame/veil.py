"""A frame of little contrast, as through fog: its veil of light taken off, the rest made strong.

Fog adds light of its own to what it lets through (Koschmieder's law), even but for the lens's
fall-off. A polynomial takes off what is even, and one gain for all channels, so that colours keep
their order, spreads the rest: halved copies of the frame then average noise to a part of a grey
value of the frame, which they would round away.
"""

from __future__ import annotations

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.vision.frame.prepare import Stretch

# Channels that all span fewer grey values are veiled, unless the picture is dark.
_VEILED, _DARK = 40.0, 60.0
# The veil is fitted at about this width.
_WIDTH = 80
# Percentiles of what is left, at a quarter of the size, go to these grey values; noise spans more.
_ENDS, _LOW, _HIGH = (0.5, 99.5), 40.0, 215.0
# Grey values that are spread at the least.
_LEAST_RANGE = 4.0


def is_veiled(stretch: Stretch) -> bool:
    """True where a frame is of little contrast and not dark."""
    spans = (high - low for high, low in zip(stretch.high, stretch.low, strict=True))
    return max(spans) < _VEILED and min(stretch.low) > _DARK


def unveiled(image: Image) -> Image:
    """The frame without its veil, (H, W, 3) uint8."""
    height, width = image.shape[:2]
    size = (_WIDTH, max(1, round(_WIDTH * height / width)))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA).astype(np.float64)
    y, x = (np.linspace(-1, 1, count)[:, None] for count in (size[1], size[0]))
    terms = [np.ones((size[1], size[0])), x.T + 0 * y, y + 0 * x.T]
    terms += [x.T**2 + 0 * y, y**2 + 0 * x.T, y * x.T]
    columns = np.stack([term.ravel() for term in terms], axis=1)
    weights = np.linalg.lstsq(columns, small.reshape(-1, 3), rcond=None)[0]
    veil = (columns @ weights).reshape(small.shape).astype(np.float32)
    rest = cv2.subtract(image, cv2.resize(veil, (width, height)), dtype=cv2.CV_32F)
    quarter = cv2.resize(
        rest, (max(width // 4, 1), max(height // 4, 1)), interpolation=cv2.INTER_AREA
    )
    low, high = np.percentile(quarter, _ENDS, axis=(0, 1))
    gain = (_HIGH - _LOW) / max(_LEAST_RANGE, float((high - low).max()))
    rest -= low.astype(np.float32)
    return np.asarray(np.clip(rest * gain + _LOW, 0, 255).round().astype(np.uint8))
