"""Fog by Koschmieder's law."""

import numpy as np
import pytest

from padstudio.color import linear_from_srgb
from padstudio.errors import SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.radiance.fog import Fog
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging

LINEAR = Imaging.ideal().with_changes(tone="linear")
CAMERA = Camera(160, 120, np.array([[150.0, 0, 79.5], [0, 150.0, 59.5], [0, 0, 1]]))
WHITE, BLACK = (255.0,) * 3, (0.0,) * 3


def scene(fog):
    """Large cells in ideal inks: white is 255 and black 0 without fog."""
    cells = np.indices((4, 4)).sum(0).astype(np.uint8) % 2
    pad = Pad((Layer("red", 8000.0, cells),), window=3)
    return Scene(pad=pad, inks=Inks.ideal(), ground="plain", fog=fog)


def contrast(height_mm, fog):
    image = render(scene(fog), CAMERA, look_at_pad(height_mm), LINEAR).image
    red = image[55:65, :, 2].astype(float)
    return red.max() - red.min()


def test_contrast_falls_with_the_exponential_of_the_distance():
    fog = Fog(visibility_m=20.0)
    for height_m in (2.0, 5.0, 10.0):
        clear = contrast(1000 * height_m, None)
        left = contrast(1000 * height_m, fog) / clear
        # Straight below; five hundredths are left at the visibility, by its definition.
        assert left == pytest.approx(0.05 ** (height_m / 20.0), abs=0.01)


def test_oblique_rays_go_a_longer_way_and_the_sky_is_fog():
    fog = Fog(visibility_m=8.0, airlight=WHITE)
    black = Scene(pad=None, ground="plain", fog=fog)
    image = render(black, CAMERA, look_at_pad(1500.0, tilt_deg=75.0), LINEAR).image
    bare = render(
        Scene(pad=None, ground="plain"), CAMERA, look_at_pad(1500.0, tilt_deg=75.0), LINEAR
    ).image
    rows = np.array([45, 70, 100])
    pose = look_at_pad(1500.0, tilt_deg=75.0)
    rays = np.stack([np.zeros(3), (rows - 59.5) / 150.0, np.ones(3)], axis=1) @ pose.rotation.T
    distance = 1500.0 * np.linalg.norm(rays, axis=1) / -rays[:, 2]
    through = np.exp(-np.log(20) * distance / 8000.0)
    expected = bare[rows, 80, 1] * through + 255 * (1 - through)
    assert np.abs(image[rows, 80, 1] - expected).max() < 1.5
    assert (image[0] == 255).all()


def test_what_is_out_of_range_is_refused():
    with pytest.raises(SpecError, match=r"0\.1 … 100000"):
        Fog(visibility_m=0.0)
    with pytest.raises(SpecError, match="airlight"):
        Fog(visibility_m=1.0, airlight=(1.0, 2.0, 300.0))


def test_airlight_is_the_fog_s_own_colour():
    fog = Fog(visibility_m=0.1, airlight=(200.0, 180.0, 160.0))
    image = render(scene(fog), CAMERA, look_at_pad(9000.0), LINEAR).image
    expected = 255 * linear_from_srgb(np.array([160.0, 180.0, 200.0]) / 255)
    assert np.abs(image.reshape(-1, 3) - expected).max() < 1
