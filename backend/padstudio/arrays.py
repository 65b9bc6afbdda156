"""Types of arrays that all parts share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

#: Figures of any shape.
Array = NDArray[np.float64]
#: Pictures, (H, W) or (H, W, 3), BGR where nothing else is said.
Image = NDArray[np.uint8]


Standard = Literal["bt601", "bt709"]


@dataclass(frozen=True, eq=False)
class YuvFrame:
    """A frame in planes, 4:2:0.

    Attributes
    ----------
    y : (H, n) uint8
    u, v : (H/2, m) uint8
        Half of an odd side is rounded up. C-contiguous; rows may hold more than the picture.
    width : int
        Columns of the picture, W.
    standard : {"bt601", "bt709"}
    full_range : bool
        Brightness is 0 … 255 rather than 16 … 235.
    make_bgr : callable
        Gives the frame as (H, W, 3) uint8, BGR.
    """

    y: Image
    u: Image
    v: Image
    width: int
    standard: Standard
    full_range: bool
    make_bgr: Callable[[], Image]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Of `bgr`."""
        return int(self.y.shape[0]), self.width, 3

    @cached_property
    def bgr(self) -> Image:
        """(H, W, 3) uint8."""
        return self.make_bgr()

    @property
    def gain(self) -> tuple[float, float]:
        """Grey values per unit of brightness, and the brightness of black."""
        return (1.0, 0.0) if self.full_range else (255 / 219, 16.0)
