"""Leaves, snow and mud: their share, their place, their colours."""

from dataclasses import replace

import numpy as np
import pytest

from padstudio.errors import SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.litter import LITTER_KINDS, Litter, strewn
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging

IDEAL = Imaging.ideal()
# The frame is the pad: 800 x 600 mm from a height of 1 m.
CAMERA = Camera(400, 300, np.array([[500.0, 0, 199.5], [0, 500.0, 149.5], [0, 0, 1]]))
PAD = Pad((Layer("green", 200.0, np.zeros((3, 4), np.uint8)),), window=3)
BARE = Scene(pad=PAD, inks=Inks.ideal(), ground="plain", quiet_mm=0.0)


def covered(litter, height_mm=1000.0):
    """Share of the frame that is not the pad's black."""
    image = render(replace(BARE, litter=litter), CAMERA, look_at_pad(height_mm), IDEAL).image
    return (image.max(axis=2) > 12).mean(), image


@pytest.mark.parametrize("kind", LITTER_KINDS)
@pytest.mark.parametrize("share", [0.1, 0.4, 0.8])
def test_litter_covers_the_share_that_is_asked_for(kind, share):
    found, _ = covered(Litter(kind=kind, share=share, seed=3))
    assert found == pytest.approx(share, abs=0.04)


def test_leaves_have_the_area_of_their_outline():
    litter = Litter(share=0.02, size_mm=80.0, seed=1)
    shapes = strewn(litter, (800.0, 600.0)).shapes
    # Between two parabolas: 8/3 of half length times half breadth.
    areas = 8 / 3 * shapes[:, 5] * shapes[:, 6]
    place = np.array([float(shapes[0, 1]), float(shapes[0, 2])])
    one = replace(BARE, litter=litter)
    pose = look_at_pad(250.0, target_mm=(place[0], place[1]))
    image = render(one, CAMERA, pose, IDEAL).image
    others = np.hypot(*(shapes[1:, 1:3] - place).T) < 130
    if not others.any():
        seen = (image.max(axis=2) > 12).sum() * (250.0 / 500.0) ** 2
        assert seen == pytest.approx(areas[0], rel=0.02)
    assert len(shapes) >= 2


def test_the_same_seed_strews_the_same():
    first, second = (covered(Litter(share=0.3, seed=5))[1] for _ in range(2))
    assert np.array_equal(first, second)
    assert not np.array_equal(first, covered(Litter(share=0.3, seed=6))[1])


def test_edges_are_averaged_over_a_pixel():
    """From afar the mean colour is that of the near picture."""
    litter = Litter(kind="snow", share=0.3, seed=2)
    linear = IDEAL.with_changes(tone="linear")
    near = render(replace(BARE, litter=litter), CAMERA, look_at_pad(1000.0), linear).image
    small = Camera(40, 30, np.array([[50.0, 0, 19.5], [0, 50.0, 14.5], [0, 0, 1]]))
    far = render(replace(BARE, litter=litter), small, look_at_pad(1000.0), linear).image
    blocks = near.reshape(30, 10, 40, 10, 3).mean(axis=(1, 3))
    assert np.sqrt(((far - blocks) ** 2).mean()) < 4.0
    assert abs((far - blocks).mean()) < 0.5


def test_what_is_out_of_range_is_refused():
    with pytest.raises(SpecError, match="choose one of leaves, snow, mud"):
        Litter(kind="rain")
    with pytest.raises(SpecError, match=r"0 … 0\.95"):
        Litter(share=1.0)
    with pytest.raises(SpecError, match="size_mm"):
        Litter(size_mm=0.0)
