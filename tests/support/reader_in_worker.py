"""What a worker process does that starts a reader's process of its own."""

from __future__ import annotations

import math

from padstudio.experiments.shootout.reader_process import ReaderProcess


def root_of(value: float) -> float:
    """A square root, by another process."""
    with ReaderProcess() as process:
        return float(process.call(60, math.sqrt, value))
