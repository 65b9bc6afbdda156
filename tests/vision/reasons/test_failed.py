"""The rules: what is certain stays first, and what blinds ends the questions."""

from dataclasses import dataclass, field

import pytest
from reason_causes import PADS

from padstudio import Pad
from padstudio.vision.reasons.clues import Parts, Reading, Sharpness
from padstudio.vision.reasons.failed import in_full
from padstudio.vision.stage.trace import Reason, StageFailure

FAILURE = StageFailure("decode", Reason.UNKNOWN_CODE, "read 90 cells", "as before")
SHARP = Sharpness(4.0, 5.0, 0, 200.0)
WHOLE = Parts(1, 0.3, 0.95, 0, 400.0, 0.11, 0.2)


@dataclass
class Bright:
    bright: float = 0.0


@dataclass
class Size:
    width: int = 800
    height: int = 600


@dataclass
class Frame:
    pad: Pad = PADS["small"]
    pyramid: Size = field(default_factory=Size)


@dataclass
class Figures:
    """A stand-in for `Clues` of which each figure is given."""

    top: float = 200.0
    relief: float = 20.0
    color: float = 30.0
    likeness: float = 0.2
    burnt: float = 0.0
    parts: Parts | None = WHOLE
    pad_is_seen: bool = True
    sharpness: Sharpness = SHARP
    readings: tuple[Reading, ...] = ()

    @property
    def frame(self):
        """What sizes are measured on."""
        return Frame()

    @property
    def light(self):
        """What light is measured on."""
        return Bright(self.burnt)


@pytest.mark.parametrize(
    ("figures", "first", "also"),
    [
        ({"top": 10, "relief": 0.1}, "black_frame", []),
        ({"top": 20}, "underexposed", []),
        ({"burnt": 0.9}, "overexposed", []),
        ({"burnt": 0.3, "sharpness": Sharpness(12.0, 13.0, 0, 200)}, "overexposed", ["defocus"]),
        ({"color": 0.1, "sharpness": Sharpness(4.0, 15.0, 0, 200)}, "monochrome", ["motion_blur"]),
        ({"parts": Parts(9, 0.1, 0.2, 0, 400.0, 0.1, 0.2)}, "covered", []),
        ({"parts": Parts(1, 0.03, 0.9, 2, 90.0, 0.1, 0.2)}, "cut_off", []),
        ({"likeness": 0.9}, "crosstalk", []),
        ({"readings": (Reading(0.99, 9000.0, 300, 0.2, 0.0),)}, "another_pad", []),
        ({"readings": (Reading(0.99, 900.0, 9, 0.2, 0.0),)}, "cells_too_large", []),
        ({"readings": (Reading(0.95, 9000.0, 900, 0.3, -30.0),)}, "covered", []),
    ],
)
def test_each_figure_has_its_reason(figures, first, also):
    found = in_full(Figures(**figures), FAILURE)
    assert [str(found.reason), *(str(item.reason) for item in found.also)] == [first, *also]
    assert found.stage == FAILURE.stage
    assert found.detail.endswith("read 90 cells")


def test_a_failure_that_nothing_explains_stays():
    assert in_full(Figures(), FAILURE) is FAILURE


def test_a_misreading_is_certain():
    mirrored = StageFailure("decode", Reason.MIRRORED, "mirror image", "flip it")
    found = in_full(Figures(burnt=0.3, likeness=0.9), mirrored)
    assert found.reason is Reason.MIRRORED
    assert [item.reason for item in found.also] == [Reason.OVEREXPOSED]
