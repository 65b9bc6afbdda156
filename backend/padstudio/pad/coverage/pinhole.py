"""A camera as plain numbers, and what of the ground it shows; this package knows no lenses."""

from __future__ import annotations

import math
from dataclasses import dataclass

from padstudio.errors import SpecError

# A square turned by 22.5 degrees is this much wider than its side: half of all headings are wider.
_TURNED = math.cos(math.pi / 8) + math.sin(math.pi / 8)


@dataclass(frozen=True, kw_only=True)
class View:
    """A pinhole camera whose axis meets the pad.

    Attributes
    ----------
    width_px, height_px : int
    focal_px : float
    """

    width_px: int
    height_px: int
    focal_px: float

    def __post_init__(self) -> None:
        if min(self.width_px, self.height_px) < 1 or not 1e-3 <= self.focal_px <= 1e9:
            raise SpecError("a view has a width, a height and a focal length of 0.001 … 1e9 pixels")

    @property
    def side_px(self) -> int:
        """The picture's shorter side."""
        return min(self.width_px, self.height_px)

    def extent_per_height(self, tilt_deg: float) -> float:
        """Length of ground across the picture's middle, over the camera's height.

        The shorter of the picture's two middle lines counts; infinite where it meets the horizon.
        """
        tilt = radians(tilt_deg)
        extents = []
        # The axis leans along the one side or the other: the worse of the two must do.
        for along, across in ((self.width_px, self.height_px), (self.height_px, self.width_px)):
            half = math.atan(along / 2 / self.focal_px)
            if tilt + half < math.pi / 2:
                extents.append(math.tan(tilt + half) - math.tan(tilt - half))
            extents.append(across / self.focal_px / math.cos(tilt))
        return min(extents)

    def cells_across(self, cell_mm: float, height_mm: float, tilt_deg: float = 0.0) -> float:
        """Cells across the picture's shorter middle line."""
        return self.extent_per_height(tilt_deg) * height_mm / cell_mm

    def cell_px(self, cell_mm: float, height_mm: float, tilt_deg: float = 0.0) -> float:
        """Width in pixels of a cell on the optical axis: the geometric mean of its two sides.

        Tilt shrinks one side by cos θ, as it lies farther away, and the other by cos² θ.
        """
        return self.focal_px * cell_mm * math.pow(math.cos(radians(tilt_deg)), 1.5) / height_mm

    def shorter_px(self, side_mm: float, height_mm: float, tilt_deg: float = 0.0) -> float:
        """Shorter side in pixels of a square on the optical axis whose sides lie along the lean."""
        return self.focal_px * side_mm * math.cos(radians(tilt_deg)) ** 2 / height_mm

    def holds_from_mm(self, side_mm: float, tilt_deg: float = 0.0) -> float:
        """Height from which a square round the optical axis lies within the picture.

        Half of all headings need no more. Its nearer edge, which looks the wider, counts.
        """
        tilt, wide_mm = radians(tilt_deg), _TURNED * side_mm
        distance_mm = self.focal_px * wide_mm / self.side_px + wide_mm / 2 * math.sin(tilt)
        return distance_mm * math.cos(tilt)


def radians(tilt_deg: float) -> float:
    """A tilt in radians.

    Raises
    ------
    SpecError
        If it is not within 0 … 89 degrees.
    """
    if not 0 <= tilt_deg <= 89:
        raise SpecError(f"the tilt is {tilt_deg} degrees; it must lie within 0 … 89")
    return math.radians(tilt_deg)
