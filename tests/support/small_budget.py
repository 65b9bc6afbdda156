"""Budgets that are simulated in moments: a small camera over a small pad."""

from collections.abc import Sequence

import numpy as np

from padstudio.experiments.budget.conditions import Conditions
from padstudio.experiments.budget.frames import Reading, read_frame
from padstudio.experiments.budget.order import BudgetOrder, Case
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Layer, Pad

#: Everything off but pixels and noise.
NOTHING = {
    "exposure_ms": 0.0,
    "readout_ms": 0.0,
    "scale_percent": 0.0,
    "waves_mm": 0.0,
    "focal_percent": 0.0,
    "principal_px": 0.0,
    "distortion_px": 0.0,
    "mbit_s": 0.0,
}


def small_pad() -> Pad:
    """24 × 24 cells of 20 mm in red."""
    field = np.random.default_rng(6).integers(0, 2, (24, 24)).astype(np.uint8)
    return Pad((Layer("red", 20.0, field),), name="small")


def small_camera(scale: float = 1.0) -> Camera:
    """A camera of 320 × 241 pixels, which has an odd height."""
    matrix = np.array([[300.0, 0, 159.5], [0, 300.0, 120.0], [0, 0, 1]])
    return Camera(320, 241, matrix).for_frame(round(320 * scale), round(241 * scale))


def small_order(
    height_mm: float = 450.0, frames: int = 8, camera: Camera | None = None, **sizes: float
) -> BudgetOrder:
    """An order with all off but what is given."""
    camera = camera or small_camera()
    return BudgetOrder(
        pad=small_pad(),
        camera=camera,
        height_mm=height_mm,
        conditions=Conditions.of(camera, NOTHING | sizes),
        frames=frames,
    )


def read_here(order: BudgetOrder, cases: Sequence[Case]) -> list[list[Reading]]:
    """All frames of each case."""
    frames = [read_frame(order, each, cases, lambda: None) for each in range(order.frames)]
    return [list(readings) for readings in zip(*frames, strict=True)]
