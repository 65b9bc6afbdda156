"""A layer's cells read with a known pose, and what they say of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.pad.spec import Layer
from padstudio.vision.cells.evidence import Evidence
from padstudio.vision.cells.sampling import CellGrid


@dataclass(frozen=True, eq=False)
class LayerRead:
    """A layer's cells read with a known pose.

    Attributes
    ----------
    layer : Layer
    cells : CellGrid
    expected : (R, C) int8
        Levels that the pad has there.
    evidence : Evidence
    area_mm2 : float
        Area of the cells read.
    """

    layer: Layer
    cells: CellGrid
    expected: NDArray[np.int8]
    evidence: Evidence
    area_mm2: float
