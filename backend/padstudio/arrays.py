"""Types of arrays that all parts share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: Figures of any shape.
Array = NDArray[np.float64]
#: Pictures, (H, W) or (H, W, 3), BGR where nothing else is said.
Image = NDArray[np.uint8]
