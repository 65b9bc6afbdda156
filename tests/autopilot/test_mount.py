"""Mounts against turns that are put together step by step."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.autopilot.vehicle import Mount
from padstudio.errors import SpecError
from padstudio.flights.vehicle.mount import MountEstimate

ZERO = np.zeros(3)
ANGLES = st.floats(-179.0, 179.0)
LEANS = st.floats(-80.0, 80.0)


@given(ANGLES)
def test_without_a_lean_it_looks_straight_down(turned_deg: float) -> None:
    leaning = Mount.leaning(turned_deg, (0.0, 0.0), ZERO)
    assert leaning.rotation == pytest.approx(Mount.downward(turned_deg, ZERO).rotation, abs=1e-12)


@given(ANGLES, LEANS, LEANS)
def test_angles_are_those_that_a_log_is_asked_for(
    turned_deg: float, forward_deg: float, right_deg: float
) -> None:
    mount = Mount.leaning(turned_deg, (forward_deg, right_deg), ZERO)
    found = MountEstimate(mount.rotation, np.eye(3), ZERO, 0.0, np.empty((0, 3)))
    assert found.turned_deg == pytest.approx(turned_deg, abs=1e-6)
    assert found.lean_deg == pytest.approx((forward_deg, right_deg), abs=1e-6)


def test_a_camera_that_leans_forward_sees_ahead() -> None:
    mount = Mount.leaning(0.0, (30.0, 0.0), np.array([0.1, 0.0, 0.0]))
    s, c = math.sin(math.radians(30)), math.cos(math.radians(30))
    # Along the optical axis; up in the picture; right in the picture.
    assert mount.rotation @ [0, 0, 1] == pytest.approx([s, 0, c])
    assert mount.rotation @ [0, -1, 0] == pytest.approx([c, 0, -s])
    assert mount.rotation @ [1, 0, 0] == pytest.approx([0, 1, 0])


def test_a_camera_that_looks_level_is_refused() -> None:
    with pytest.raises(SpecError, match="less than 90"):
        Mount.leaning(0.0, (90.0, 0.0), ZERO)
