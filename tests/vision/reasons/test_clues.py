"""What a second look measures, on pictures of which the figures are known."""

import cv2
import numpy as np
import pytest
from reason_causes import CAMERAS, PADS

from padstudio.vision.frame.diagnosis import examine
from padstudio.vision.reasons.clues import Clues, sharpness_of
from padstudio.vision.stage.params import PrepareParams
from padstudio.vision.stage.trace import Recorder

BLOCKS = np.kron(np.random.default_rng(1).integers(0, 2, (20, 20)), np.ones((16, 16))) * 200.0
BLOCKS = BLOCKS.astype(np.float32)
CAMERA = CAMERAS["vga"]


def clues(picture):
    pad, camera = PADS["small"], CAMERA
    return Clues(examine(picture, pad, camera, PrepareParams(), Recorder(keep=False)))


def on_grey(*boxes):
    """A grey picture with boxes of the pad's colours."""
    picture = np.full((480, 640, 3), 130, np.uint8)
    for x, y, width, height in boxes:
        picture[y : y + height, x : x + width] = (150, 30, 160)
    return picture


def test_steps_of_a_sharp_picture_are_narrow():
    assert sharpness_of(BLOCKS).most_px < 6


@pytest.mark.parametrize("angle", [0, 60, 135])
def test_motion_flattens_steps_along_it(angle):
    length = 25
    kernel = np.zeros((length, length), np.float32)
    end = length / 2 * np.array([np.cos(np.radians(angle)), -np.sin(np.radians(angle))])
    middle = np.full(2, length // 2)
    ends = [tuple(np.round(middle + sign * end).astype(int).tolist()) for sign in (-1, 1)]
    cv2.line(kernel, ends[0], ends[1], 1.0)
    found = sharpness_of(cv2.filter2D(BLOCKS, -1, kernel / kernel.sum()))
    assert found.most_px > 1.5 * found.least_px
    assert min(abs(found.direction_deg - angle), 180 - abs(found.direction_deg - angle)) <= 30


def test_defocus_flattens_steps_in_every_direction():
    found = sharpness_of(cv2.GaussianBlur(BLOCKS, (0, 0), 6))
    assert found.least_px > 10
    assert found.most_px < 1.3 * found.least_px


def test_one_whole_pad_fills_its_outline():
    parts = clues(on_grey((200, 150, 200, 160))).parts
    assert (parts.count, parts.sides) == (1, 0)
    assert parts.fill > 0.9
    assert parts.longest_px == pytest.approx(200, abs=8)
    assert parts.share == pytest.approx(200 * 160 / (640 * 480), rel=0.1)


def test_corners_that_peep_out_do_not():
    corners = [(x, y, 30, 30) for x in (150, 420) for y in (120, 330)]
    parts = clues(on_grey(*corners)).parts
    assert parts.count == 4
    assert parts.fill < 0.1


@pytest.mark.parametrize(("at", "sides"), [((0, 100), 1), ((0, 0), 2)])
def test_a_pad_at_the_rim_touches_it(at, sides):
    assert clues(on_grey((*at, 90, 90))).parts.sides == sides


def test_colors_are_those_of_the_pad_or_not():
    assert clues(on_grey((200, 150, 200, 160))).pad_is_seen
    assert not clues(on_grey()).pad_is_seen
    assert clues(on_grey()).color == 0
    green = on_grey()
    green[100:300, 100:300] = (60, 140, 60)
    assert not clues(green).pad_is_seen
