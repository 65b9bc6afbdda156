"""The colour test strip: patches in known order between four markers; one layout, mm, y down.

It is printed like a pad and photographed, to learn what a printer and a camera make of the
colours (`padstudio.vision.strip_photo`).
"""

from __future__ import annotations

from dataclasses import dataclass

from padstudio.pad.sheets.paper import Box

# The strip fits on A4 and Letter, two rows of patches between markers of 14 mm.
WIDTH_MM = 180.0
HEIGHT_MM = 54.0
MARKER_MM = 14.0
#: Markers of OpenCV's dictionary DICT_4X4_50, by number: top left, then clockwise.
MARKER_CORNERS_MM = (
    (0.0, 0.0),
    (WIDTH_MM - MARKER_MM, 0.0),
    (WIDTH_MM - MARKER_MM, HEIGHT_MM - MARKER_MM),
    (0.0, HEIGHT_MM - MARKER_MM),
)
PATCH_MM = 24.0
GAP_MM = 5.0
_FIRST_X_MM = 20.0
_ROW_PITCH_MM = HEIGHT_MM - PATCH_MM
_COLORS = (
    ("black", (0, 0, 0)),
    ("red", (255, 0, 0)),
    ("blue", (0, 0, 255)),
    ("magenta", (255, 0, 255)),
    ("white", (255, 255, 255)),
    ("grey 43", (43, 43, 43)),
    ("grey 85", (85, 85, 85)),
    ("grey 128", (128, 128, 128)),
    ("grey 170", (170, 170, 170)),
    ("grey 213", (213, 213, 213)),
)
_PER_ROW = 5


@dataclass(frozen=True)
class Patch:
    """One colour of the strip.

    Attributes
    ----------
    name : str
    rgb : (r, g, b)
        Nominal, 8 bit.
    box : Box
        Strip coordinates: origin at the top left marker's corner, mm, y down.
    """

    name: str
    rgb: tuple[int, int, int]
    box: Box

    @property
    def gaps(self) -> tuple[Box, Box]:
        """Bare paper to the left and right of the patch."""
        box = self.box
        return (
            Box(box.x0 - GAP_MM, box.y0, box.x0, box.y1),
            Box(box.x1, box.y0, box.x1 + GAP_MM, box.y1),
        )


def _patch(place: int, name: str, rgb: tuple[int, int, int]) -> Patch:
    row, col = divmod(place, _PER_ROW)
    x, y = _FIRST_X_MM + col * (PATCH_MM + GAP_MM), row * _ROW_PITCH_MM
    return Patch(name, rgb, Box(x, y, x + PATCH_MM, y + PATCH_MM))


PATCHES: tuple[Patch, ...] = tuple(
    _patch(place, name, rgb) for place, (name, rgb) in enumerate(_COLORS)
)
