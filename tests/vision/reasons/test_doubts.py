"""What is said of a pose: only what is large enough to care for, one number before many."""

from dataclasses import dataclass

import pytest
from pose_borders import POSE, measured
from reason_causes import CAMERAS

from padstudio.vision.reasons.doubts import Seen, doubts_of
from padstudio.vision.stage.detection import Detection


@dataclass
class Figures:
    color: float = 30.0
    likeness: float = 0.2


def said(change=None, amount=0.0, *, flatness_mm=None, **figures):
    detection = Detection(POSE.pose, flatness_mm=flatness_mm)
    seen = Seen(detection, CAMERAS["vga"], measured(change, amount))
    return [str(item.reason) for item in doubts_of(seen, Figures(**figures))]


@pytest.mark.parametrize(
    ("change", "amount", "reason"),
    [
        ("focal", 0.1, "wrong_camera"),
        ("lens", -0.15, "wrong_camera"),
        ("stretch", 0.02, "print_scale"),
    ],
)
def test_what_explains_the_borders_comes_first(change, amount, reason):
    assert said(change, amount)[0] == reason
    assert said(change, amount, flatness_mm=20.0)[0] == reason


def test_bent_paper_is_named_where_one_number_explains_nothing():
    assert said(flatness_mm=20.0) == ["warped"]


def test_a_good_frame_has_no_doubt():
    assert said() == []


def test_small_stretches_pass_for_motion():
    assert said("stretch", 0.006) == []


def test_colors_are_doubted_by_their_figures():
    assert said(color=0.1, likeness=1.0) == ["monochrome"]
    assert said(likeness=0.9) == ["crosstalk"]
