"""Borders between unlike cells, and where a picture shows them."""

import numpy as np
import pytest
from dense_frames import IDEAL, all_borders, borders_amid, frame_of, sample_pad, small_camera
from hypothesis import given
from hypothesis import strategies as st

from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.pose.edge_points import find_edge_points, visible_borders


@given(seed=st.integers(0, 10**6), levels=st.integers(2, 4))
def test_every_step_of_the_field_is_a_border_where_it_lies(seed, levels):
    rng = np.random.default_rng(seed)
    field = rng.integers(0, levels, (6, 7))
    pad = Pad((Layer("red", 10.0, field),), 2, levels, scale=(1.02, 0.97))
    borders = all_borders(pad, pad.layers[0])
    steps = (np.diff(field, axis=0) != 0).sum() + (np.diff(field, axis=1) != 0).sum()
    assert len(borders.step) == steps
    for side, sign in ((0.5, 1), (-0.5, -1)):
        at = borders.points_mm + side * borders.across_mm
        col = np.floor((at[:, 0] + 35 * 1.02) / (10 * 1.02)).astype(int)
        row = np.floor((30 * 0.97 - at[:, 1]) / (10 * 0.97)).astype(int)
        level = field[row, col] / (levels - 1)
        if sign > 0:
            after = level
    np.testing.assert_allclose(borders.step, after - level)
    np.testing.assert_allclose((borders.across_mm * borders.along_mm).sum(axis=1), 0)


def test_borders_in_view_are_those_whose_picture_is_in_the_frame():
    pad, camera = sample_pad(), small_camera()
    pose = MovingPose(look_at_pad(350.0, tilt_deg=25, heading_deg=40, target_mm=(150, -90)))
    every = all_borders(pad, pad.layers[0]).points_mm
    pixels = pose.project(camera, every)
    shown = (pixels > 1).all(axis=1) & (pixels < [camera.width - 2, camera.height - 2]).all(axis=1)
    found = visible_borders(pad, pad.layers[0], camera, pose, 10**6).points_mm
    assert 100 < len(found) < len(every) / 2
    assert {tuple(p) for p in found.round(6)} == {tuple(p) for p in every[shown].round(6)}
    few = visible_borders(pad, pad.layers[0], camera, pose, 300).points_mm
    assert 150 <= len(few) <= 300
    assert {tuple(p) for p in few.round(6)} < {tuple(p) for p in found.round(6)}
    np.testing.assert_allclose(few.mean(axis=0), found.mean(axis=0), atol=40)


def measured_in(imaging, pose, reach_px=6.0):
    pad, camera = sample_pad(), small_camera()
    borders = borders_amid(pad, pad.layers[1], 7.5)
    pyramid = Pyramid(frame_of(pose, camera=camera, imaging=imaging))
    window = pyramid.window("blue", 0)
    return borders, find_edge_points(borders, window, camera, MovingPose(pose), reach_px)


def test_borders_are_measured_where_they_are():
    pose = look_at_pad(900.0, tilt_deg=20, heading_deg=25)
    _, found = measured_in(IDEAL, pose)
    assert len(found.xy) > 100
    true = MovingPose(pose).project(small_camera(), found.borders.points_mm)
    off = np.linalg.norm(found.xy - true, axis=1)
    assert np.median(off[found.weight > 0.5]) < 0.25
    assert ((found.weight > 0.05) & (found.weight <= 1)).all()


def test_borders_out_of_view_are_left_out():
    pose = look_at_pad(250.0, heading_deg=25)
    borders, found = measured_in(None, pose)
    assert 0 < len(found.xy) < len(borders.step) / 2
    assert (found.xy > 0).all()
    assert (found.xy < [640, 480]).all()


@pytest.mark.parametrize("most", [1, 7, 50, 10_000])
def test_thinning_keeps_them_spread(most):
    pad = sample_pad()
    borders = all_borders(pad, pad.layers[1])
    thin = borders.thinned(most)
    assert 0 < len(thin.step) <= max(most, 1) or len(borders.step) <= most
    _, found = measured_in(None, look_at_pad(900.0))
    assert len(found.thinned(most).xy) <= max(most, 1) or len(found.xy) <= most
