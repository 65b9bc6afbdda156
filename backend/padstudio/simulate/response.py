"""What a sensor makes of light: its spectral response, and lamps of few colours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import SpecError

Row = tuple[float, float, float]
# Share of each channel in what a surface reflects beyond 700 nm, as far as prints do not tell.
_TOWARD_RED = (0.7, 0.3, 0.0)


@dataclass(frozen=True, kw_only=True)
class Response:
    """A linear map from the scene's colours to the sensor's channels.

    Spectra are known here by three broad bands (linear sRGB) and the near infrared, so a response
    is a matrix over those four: each row sums light times sensitivity over the spectrum, as the
    Luther condition has it (Wyszecki and Stiles, Color Science, 1982, section 5.5).

    Attributes
    ----------
    matrix : one or three rows of (r, g, b)
        One row is a monochrome sensor without a mosaic; its picture is stored in three equal
        channels.
    infrared : one or three numbers
        What each row takes of the near infrared, of a lens without a blocking filter.
    """

    matrix: tuple[Row, ...]
    infrared: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, float)
        if matrix.shape not in ((1, 3), (3, 3)):
            raise SpecError("a response has one or three rows of three weights each")
        if not self.infrared:
            object.__setattr__(self, "infrared", (0.0,) * len(matrix))
        infrared = np.array(self.infrared, float)
        if infrared.shape != (len(matrix),):
            raise SpecError("a response takes of the infrared one weight a row")
        weights = np.column_stack([matrix, infrared])
        if not (np.isfinite(weights).all() and (np.abs(weights) <= 10).all()):
            raise SpecError("each weight of a response must lie within -10 … 10")

    @property
    def mono(self) -> bool:
        """True where there is one channel."""
        return len(self.matrix) == 1

    def sensed(
        self, light: NDArray[np.float32], infrared: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]:
        """Light as the sensor sees it.

        Parameters
        ----------
        light : (H, W, 3) float32
            Linear RGB.
        infrared : (H, W, 3) float32, optional
            The same picture in the near infrared.

        Returns
        -------
        (H, W, 3) float32
            Three equal channels of a monochrome sensor.
        """
        out = light @ np.array(self.matrix, np.float32).T
        if infrared is not None:
            grey = infrared @ np.array(_TOWARD_RED, np.float32)
            out += grey[..., None] * np.array(self.infrared, np.float32)
        np.maximum(out, 0, out=out)
        if self.mono:
            out = np.repeat(out, 3, axis=2)
        return np.ascontiguousarray(out)


# A low-pressure lamp's 589 nm is seen by red and green; a high-pressure one adds a little of all.
_AT_589 = np.array([0.62, 0.38, 0.0])
_SODIUM = 0.85 * np.outer([1.0, 0.5, 0.02], _AT_589) + 0.08 * np.eye(3)


def _rows(matrix: NDArray[np.float64]) -> tuple[Row, ...]:
    return tuple((float(r), float(g), float(b)) for r, g, b in matrix)


#: By name: a plain monochrome sensor, the luma of a colour camera (BT.709), the near infrared
#: alone, a colour camera without its blocking filter, street light, and a violet lamp.
RESPONSES = {
    "mono": Response(matrix=((0.34, 0.38, 0.28),)),
    "luma": Response(matrix=((0.2126, 0.7152, 0.0722),)),
    "nir": Response(matrix=((0.0, 0.0, 0.0),), infrared=(1.0,)),
    "no-ir-filter": Response(
        matrix=((0.6, 0.0, 0.0), (0.0, 0.55, 0.0), (0.0, 0.0, 0.55)), infrared=(0.4, 0.38, 0.4)
    ),
    "sodium": Response(matrix=_rows(_SODIUM)),
    "violet": Response(matrix=((0.12, 0.0, 0.02), (0.01, 0.08, 0.06), (0.02, 0.04, 0.9))),
}
