"""What the printer makes of nominal colours."""

import numpy as np
import pytest

from padstudio.color import linear_from_srgb, srgb_from_linear
from padstudio.errors import SpecError
from padstudio.simulate.radiance.inks import Inks


def test_srgb_goes_there_and_back():
    values = np.linspace(0, 1, 256)
    assert np.allclose(srgb_from_linear(linear_from_srgb(values)), values, atol=1e-12)
    assert linear_from_srgb(np.array([0.5]))[0] == pytest.approx(0.21404, abs=1e-5)


def test_full_colours_are_the_inks_and_screens_mix_light():
    inks = Inks()
    corners = np.array(
        [[0, 0, 0], [255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 0, 255], [255, 255, 255]], np.uint8
    )
    names = ("black", "red", "green", "blue", "magenta", "white")
    for color, name in zip(inks.reflectance(corners), names, strict=True):
        assert np.allclose(srgb_from_linear(color) * 255, getattr(inks, name), atol=1e-3)
    black, red, screen = inks.reflectance(np.array([[0, 0, 0], [255, 0, 0], [51, 0, 0]], np.uint8))
    assert np.allclose(screen, 0.8 * black + 0.2 * red, atol=1e-6)


def test_ideal_inks_are_the_nominal_colours():
    colors = np.array([[255, 0, 255], [0, 255, 0], [255, 255, 0]], np.uint8)
    assert np.array_equal(Inks.ideal().reflectance(colors), colors / np.float32(255))


def test_refuses_an_ink_out_of_range():
    with pytest.raises(SpecError, match="0 … 255"):
        Inks(red=(300.0, 0.0, 0.0))
