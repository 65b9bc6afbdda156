"""What a print shows beside the cells."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import get_args

from padstudio.errors import SpecError, shown
from padstudio.pad.sheets.tiling import SheetOptions
from padstudio.pad.spec import Pad
from padstudio.render.painters.inks import Ink

# Header and footer: one line of text, and the room that it needs.
_LONGEST_TEXT = 200
_TEXT_ROOM_MM = 6.0


@dataclass(frozen=True, kw_only=True)
class PrintOptions:
    """How a pad is printed.

    Attributes
    ----------
    sheets : SheetOptions
        By default one page of the pad's own size with nothing beside the pad.
    dpi : float
        Resolution of pixel pictures.
    ink : {"rgb", "cmyk"}
    outline_mm : float
        Width of a line round the quiet margin; 0 for none.
    header, footer : str
        Text in the quiet margin above and below the pad.
    qr : bool
        Print the pad's id and a QR code with its spec: beside the pad, and in its quiet margin
        where that is at least 15 mm wide.
    assembly_map : bool
        Begin with a map of the sheets, where there are more than one.
    measured : (x, y)
        Size of this printer's prints over their nominal size, as measured with the rulers of an
        earlier print: the print is made smaller or larger to come out right.
    """

    sheets: SheetOptions = field(default_factory=SheetOptions.bare)
    dpi: float = 150.0
    ink: Ink = "rgb"
    outline_mm: float = 0.0
    header: str = ""
    footer: str = ""
    qr: bool = True
    assembly_map: bool = True
    measured: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        if self.ink not in get_args(Ink):
            raise SpecError(f"ink is {shown(self.ink)}; use {', '.join(get_args(Ink))}")
        if not (math.isfinite(self.outline_mm) and 0 <= self.outline_mm <= 100):
            raise SpecError(f"outline_mm is {self.outline_mm}; give 0 … 100 mm")
        if max(len(self.header), len(self.footer)) > _LONGEST_TEXT:
            raise SpecError(f"header and footer hold at most {_LONGEST_TEXT} characters")
        if not all(math.isfinite(part) and 0.9 <= part <= 1.1 for part in self.measured):
            raise SpecError(
                f"measured is {self.measured}; a printer that is off by more than 10 % scales the "
                "page: turn that off in the print dialogue"
            )

    def check(self, pad: Pad) -> None:
        """Refuse what this pad has no room for.

        Raises
        ------
        SpecError
        """
        if (self.header or self.footer) and pad.quiet_mm < _TEXT_ROOM_MM:
            raise SpecError(
                f"header and footer stand in the quiet margin, which is {pad.quiet_mm:g} mm; make "
                f"quiet_mm at least {_TEXT_ROOM_MM:g}"
            )
