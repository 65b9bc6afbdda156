"""Verdicts and what they add up to."""

from __future__ import annotations

import math

import numpy as np
import pytest

from padstudio.experiments.shootout.scores import Outcome, judge, summarise
from padstudio.geometry.pose import Pose, look_at_pad

TRUTH = look_at_pad(1000.0)


def _off(x_mm: float, tilt_deg: float = 0.0) -> Pose:
    angle = math.radians(tilt_deg)
    turn = np.array(
        [[1, 0, 0], [0, math.cos(angle), -math.sin(angle)], [0, math.sin(angle), math.cos(angle)]]
    )
    return Pose(TRUTH.position_mm + [x_mm, 0, 0], turn @ TRUTH.rotation)


@pytest.mark.parametrize(
    ("found", "verdict"),
    [
        (_off(29.9), "read"),
        (_off(30.1), "false"),
        (_off(0, 2.9), "read"),
        (_off(0, 3.1), "false"),
        (None, "missed"),
    ],
)
def test_a_pose_is_read_within_three_percent_and_three_degrees(
    found: Pose | None, verdict: str
) -> None:
    assert judge(found, (TRUTH,), 1000.0)[0] == verdict


def test_the_nearest_truth_counts_and_without_one_every_pose_is_false() -> None:
    verdict, percent, angle = judge(_off(500.0), (TRUTH, _off(505.0)), 1000.0)
    assert (verdict, angle) == ("read", pytest.approx(0, abs=1e-6))
    assert percent == pytest.approx(0.5)
    assert judge(TRUTH, (), 1000.0)[0] == "false"


def test_a_summary_counts_and_spans_what_was_read_alone() -> None:
    outcomes = [
        Outcome(8000.0, 1.0, "false", 50.0, 9.0),
        Outcome(4000.0, 2.0, "read", 0.3, 0.1),
        Outcome(1000.0, 3.0, "read", 0.1, 0.2),
        Outcome(100.0, 4.0, "missed"),
    ]
    found = summarise(outcomes, by_tilt=False)
    assert (found.read, found.false, found.missed) == (2, 1, 1)
    assert (found.lowest, found.highest, found.ratio) == (1000.0, 4000.0, 4.0)
    assert found.median_percent == pytest.approx(0.2)
    tilts = summarise(outcomes, by_tilt=True)
    assert (tilts.lowest, tilts.highest, tilts.ratio) == (2.0, 3.0, None)
    nothing = summarise(outcomes[3:], by_tilt=False)
    assert (nothing.read, nothing.median_percent, nothing.ratio) == (0, None, None)
