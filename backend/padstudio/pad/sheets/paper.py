"""Papers: names, sizes, and the part of a sheet that a pad can use."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from padstudio.errors import SpecError

#: Width and height in portrait, mm (ISO 216; ANSI/ASME Y14.1 for the American ones).
PAPERS_MM: dict[str, tuple[float, float]] = {
    "A4": (210.0, 297.0),
    "A3": (297.0, 420.0),
    "A2": (420.0, 594.0),
    "A1": (594.0, 841.0),
    "A0": (841.0, 1189.0),
    "Letter": (215.9, 279.4),
    "Legal": (215.9, 355.6),
    "Tabloid": (279.4, 431.8),
}
# Beyond these no printer has a sheet or a roll.
MIN_SIDE_MM = 50.0
MAX_SIDE_MM = 50_000.0
_NAMES = {name.lower(): name for name in PAPERS_MM}
_SIZE = re.compile(r"(\d+(?:\.\d+)?)\s*[x×]\s*(\d+(?:\.\d+)?)(?:\s*mm)?", re.IGNORECASE)


@dataclass(frozen=True)
class Paper:
    """A size of sheets, as they lie in the printer.

    Attributes
    ----------
    name : str
        A name of `PAPERS_MM`, or ``WIDTHxHEIGHT`` in mm.
    width_mm, height_mm : float
    """

    name: str
    width_mm: float
    height_mm: float

    @property
    def orientation(self) -> str:
        """``portrait`` or ``landscape``."""
        return "portrait" if self.width_mm <= self.height_mm else "landscape"

    def turned(self) -> Paper:
        """The same sheets turned by a quarter."""
        return Paper(self.name, self.height_mm, self.width_mm)


def parse_paper(text: str) -> Paper:
    """A paper from its name, or from a size such as ``610x914`` (mm).

    Raises
    ------
    SpecError
        If the name is unknown, or the size beyond 50 mm … 50 m.
    """
    name = _NAMES.get(text.strip().lower())
    if name is not None:
        return Paper(name, *PAPERS_MM[name])
    found = _SIZE.fullmatch(text.strip())
    if found is None:
        raise SpecError(
            f"{text[:40]!r} is no paper; use {', '.join(PAPERS_MM)}, or WIDTHxHEIGHT in mm"
        )
    width, height = (float(number) for number in found.groups())
    if not (min(width, height) >= MIN_SIDE_MM and max(width, height) <= MAX_SIDE_MM):
        raise SpecError(
            f"a sheet of {width:g} x {height:g} mm is beyond {MIN_SIDE_MM:g} … {MAX_SIDE_MM:g} mm "
            "a side"
        )
    return Paper(f"{width:g}x{height:g}", width, height)


@dataclass(frozen=True)
class Box:
    """An upright rectangle, mm; y runs down."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def width(self) -> float:
        """Extent in x, mm."""
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        """Extent in y, mm."""
        return self.y1 - self.y0


@dataclass(frozen=True)
class Bands:
    """What rulers, labels and cut marks take of each side of a sheet, inside the margins, mm."""

    left: float = 12.0
    top: float = 10.0
    right: float = 5.0
    bottom: float = 12.0


NO_BANDS = Bands(0.0, 0.0, 0.0, 0.0)


def usable_box(paper: Paper, margin_mm: float, bands: Bands) -> Box:
    """The part of a sheet for the pad, from the sheet's top left.

    Raises
    ------
    SpecError
        If the margins leave less than 20 mm.
    """
    if not (math.isfinite(margin_mm) and margin_mm >= 0):
        raise SpecError(f"margin_mm is {margin_mm}; give 0 or more")
    box = Box(
        margin_mm + bands.left,
        margin_mm + bands.top,
        paper.width_mm - margin_mm - bands.right,
        paper.height_mm - margin_mm - bands.bottom,
    )
    if min(box.width, box.height) < 20:
        raise SpecError(
            f"margins of {margin_mm:g} mm leave {max(box.width, 0):g} x {max(box.height, 0):g} mm "
            f"of {paper.name} for the pad, beside rulers and labels; take smaller margins or a "
            "larger paper"
        )
    return box
