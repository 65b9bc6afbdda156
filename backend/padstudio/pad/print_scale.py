"""The size that a print came out at, read off its rulers."""

from __future__ import annotations

import dataclasses
import math

from padstudio.errors import SpecError
from padstudio.pad.spec import Pad


def print_scale(ruler_mm: float, read_mm: float) -> float:
    """Measured over nominal size, from a printed ruler and what a true ruler says of it.

    Raises
    ------
    SpecError
        If either is not positive, or they differ by more than a factor of two.
    """
    if not (math.isfinite(ruler_mm) and ruler_mm > 0):
        raise SpecError(f"the printed ruler is {ruler_mm} mm; give its length, such as 200")
    if not (math.isfinite(read_mm) and 0.5 <= read_mm / ruler_mm <= 2):
        raise SpecError(
            f"{read_mm} mm read off a ruler of {ruler_mm:g} mm is more than a factor of two off; "
            "give what a true ruler says of the printed one, in mm"
        )
    return read_mm / ruler_mm


def with_measured_size(pad: Pad, *, ruler_mm: float, x_mm: float, y_mm: float) -> Pad:
    """The pad with the scale of its print, which poses then use; nothing need be printed again.

    Parameters
    ----------
    pad : Pad
    ruler_mm : float
        Nominal length of the printed rulers.
    x_mm, y_mm : float
        What a true ruler says of the ruler along x and of the one along y.

    Raises
    ------
    SpecError
        As `print_scale`.
    """
    scale = (print_scale(ruler_mm, x_mm), print_scale(ruler_mm, y_mm))
    return dataclasses.replace(pad, scale=scale)
