"""Mountings found from attitudes, and what motion does not tell of them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from two_motions import TwoMotions, turn

from padstudio.autopilot.vehicle import Mount
from padstudio.flights.vehicle.mount import MountEstimate, estimate_mount

TIMES = np.arange(0, 20, 0.1)


def _found(motions: TwoMotions, seed: int = 0) -> MountEstimate:
    found = estimate_mount(motions.camera(TIMES, 0.3, seed), motions.body(TIMES))
    assert isinstance(found, MountEstimate), found
    return found


def test_mountings_lie_within_their_uncertainty() -> None:
    scores = []
    for seed in range(12):
        motions = TwoMotions(seed, mount=turn(np.random.default_rng(seed).normal(size=3)))
        found = _found(motions, seed)
        off = np.degrees(cv2.Rodrigues(found.rotation @ motions.mount.T)[0].ravel())
        scores.append(off / found.sigma_deg)
        assert found.residual_deg == pytest.approx(0.3 * np.sqrt(3), rel=0.15)
        assert len(found.undetermined) == 0
        assert found.attitudes(motions.body(TIMES)) == pytest.approx(
            motions.camera(TIMES), abs=0.02
        )
    # Of 36 normal deviates.
    assert 0.6 < np.sqrt(np.mean(np.square(scores))) < 1.5
    assert np.abs(scores).max() < 4.5


def test_wild_attitudes_do_not_mislead() -> None:
    motions = TwoMotions(4)
    ours = motions.camera(TIMES, 0.3)
    ours[::12] = ours[::12] @ turn([0, 0.06, 0])
    found = estimate_mount(ours, motions.body(TIMES))
    assert isinstance(found, MountEstimate)
    off = np.degrees(cv2.Rodrigues(found.rotation @ motions.mount.T)[0])
    assert np.abs(off).max() < 0.5


def test_turning_about_one_axis_leaves_that_axis_open() -> None:
    found = _found(TwoMotions(5, axes=(0.0, 0.0, 0.4)))
    assert np.abs(found.undetermined) == pytest.approx(np.array([[0.0, 0.0, 1.0]]), abs=0.02)
    assert found.sigma_deg[2] > 90
    assert found.sigma_deg[:2].max() < 5


def test_no_turning_tells_nothing() -> None:
    found = _found(TwoMotions(5, axes=(0.0, 0.0, 0.0)))
    assert len(found.undetermined) == 3
    assert found.sigma_deg.min() > 90


def test_what_no_mounting_explains_is_refused() -> None:
    told = estimate_mount(TwoMotions(6).camera(TIMES), TwoMotions(7).body(TIMES))
    assert isinstance(told, str)
    assert "gimbal" in told
    few = estimate_mount(TwoMotions(6).camera(TIMES[:10]), TwoMotions(6).body(TIMES[:10]))
    assert isinstance(few, str)


@pytest.mark.parametrize("turned_deg", [0.0, 90.0, -135.0])
def test_angles_are_those_of_exports(turned_deg: float) -> None:
    mount = Mount.downward(turned_deg, np.zeros(3)).rotation
    found = _found(TwoMotions(8, mount=mount))
    assert found.turned_deg == pytest.approx(turned_deg, abs=4 * found.sigma_deg[2])
    assert found.lean_deg == pytest.approx((0.0, 0.0), abs=0.5)
    leant = turn([0, np.radians(20), 0]) @ mount
    assert _found(TwoMotions(8, mount=leant)).lean_deg == pytest.approx((20.0, 0.0), abs=0.5)
