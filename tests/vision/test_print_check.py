"""What the print check measures is what the simulator printed and how it was photographed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from paper_frames import sample_pad

from padstudio import Camera, Detector
from padstudio.color import linear_from_srgb
from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.scene import Light, Scene, Shadow
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Glare, Imaging
from padstudio.vision.print_check import check_print

WIDTH, HEIGHT, FOCAL = 800, 600, 685.0
NEAR = look_at_pad(520.0, tilt_deg=12, heading_deg=20, tilt_towards_deg=60)
PLAIN = replace(Imaging.ideal(), blur_px=0.6)


def camera(**values):
    matrix = np.array([[FOCAL, 0, (WIDTH - 1) / 2], [0, FOCAL, (HEIGHT - 1) / 2], [0, 0, 1]])
    return Camera(WIDTH, HEIGHT, matrix, np.zeros(4), **values)


@cache
def detector():
    return Detector(sample_pad(), camera())


def items_of(image, by=None):
    return {item.code: item for item in check_print(image, by or detector())}


def checked(*, pose=NEAR, imaging=PLAIN, by=None, pad=None, **scene):
    seen = Scene(pad=pad or sample_pad(), **scene)
    return items_of(render(seen, camera(), pose, imaging).image, by)


def printed(inks):
    """Light of black, red, blue and magenta in the red and in the blue channel, (2, 4)."""
    colors = np.array([inks.black, inks.red, inks.blue, inks.magenta])
    return linear_from_srgb(colors[:, [0, 2]].T / 255)


def crosstalk(light, own):
    """What the other layer adds, of what a layer itself adds."""
    other = BLUE if own is RED else RED
    terms = np.column_stack([np.ones(4), own, other])
    (_, gain, added), *_ = np.linalg.lstsq(terms, light, rcond=None)
    return added / gain


RED, BLUE = np.array([0, 1, 0, 1]), np.array([0, 0, 1, 1])
MIXED = replace(Inks(), blue=(150.0, 80.0, 161.0), magenta=(200.0, 81.0, 158.0))


FADED = replace(
    Inks(),
    black=(120.0, 110.0, 112.0),
    blue=(122.0, 116.0, 165.0),
    red=(150.0, 95.0, 95.0),
    magenta=(152.0, 100.0, 160.0),
)


@pytest.mark.parametrize("inks", [Inks.ideal(), Inks(), Inks().faded(0.6), MIXED])
def test_contrast_and_crosstalk_are_those_of_the_inks(inks):
    found = checked(inks=inks)
    for channel, light, own in zip(("red", "blue"), printed(inks), (RED, BLUE), strict=True):
        full, dark = light[own == 1].mean(), light[own == 0].mean()
        assert found[f"contrast_{channel}"].figure == pytest.approx(1 - dark / full, abs=0.06)
        assert found[f"crosstalk_{channel}"].figure == pytest.approx(
            crosstalk(light, own), abs=0.08
        )


def test_a_good_print_in_good_light_is_good():
    found = checked(inks=Inks.ideal())
    assert {item.verdict for item in found.values()} == {"good"}
    assert not any(item.advice for code, item in found.items() if code != "scale")


def test_what_is_wrong_is_told_with_what_to_do():
    faded, mixed = checked(inks=FADED), checked(inks=MIXED)
    assert faded["contrast_red"].verdict != "good"
    assert "print" in faded["contrast_red"].advice
    assert mixed["crosstalk_red"].verdict != "good"
    assert "test strip" in mixed["crosstalk_red"].advice


@pytest.mark.parametrize("blur_px", [0.6, 1.5, 2.5])
def test_borders_are_as_wide_as_the_blur_makes_them(blur_px):
    found = checked(imaging=replace(PLAIN, blur_px=blur_px), inks=Inks.ideal())
    # A blur of s makes a step sqrt(2 pi) s wide, as contrast over slope; measuring adds about 1 px.
    width = np.sqrt(2 * np.pi * (blur_px**2 + 1.0))
    assert found["sharpness"].figure == pytest.approx(width, rel=0.3)


def test_a_picture_out_of_focus_is_told():
    found = checked(imaging=replace(PLAIN, blur_px=3.2), inks=Inks.ideal())
    assert found["sharpness"].verdict != "good"
    assert "focus" in found["sharpness"].advice


def test_a_shadow_and_glare_are_told():
    shadow = Shadow(x_mm=0, y_mm=0, toward_deg=90, density=0.9)
    assert checked(light=Light(shadows=(shadow,)), inks=Inks.ideal())["light"].verdict == "bad"
    glare = replace(PLAIN, glare=Glare(x=0.5, y=0.5, radius=0.25, strength=3.0))
    assert checked(imaging=glare, inks=Inks.ideal())["glare"].verdict != "good"


def test_small_cells_are_told_with_how_near_to_come():
    near = checked(inks=Inks.ideal())["cell_size"]
    assert near.figure == pytest.approx(10 * FOCAL / 520, rel=0.1)
    far = checked(pose=look_at_pad(2600.0, tilt_deg=5), inks=Inks.ideal())["cell_size"]
    assert far.verdict == "fair"
    assert far.figure == pytest.approx(10 * FOCAL / 2600, rel=0.1)
    assert "come nearer than 2.1 m" in far.advice


def test_a_print_out_of_proportion_is_told_and_that_its_size_is_not_known():
    pose = look_at_pad(900.0, tilt_deg=30, heading_deg=20, tilt_towards_deg=60)
    stretched = replace(sample_pad(), scale=(1.03, 1.0))
    found = checked(pose=pose, pad=stretched, inks=Inks.ideal())["scale"]
    assert found.verdict == "bad"
    assert "ruler" in found.advice
    nominal = Detector(sample_pad(), camera(nominal=True))
    assert checked(by=nominal, inks=Inks.ideal())["scale"].verdict == "unknown"


def test_where_nothing_is_read_nothing_is_said():
    assert check_print(np.full((HEIGHT, WIDTH, 3), 90, np.uint8), detector()) == []
