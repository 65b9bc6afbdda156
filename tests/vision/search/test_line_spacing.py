"""Which edges lie on grid lines, and the lines' spacing."""

import numpy as np
import pytest
from dense_frames import edges_of, frame_of, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.search.line_spacing import find_lines
from padstudio.vision.search.plane_normals import find_axes


@pytest.mark.parametrize(("channel", "cell_mm", "level"), [("red", 10.0, 0), ("blue", 50.0, 1)])
def test_the_spacing_is_the_cells(channel, cell_mm, level):
    height_mm = 300.0 if channel == "red" else 900.0
    pose = look_at_pad(height_mm, tilt_deg=15, heading_deg=70, tilt_towards_deg=20)
    edges = edges_of(frame_of(pose, camera=small_camera()), channel, level)
    score, axes = find_axes(edges, steep=False)[0]
    lines = find_lines(edges, score, axes)
    assert lines is not None
    # For a plane at distance 1 along the normal; the camera's distance is its height.
    assert lines.pitch == pytest.approx(cell_mm / height_mm, rel=0.02)
    assert lines.contrast > 1
    both = lines.on_u | lines.on_v
    assert not (lines.on_u & lines.on_v).any()
    assert both.mean() > 0.7


def test_too_few_edges_give_no_spacing():
    edges = edges_of(frame_of(look_at_pad(600.0), camera=small_camera()))
    few = edges.take(np.arange(len(edges.xy)) < 9)
    assert find_lines(few, 1.0, np.eye(3)) is None
