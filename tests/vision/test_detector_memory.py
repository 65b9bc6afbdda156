"""What a frame needed goes with its detection, without waiting for the collector of cycles."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import numpy as np
import pytest
from dense_frames import frame_of, random_pad, sample_pad, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.detector import Detector
from padstudio.vision.frame.pyramid import Pyramid, Window


@pytest.fixture
def cycles() -> Iterator[list[object]]:
    """Objects that only the collector of cycles frees."""
    gc.collect()
    gc.disable()
    gc.set_debug(gc.DEBUG_SAVEALL)
    yield gc.garbage
    gc.set_debug(0)
    gc.garbage.clear()
    gc.enable()


@pytest.mark.parametrize("height_mm", [120.0, 800.0, 2000.0, 7000.0])
@pytest.mark.parametrize("known", [sample_pad(), random_pad(9)], ids=["read", "another pad"])
def test_no_picture_is_held_in_a_cycle(cycles: list[object], height_mm: float, known) -> None:
    frame = frame_of(look_at_pad(height_mm, tilt_deg=8), camera=small_camera())
    detector = Detector(known, small_camera())
    for _ in detector.track([frame] * 3):
        pass
    gc.collect()
    held = [item for item in cycles if isinstance(item, np.ndarray | Window | Pyramid)]
    assert held == []
