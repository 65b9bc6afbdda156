"""Frames of the paper's experiments that were not simulated: readings as a test says."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from padstudio.experiments.reproduction.plan import EXPERIMENTS, ExperimentName, Shot, shots_of
from padstudio.experiments.reproduction.reading import LAYERS, METHODS, FrameRead, Reading

NAN = float("nan")
#: Whether a method reads a shot; the method may be followed by a layer.
Reads = Callable[[str, Shot], bool]


def frames_of(
    reads: Reads,
    names: Sequence[ExperimentName] = EXPERIMENTS,
    seeds: int = 4,
    error_mm: float = 0.1,
) -> list[FrameRead]:
    """Frames at their nominal places; what is measured is off by `error_mm` along each axis."""
    return [synthetic(shot, reads, error_mm) for shot in shots_of(names, seeds)]


def synthetic(shot: Shot, reads: Reads, error_mm: float = 0.1) -> FrameRead:
    """One of them."""
    where = shot.where
    true = (where.x_mm, where.y_mm, where.height_mm)
    kinds = [*METHODS, *(f"{m} {layer}" for m in METHODS for layer in LAYERS if shot.by_layer)]
    readings = {kind: _reading(true, reads(kind, shot), error_mm, where.tilt_deg) for kind in kinds}
    return FrameRead(shot, true, (0.0, 0.0, -1.0), where.tilt_deg, readings)


def _reading(true: Sequence[float], ok: bool, error_mm: float, tilt_deg: float) -> Reading:
    if not ok:
        return Reading("", "decode: unknown_code", (), (), NAN, NAN, NAN, False)
    place = tuple(value + error_mm for value in true)
    off = float(np.sqrt(3) * abs(error_mm))
    return Reading("red", "", place, (0.0, 0.0, -1.0), tilt_deg + 0.01, off, 0.01, False)
