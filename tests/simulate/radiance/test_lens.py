"""Viewing rays and lens limits."""

import numpy as np
import pytest

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.radiance import integrate as radiance_module
from padstudio.simulate.radiance.lens import field_of_view_deg, ray_map
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render


def camera(distortion=(), model="radtan", width=333, height=207, focal=240.0):
    matrix = np.array([[focal, 0, 150.2], [0, focal * 1.01, 99.7], [0, 0, 1]])
    return Camera(width, height, matrix, np.array(distortion), model)


LENSES = {
    "plain": camera(),
    "barrel": camera((-0.28, 0.09, 0.0006, -0.0004, -0.01)),
    "fisheye": camera((0.03, -0.01, 0.002, 0.0), "fisheye"),
    "tiny": camera(width=17, height=5),
}


@pytest.mark.parametrize("name", sorted(LENSES))
def test_rays_project_back_onto_their_pixels(name):
    lens = LENSES[name]
    rays = ray_map(lens)
    assert rays.shape == (lens.height + 2, lens.width + 2, 2)
    pixels = lens.denormalize(rays.reshape(-1, 2).astype(float)).reshape(rays.shape)
    rows, cols = np.mgrid[-1 : lens.height + 1, -1 : lens.width + 1]
    assert np.abs(pixels - np.stack([cols, rows], -1)).max() < 5e-4


def test_field_of_view_is_twice_the_widest_angle():
    square = Camera(200, 200, np.array([[100.0, 0, 99.5], [0, 100.0, 99.5], [0, 0, 1]]))
    assert field_of_view_deg(square) == pytest.approx(2 * np.degrees(np.arctan(np.sqrt(2))))
    fisheye = Camera(200, 200, square.matrix, np.zeros(4), "fisheye")
    assert field_of_view_deg(fisheye) == pytest.approx(np.degrees(2 * np.sqrt(2)), abs=0.2)


def test_pictures_do_not_depend_on_the_number_of_cores(monkeypatch):
    pose = look_at_pad(900.0, tilt_deg=30.0)
    pictures = []
    for cores in (1, 5):
        monkeypatch.setattr(radiance_module.os, "cpu_count", lambda cores=cores: cores)
        pictures.append(render(Scene(pad=None, ground="gravel"), LENSES["barrel"], pose).image)
    assert np.array_equal(*pictures)
