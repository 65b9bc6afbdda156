"""Colours as the printer gets them: RGB light, or CMYK inks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

Ink = Literal["rgb", "cmyk"]


def fill_operator(rgb: Sequence[int], ink: Ink) -> str:
    """The PDF operator that sets the fill colour to an 8-bit RGB value in the chosen inks."""
    if ink == "rgb":
        return " ".join(f"{value / 255:.4g}" for value in rgb) + " rg"
    return " ".join(f"{value:.4g}" for value in to_cmyk(rgb)) + " k"


def to_cmyk(rgb: Sequence[int]) -> tuple[float, float, float, float]:
    """Cyan, magenta, yellow, black, each 0 … 1, of an 8-bit RGB value.

    Dark is black ink alone: its edges stay sharp where the coloured inks are out of register.
    """
    light = max(rgb) / 255
    if light == 0:
        return 0.0, 0.0, 0.0, 1.0
    cyan, magenta, yellow = (1 - value / 255 / light for value in rgb)
    return cyan, magenta, yellow, 1 - light
