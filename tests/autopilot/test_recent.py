"""Where the vehicle was, from samples of a motion that is known."""

from __future__ import annotations

import numpy as np
import pytest
from landing_truth import LandingTruth

from padstudio.autopilot.recent import RecentTrack
from padstudio.geometry.pose import Pose


def _quaternion(rotation: np.ndarray) -> np.ndarray:
    x, y, z, w = Pose(np.zeros(3), rotation).quaternion_xyzw
    return np.array([w, x, y, z])


def _track(first_s: float, last_s: float) -> tuple[RecentTrack, LandingTruth]:
    track, truth = RecentTrack(), LandingTruth()
    for k, time_s in enumerate(np.arange(first_s, last_s + 1e-9, 0.02)):
        T = truth.T_local_body(time_s)
        # Either sign is the same attitude.
        track.attitude(time_s, _quaternion(T[:3, :3]) * (-1) ** k)
        if k % 2 == 0:
            track.position(time_s, T[:3, 3])
    return track, truth


def test_between_samples_it_follows_the_motion() -> None:
    track, truth = _track(0.0, 2.0)
    for time_s in np.random.default_rng(1).uniform(0, 2.0, 50):
        found = track.at(time_s)
        assert isinstance(found, tuple)
        T = truth.T_local_body(time_s)
        assert found[0] == pytest.approx(T[:3, 3], abs=1e-3)
        assert found[1] == pytest.approx(T[:3, :3], abs=1e-4)


def test_what_is_not_known_is_not_made_up() -> None:
    track, _ = _track(1.0, 2.0)
    assert RecentTrack().at(1.0) == "never"
    assert track.at(0.9) == "never"
    assert track.at(2.1) == "not_yet"
    assert track.at(2.6) == "never"
    # Over a gap of more than half a second nothing is known.
    track.position(2.8, np.zeros(3))
    track.attitude(2.8, np.array([1.0, 0, 0, 0]))
    assert track.at(2.4) == "never"
    # Positions alone do not do.
    alone = RecentTrack()
    alone.position(1.0, np.zeros(3))
    alone.position(1.1, np.zeros(3))
    assert alone.at(1.05) == "never"


def test_samples_in_the_wrong_order_or_without_sense_are_left_out() -> None:
    track, truth = _track(1.0, 2.0)
    track.position(1.5, np.full(3, 99.0))
    track.position(2.02, np.array([np.nan, 0, 0]))
    track.attitude(2.02, np.zeros(4))
    found = track.at(1.51)
    assert isinstance(found, tuple)
    assert found[0] == pytest.approx(truth.T_local_body(1.51)[:3, 3], abs=1e-3)
    assert track.newest_s == pytest.approx((2.0, 2.0))


def test_an_autopilot_that_begins_anew_begins_a_new_track() -> None:
    track, _ = _track(100.0, 101.0)
    for time_s in (2.0, 2.1):
        track.position(time_s, np.full(3, time_s))
        track.attitude(time_s, np.array([1.0, 0, 0, 0]))
    found = track.at(2.05)
    assert isinstance(found, tuple)
    assert found[0] == pytest.approx([2.05] * 3)
    assert track.at(100.5) == "never"
