"""What one change explains is found, by how much, and what does not hold is not."""

from dataclasses import replace

import numpy as np
import pytest
from pose_borders import CAMERA, POSE, measured

from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.reasons.distortions import CHANGES, explanations


@pytest.mark.parametrize(
    ("name", "amount"),
    [("focal", 0.2), ("focal", -0.3), ("lens", -0.2), ("aspect", 0.03), ("stretch", -0.02)],
)
def test_a_change_is_found_by_its_amount(name, amount):
    fits = explanations(measured(name, amount), CAMERA, POSE)
    best = max(CHANGES, key=lambda item: fits[item].gain)
    assert best == name
    assert fits[name].amount == pytest.approx(amount, abs=0.01 + 0.1 * abs(amount))
    assert fits[name].rms_px < 0.15 < fits["pose"].rms_px


def test_a_true_camera_leaves_nothing_to_explain():
    fits = explanations(measured(), CAMERA, POSE)
    assert max(fit.gain for fit in fits.values()) < 30


def test_from_straight_above_no_focal_length_is_told():
    above = MovingPose(look_at_pad(900.0, heading_deg=33.0))
    fits = explanations(measured(pose=above), CAMERA, above)
    assert fits["focal"].gain < 30


def test_wrong_borders_do_not_tell_of_a_camera():
    edge_points = measured()
    xy = edge_points.xy.copy()
    xy[::5] += np.random.default_rng(2).uniform(-8, 8, xy[::5].shape)
    fits = explanations(replace(edge_points, xy=xy), CAMERA, POSE)
    assert max(fit.gain for fit in fits.values()) < 80
