"""What linear algebra does in a process."""

from __future__ import annotations

from pathlib import Path

import numpy as np


def threads_after_a_product(size: int) -> int:
    """How many threads this process has once it multiplied two square matrices; Linux only."""
    product = np.ones((size, size)) @ np.ones((size, size))
    assert product[0, 0] == size
    return len(list(Path("/proc/self/task").iterdir()))
