"""Preloaded by workers that share the machine with the server, which shall answer first."""

from __future__ import annotations

import os
from typing import Any

# Between the server, at 0, and what runs when nothing else does.
_NICENESS = 10


def dask_setup(worker: Any) -> None:
    """Lower the priority of the process; Dask calls this by its name."""
    os.nice(max(0, _NICENESS - os.nice(0)))
