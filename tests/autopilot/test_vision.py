"""The vehicle over the pad, against 4 x 4 matrices and against steps of the pose."""

from __future__ import annotations

import math

import numpy as np
import pytest
from landing_truth import LandingTruth, transform, turn

from padstudio.autopilot.vehicle import Mount
from padstudio.autopilot.vision import body_over_pad, position_estimate_fields
from padstudio.geometry.pose import Pose

TRUTH = LandingTruth(30.0, 0.2, [0.12, -0.05, 0.08])
MOUNT = Mount(TRUTH.T_body_camera[:3, :3], TRUTH.T_body_camera[:3, 3])


def _fields(pose: Pose, covariance: np.ndarray | None = None) -> dict:
    return position_estimate_fields(pose, covariance, MOUNT, 45.0)


def _state(pose: Pose) -> np.ndarray:
    fields = _fields(pose)
    return np.array([fields[name] for name in ("x", "y", "z", "roll", "pitch", "yaw")])


def test_with_the_true_heading_of_the_page_axes_are_north_east_and_down() -> None:
    # The page's top is to the north-east; the pad's place is the origin.
    for time_s in (0.0, 0.7, 2.0):
        T = transform(np.eye(3), -TRUTH.T_local_pad[:3, 3]) @ TRUTH.T_local_body(time_s)
        position, rotation = body_over_pad(TRUTH.pose(time_s), MOUNT, 45.0)
        assert position == pytest.approx(T[:3, 3], abs=1e-9)
        assert rotation == pytest.approx(T[:3, :3], abs=1e-9)


def test_without_it_they_are_those_of_the_page() -> None:
    # A metre above the pad, up in the picture up the page: no roll, no pitch, no yaw.
    fields = position_estimate_fields(
        Pose(np.array([200.0, 300.0, 1000.0]), np.diag([1.0, -1, -1])), None, Mount(), 0.0
    )
    assert [fields[name] for name in ("x", "y", "z")] == pytest.approx([0.3, 0.2, -1.0])
    assert [fields[name] for name in ("roll", "pitch", "yaw")] == pytest.approx([0, 0, 0])
    assert math.isnan(fields["covariance"][0])


def test_the_covariance_is_that_of_what_is_sent() -> None:
    random = np.random.default_rng(3)
    pose = TRUTH.pose(1.1)
    root = random.normal(size=(6, 6)) * np.array([3, 3, 5, 0.01, 0.01, 0.02])[:, None]
    covariance = root @ root.T
    step = 1e-5
    J = np.empty((6, 6))
    for k in range(6):
        d = np.eye(6)[k] * step * (1000 if k < 3 else 1)
        ends = [
            _state(Pose(pose.position_mm + s * d[:3], pose.rotation @ turn(s * d[3:])))
            for s in (1, -1)
        ]
        J[:, k] = (ends[0] - ends[1]) / (2 * d[k])
    expected = J @ covariance @ J.T
    told = _fields(pose, covariance)["covariance"]
    assert len(told) == 21
    assert told == pytest.approx(expected[np.triu_indices(6)], rel=1e-4, abs=1e-12)
