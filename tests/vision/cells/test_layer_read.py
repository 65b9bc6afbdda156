"""Cells of a layer, and of all layers together, as evidence for one pose."""

from __future__ import annotations

import pytest
from dense_frames import frame_of, random_pad, small_camera

from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.cells.layer_read import LayerRead, judge_together, read_layer
from padstudio.vision.frame.pyramid import Pyramid

PAD = random_pad(3)
NEAR = look_at_pad(70.0, tilt_deg=5, heading_deg=30, tilt_towards_deg=80, target_mm=(110, -60))


def reads_at(pose: Pose) -> list[LayerRead]:
    """Both layers of a frame from near by, where a pose puts them."""
    pyramid = Pyramid(frame_of(NEAR, pad=PAD, camera=small_camera()))
    found = [
        read_layer(pyramid, small_camera(), PAD, layer, MovingPose(pose), 25)
        for layer in PAD.layers
    ]
    return [read for read in found if read is not None]


def test_cells_of_all_layers_together_are_less_likely_chance() -> None:
    reads = reads_at(NEAR)
    assert len(reads) == 2
    together = judge_together(reads)
    assert together.read == sum(read.evidence.read for read in reads)
    assert together.wrong == 0
    assert together.log10_false_alarm < min(read.evidence.log10_false_alarm for read in reads)


def test_a_layer_alone_is_as_sure_together() -> None:
    fine = reads_at(NEAR)[:1]
    assert judge_together(fine) == fine[0].evidence


@pytest.mark.parametrize("shift_mm", [10.0, 30.0, 50.0])
def test_layers_that_lie_elsewhere_are_chance_together(shift_mm: float) -> None:
    aside = Pose(NEAR.position_mm + (shift_mm, -shift_mm, 0.0), NEAR.rotation)
    assert judge_together(reads_at(aside)).log10_false_alarm > -2.0
