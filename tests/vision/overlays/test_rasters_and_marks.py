"""Stages as plain pictures in their place, and as data, of both methods."""

from __future__ import annotations

import json

import numpy as np
import pytest
from paper_frames import frame_of, sample_pad, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import lattice_mm
from padstudio.vision.detector import Detector
from padstudio.vision.overlays.rasters import Raster, raster_of
from padstudio.vision.overlays.stage_marks import marks_of

POSE = look_at_pad(600.0, tilt_deg=15, heading_deg=35, tilt_towards_deg=80)
CAMERA = small_camera()
FRAME = frame_of(POSE, camera=CAMERA)


@pytest.fixture(scope="module", params=["dense", "paper"])
def trace(request):
    found = Detector(sample_pad(), CAMERA, method=request.param).detect(FRAME, trace=True)
    assert found.ok
    return found.trace


def test_every_pictured_stage_lies_in_the_frame(trace):
    pictured = set()
    for record in trace.records:
        raster = raster_of(trace, record.name, record.channel)
        if raster is None:
            continue
        pictured.add(record.name)
        left, top, right, bottom = raster.part
        assert left >= 0
        assert top >= 0
        assert right <= CAMERA.width + raster.pixel
        assert bottom <= CAMERA.height + raster.pixel
        image, part = raster.cut(None, 1.0)
        assert image.dtype == np.uint8
        assert part == raster.part
        json.dumps(marks_of(trace, record.name, record.channel, CAMERA).to_dict())
    assert {"stretch", "channel", "block_mean", "clean", "edges", "lines", "grid"} <= pictured


def test_a_channels_values_are_the_stretched_frames(trace):
    """The same place of the frame holds the same thing in each picture."""
    plane = raster_of(trace, "channel", "red")
    spot = (200.0, 150.0, 264.0, 214.0)
    near, _ = plane.cut(spot, 1 / plane.pixel)
    stretched, _ = raster_of(trace, "stretch", "red").cut(spot, 1.0)
    assert near.mean() == pytest.approx(stretched.mean(), abs=6)


def test_a_part_is_cut_to_whole_pixels_and_to_the_size_that_is_shown():
    raster = Raster(np.arange(64, dtype=np.uint8).reshape(8, 8), 16.0, 8.0, 4.0)
    image, part = raster.cut((21.0, 0.0, 30.0, 13.0), 1.0)
    assert part == (20.0, 8.0, 32.0, 16.0)
    assert image.tolist() == [[1, 2, 3], [9, 10, 11]]
    assert raster.cut(None, 1 / 8)[0].shape == (4, 4)
    assert raster.cut((100.0, 100.0, 120.0, 120.0), 1.0)[0].size == 0


def test_found_lines_lie_on_the_pads_own(request, trace):
    """Where a layer's grid was found, its lines pass through the lattice corners of the true pose.

    From here the fine layer's cells are 7 pixels wide: enough for the dense method alone.
    """
    failed = {run.channel for run in trace.records if run.name == "grid" and run.failure}
    read = [layer for layer in sample_pad().layers if layer.channel not in failed]
    least = {"dense": "red", "paper": "blue"}[request.node.callspec.params["trace"]]
    assert least in {layer.channel for layer in read}
    for layer in read:
        marks = marks_of(trace, "lines", layer.channel, CAMERA)
        found = [line for line in marks.lines if line.kind == "found"]
        assert len(found) > 10
        assert {line.family for line in found} == {0, 1}
        numbers = np.stack(np.meshgrid(np.arange(layer.cols + 1), np.arange(layer.rows + 1)), -1)
        corners = numbers.reshape(-1, 2).astype(float)
        true_xy = MovingPose(POSE).project(CAMERA, lattice_mm(sample_pad(), layer, corners))
        inside = (np.abs(true_xy - [CAMERA.width / 2, CAMERA.height / 2]) < 130).all(axis=1)
        strokes = [line.xy for line in found]
        on_a_line = [_distance(xy, strokes) < 2.0 for xy in true_xy[inside]]
        assert np.mean(on_a_line) > 0.9


def _distance(point, strokes):
    off = []
    for xy in strokes:
        a, b = xy[:-1], xy[1:]
        along = b - a
        t = np.clip(((point - a) * along).sum(1) / np.maximum((along**2).sum(1), 1e-9), 0, 1)
        off.append(np.linalg.norm(a + t[:, None] * along - point, axis=1).min())
    return min(off)


def test_dropped_lines_say_why_and_inserted_ones_that_they_are(trace):
    kinds = set()
    for name in ("lines", "grid"):
        for channel in ("red", "blue"):
            for line in marks_of(trace, name, channel, CAMERA).lines:
                kinds.add(line.kind)
                assert line.kind == "found" or line.text
    assert "found" in kinds


def test_cells_are_told_with_whether_they_differ(trace):
    marks = marks_of(trace, "decode", "blue", CAMERA)
    assert len(marks.cells) > 20
    assert sum(wrong for _, _, wrong in marks.cells) < 0.1 * len(marks.cells)
