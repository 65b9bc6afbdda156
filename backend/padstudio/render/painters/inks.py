"""Colours as the printer gets them: RGB light, or CMYK inks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

Ink = Literal["rgb", "cmyk"]


def fill_operator(rgb: Sequence[int], ink: Ink) -> str:
    """The PDF operator that sets the fill colour to an 8-bit RGB value in the chosen inks."""
    return f"{_amounts(rgb, ink)} {'rg' if ink == 'rgb' else 'k'}"


def stroke_operator(rgb: Sequence[int], ink: Ink) -> str:
    """The same for lines."""
    return f"{_amounts(rgb, ink)} {'RG' if ink == 'rgb' else 'K'}"


def to_cmyk(rgb: Sequence[int]) -> tuple[float, float, float, float]:
    """Cyan, magenta, yellow, black, each 0 … 1, of an 8-bit RGB value.

    Dark is black ink alone: its edges stay sharp where the coloured inks are out of register.
    """
    light = max(rgb) / 255
    if light == 0:
        return 0.0, 0.0, 0.0, 1.0
    cyan, magenta, yellow = (1 - value / 255 / light for value in rgb)
    return cyan, magenta, yellow, 1 - light


def _amounts(rgb: Sequence[int], ink: Ink) -> str:
    amounts = [value / 255 for value in rgb] if ink == "rgb" else to_cmyk(rgb)
    return " ".join(f"{amount:.4g}" for amount in amounts)
