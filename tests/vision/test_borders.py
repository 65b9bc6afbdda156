"""Borders between unlike cells, and where a picture shows them."""

import numpy as np
import pytest
from dense_frames import IDEAL, frame_of, sample_pad, small_camera
from hypothesis import given
from hypothesis import strategies as st

from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.borders import concatenate, layer_borders, measure
from padstudio.vision.motion import MovingPose
from padstudio.vision.planes import Pyramid


@given(seed=st.integers(0, 10**6), levels=st.integers(2, 4))
def test_every_step_of_the_field_is_a_border_where_it_lies(seed, levels):
    rng = np.random.default_rng(seed)
    field = rng.integers(0, levels, (6, 7))
    pad = Pad((Layer("red", 10.0, field),), 2, levels, scale=(1.02, 0.97))
    borders = layer_borders(pad, pad.layers[0], (0, 6), (0, 7))
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


def test_a_part_of_a_layer_has_the_borders_within_it():
    pad = sample_pad()
    part = layer_borders(pad, pad.layers[1], (3, 9), (5, 12))
    whole = layer_borders(pad, pad.layers[1], (0, 25), (0, 25))
    known = {tuple(point) for point in whole.points_mm.round(6)}
    assert {tuple(point) for point in part.points_mm.round(6)} < known


def measured_in(imaging, pose, reach_px=6.0):
    pad, camera = sample_pad(), small_camera()
    borders = layer_borders(pad, pad.layers[1], (5, 20), (5, 20))
    pyramid = Pyramid(frame_of(pose, camera=camera, imaging=imaging))
    plane = pyramid.plane("blue", 0)
    return borders, measure(borders, plane, camera, MovingPose(pose), reach_px)


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
    borders = layer_borders(pad, pad.layers[1], (0, 25), (0, 25))
    thin = borders.thinned(most)
    assert 0 < len(thin.step) <= max(most, 1) or len(borders.step) <= most
    _, found = measured_in(None, look_at_pad(900.0))
    assert len(found.thinned(most).xy) <= max(most, 1) or len(found.xy) <= most


def test_layers_measured_together_are_all_there():
    _, found = measured_in(None, look_at_pad(900.0))
    both = concatenate([found, found.thinned(20)])
    assert len(both.xy) == len(both.borders.step) == len(found.xy) + len(found.thinned(20).xy)
    assert concatenate([found]) is found
