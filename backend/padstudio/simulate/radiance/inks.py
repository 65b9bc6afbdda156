"""What a printer makes of a pad's nominal colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.color import linear_from_srgb, srgb_from_linear
from padstudio.errors import SpecError

Rgb = tuple[float, float, float]
Eight = tuple[float, float, float, float, float, float, float, float]


@dataclass(frozen=True, kw_only=True)
class Inks:
    """How the eight full colours look on paper, as sRGB 0 … 255 of a correctly exposed picture.

    The defaults are an office laser print: no primary is pure, so that each channel sees the other
    layer too. Levels between dark and full are printed as fine screens, whose average is linear in
    light (Demichel's equations over the Neugebauer primaries).

    Attributes
    ----------
    black, red, green, blue, yellow, magenta, cyan, white : (r, g, b)
    infrared_greys : (8,)
        The same inks at 850 nm, sRGB of a grey: black, red, green, yellow, blue, magenta, cyan,
        white. Carbon stays black, colours bleach, those with cyan the least.
    """

    black: Rgb = (49.0, 49.0, 53.0)
    red: Rgb = (177.0, 65.0, 63.0)
    green: Rgb = (62.0, 148.0, 76.0)
    blue: Rgb = (63.0, 80.0, 161.0)
    yellow: Rgb = (214.0, 196.0, 60.0)
    magenta: Rgb = (174.0, 81.0, 158.0)
    cyan: Rgb = (56.0, 152.0, 176.0)
    white: Rgb = (226.0, 224.0, 226.0)
    infrared_greys: Eight = (50.0, 176.0, 150.0, 196.0, 128.0, 202.0, 188.0, 226.0)

    def __post_init__(self) -> None:
        values = self._primaries()
        if not (np.isfinite(values).all() and (values >= 0).all() and (values <= 255).all()):
            raise SpecError("each ink is three sRGB values within 0 … 255")
        greys = np.array(self.infrared_greys, float)
        if greys.shape != (8,) or not ((greys >= 0) & (greys <= 255)).all():
            raise SpecError("infrared_greys are eight sRGB values within 0 … 255")

    @classmethod
    def ideal(cls) -> Inks:
        """Inks that are the pad's nominal colours: red is (255, 0, 0) and so on."""
        return cls(
            black=(0, 0, 0),
            red=(255, 0, 0),
            green=(0, 255, 0),
            blue=(0, 0, 255),
            yellow=(255, 255, 0),
            magenta=(255, 0, 255),
            cyan=(0, 255, 255),
            white=(255, 255, 255),
        )

    def infrared(self) -> Inks:
        """How the same print looks to a camera that sees the near infrared alone."""
        greys = [(grey, grey, grey) for grey in self.infrared_greys]
        return replace(self._printed(greys), infrared_greys=Inks.infrared_greys)

    def faded(self, share: float) -> Inks:
        """The print after years in the sun: so much of its dyes is gone.

        A dye's density is its amount (Beer and Lambert), so that what it takes of the paper's
        reflectance shrinks by a power. Carbon black loses a third of what colours lose.

        Parameters
        ----------
        share : float
            0 … 1.
        """
        if not 0 <= share <= 1:
            raise SpecError(f"the share of faded ink is {share}; it must lie within 0 … 1")
        linear = linear_from_srgb(self._primaries() / 255.0)
        paper = np.maximum(linear[7], 1e-6)
        left = np.full((8, 1), 1 - share)
        left[0] = 1 - share / 3
        srgb = 255.0 * srgb_from_linear(paper * (np.maximum(linear, 1e-6) / paper) ** left)
        colors = [(float(r), float(g), float(b)) for r, g, b in np.clip(srgb, 0, 255)]
        return self._printed(colors)

    def _printed(self, colors: Sequence[Rgb]) -> Inks:
        """With eight other colours, in the order of `infrared_greys`."""
        black, red, green, yellow, blue, magenta, cyan, white = colors
        return replace(
            self,
            black=black,
            red=red,
            green=green,
            blue=blue,
            yellow=yellow,
            magenta=magenta,
            cyan=cyan,
            white=white,
        )

    def reflectance(self, colors: NDArray[np.uint8]) -> NDArray[np.float32]:
        """Linear reflectance of nominal colours.

        Parameters
        ----------
        colors : (..., 3) uint8
            Nominal RGB as `padstudio.pad.layout.Layout.colors`.

        Returns
        -------
        (..., 3) float32
            Linear RGB, 0 … 1.
        """
        # A print has many patches of few colours.
        packed = np.asarray(colors, np.uint32) @ np.array([1, 1 << 8, 1 << 16], np.uint32)
        kinds, places = np.unique(packed, return_inverse=True)
        mixed = self._mix((kinds[:, None] >> np.array([0, 8, 16], np.uint32)).astype(np.uint8))
        return mixed[places.reshape(packed.shape)]

    def _mix(self, colors: NDArray[np.uint8]) -> NDArray[np.float32]:
        """(N, 3) linear reflectances of nominal colours (N, 3)."""
        table = linear_from_srgb(self._primaries() / 255.0)
        share = np.asarray(colors, float) / 255.0
        out = np.zeros(share.shape)
        for index in range(8):
            weight = np.ones(share.shape[:-1])
            for channel in range(3):
                full = index >> channel & 1
                weight = weight * (share[..., channel] if full else 1 - share[..., channel])
            out += weight[..., None] * table[index]
        return out.astype(np.float32)

    def _primaries(self) -> Array:
        """(8, 3) sRGB; bit 0 of the row number is red, bit 1 green, bit 2 blue."""
        return np.array(
            [
                self.black,
                self.red,
                self.green,
                self.yellow,
                self.blue,
                self.magenta,
                self.cyan,
                self.white,
            ],
            float,
        )
