"""Frames as cameras see them that do not tell red from blue."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from padstudio.arrays import Image


def grey(bgr: Image, shares: tuple[float, float, float]) -> Image:
    """All channels alike, of so much blue, green and red."""
    mixed = np.clip(bgr.astype(float) @ shares, 0, 255).astype(np.uint8)
    return np.repeat(mixed[:, :, None], 3, axis=2)


def sodium(bgr: Image) -> Image:
    """Yellow light: the blue channel shows little, and of both layers."""
    blue, green, red = (bgr[:, :, k].astype(float) for k in range(3))
    yellow = 0.8 * red + 0.2 * green
    channels = [0.25 * yellow + 0.1 * blue, 0.6 * yellow, yellow]
    return np.clip(np.stack(channels, axis=-1), 0, 255).astype(np.uint8)


#: Changes of a colour frame, by name.
GREY: dict[str, Callable[[Image], Image]] = {
    "luma": lambda bgr: grey(bgr, (0.114, 0.587, 0.299)),
    "monochrome": lambda bgr: grey(bgr, (1 / 3, 1 / 3, 1 / 3)),
    "near infrared": lambda bgr: grey(bgr, (0.15, 0.15, 0.7)),
    "sodium": sodium,
}
