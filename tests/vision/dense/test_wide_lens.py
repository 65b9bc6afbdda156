"""Lenses that see to the side and backwards: what has no ray is left out, the rest is read."""

import numpy as np
import pytest
from dense_frames import errors, random_pad
from wide_view import wide_camera, wide_view

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.detector import Detector
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import find_regions
from padstudio.vision.search.edges import find_edges
from padstudio.vision.stage.params import SearchParams

PAD = random_pad(4, cells=(100, 25), cell_mm=(10.0, 40.0))
VIEWS = (160.0, 180.0, 200.0)


def pose_of(height_mm, seed=0):
    rng = np.random.default_rng([int(height_mm), seed])
    return look_at_pad(
        height_mm,
        tilt_deg=rng.uniform(3, 25),
        heading_deg=rng.uniform(0, 360),
        tilt_towards_deg=rng.uniform(0, 360),
        target_mm=tuple(rng.uniform(-60, 60, 2)),
    )


@pytest.mark.parametrize("view_deg", VIEWS)
@pytest.mark.parametrize("height_mm", [100.0, 300.0, 800.0])
def test_a_pad_under_a_fisheye_is_read(view_deg, height_mm):
    camera, pose = wide_camera(view_deg), pose_of(height_mm)
    found = Detector(PAD, camera).detect(wide_view(PAD, camera, pose, view_deg))
    assert found.ok, found.failure
    position, attitude = errors(found.pose, pose)
    assert position < 0.5
    assert attitude < 0.3


@pytest.mark.parametrize("view_deg", VIEWS)
def test_edges_are_measured_only_where_the_lens_has_rays(view_deg):
    camera = wide_camera(view_deg)
    frame = wide_view(PAD, camera, pose_of(150.0), view_deg)
    plane = Pyramid(frame).plane("red", 0)
    edges = find_edges(plane, camera, SearchParams())
    assert len(edges.xy) > 1000
    for values in (edges.rays, edges.lines):
        assert np.isfinite(values).all()
    assert np.hypot(edges.rays[:, 0], edges.rays[:, 1]).max() < np.tan(np.radians(85.1))


def test_the_black_beside_a_fisheyes_picture_is_no_region():
    camera, pose = wide_camera(180.0), pose_of(800.0)
    first = find_regions(Pyramid(wide_view(PAD, camera, pose, 180.0)), PAD)[0]
    assert first.mask is not None
    corners = np.array([[5.0, 5.0], [795.0, 5.0], [5.0, 595.0], [795.0, 595.0]])
    assert not first.holds(corners).any()
    middle = camera.project((-pose.position_mm @ pose.rotation)[None])
    assert first.holds(middle).all()
