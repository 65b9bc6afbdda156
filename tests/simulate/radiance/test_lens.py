"""Viewing rays and lens limits."""

import numpy as np
import pytest

from padstudio.errors import LimitError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.layout import corners_mm
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.radiance import integrate as radiance_module
from padstudio.simulate.radiance.lens import (
    beyond_lens,
    field_of_view_deg,
    in_picture,
    pixels_of_points,
    ray_map,
)
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging


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
    assert rays.shape == (lens.height + 2, lens.width + 2, 3)
    assert (rays[..., 2] == 1).all()
    pixels = lens.denormalize(rays[..., :2].reshape(-1, 2).astype(float))
    pixels = pixels.reshape(*rays.shape[:2], 2)
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


def wide(bends=(0.02, -0.012, 0.004, -0.001)):
    """A fisheye that sees 198 degrees from side to side, and does not fill the frame's corners."""
    matrix = np.array([[66.0, 0, 128.3], [0, 66.2, 95.1], [0, 0, 1]])
    return Camera(256, 192, matrix, np.array(bends), "fisheye")


def test_directions_of_a_wide_fisheye_follow_its_polynomial():
    lens = wide()
    rays, dark = ray_map(lens), beyond_lens(lens)
    assert np.abs(np.linalg.norm(rays, axis=-1) - 1).max() < 1e-6
    inner = rays[1:-1, 1:-1][~dark].astype(float)
    angle = np.arctan2(np.hypot(inner[:, 0], inner[:, 1]), inner[:, 2])
    k = lens.distortion
    bent = angle * (1 + sum(c * angle ** (2 * n + 2) for n, c in enumerate(k)))
    rows, cols = np.nonzero(~dark)
    u, v = (cols - 128.3) / 66.0, (rows - 95.1) / 66.2
    assert np.abs(bent - np.hypot(u, v)).max() < 1e-5
    assert np.degrees(angle).max() > 95
    assert np.abs(pixels_of_points(lens, inner) - np.stack([cols, rows], axis=1)).max() < 1e-3


def test_a_wide_fisheye_is_dark_beyond_its_rim_and_sees_the_sky_within():
    lens = wide()
    dark = beyond_lens(lens)
    theta = np.linspace(0, np.pi, 10_000)
    k = lens.distortion
    grown = theta * (1 + sum(c * theta ** (2 * n + 2) for n, c in enumerate(k)))
    rim = grown[: np.argmax(np.diff(grown) <= 0)].max()
    rows, cols = np.mgrid[:192, :256]
    assert np.array_equal(dark, np.hypot((cols - 128.3) / 66.0, (rows - 95.1) / 66.2) > rim)
    assert 0.01 < dark.mean() < 0.6
    image = render(Scene(pad=None, ground="plain"), lens, look_at_pad(900.0), Imaging.ideal()).image
    assert (image[dark] == 0).all()
    rays = ray_map(lens)[1:-1, 1:-1]
    # Seen from straight above, all beyond 90 degrees is sky.
    sky = ~dark & (rays[..., 2] < -0.02)
    assert sky.any()
    assert (np.abs(image[sky].astype(int) - (176, 152, 140)) <= 1).all()


def test_cells_beyond_ninety_degrees_lie_where_the_lens_puts_them():
    """Tilted by 80 degrees, a wide fisheye sees the pad's far side beyond 90 degrees."""
    pad = Pad((Layer("red", 100.0, np.indices((12, 12)).sum(0).astype(np.uint8) % 2),), window=3)
    pose = Pose(np.array([0.0, -350.0, 250.0]), look_at_pad(250.0, tilt_deg=60.0).rotation)
    truth = render(Scene(pad=pad), wide(), pose, Imaging.ideal()).truth
    points = pose.to_camera(corners_mm(pad, "red").reshape(-1, 3))
    assert (points[:, 2] < 0).sum() > 20
    pixels = truth.corners_px("red").reshape(-1, 2)
    angle = np.arctan2(np.hypot(points[:, 0], points[:, 1]), points[:, 2])
    behind = (points[:, 2] < 0) & (angle < np.radians(100))
    assert np.isfinite(pixels[behind]).all()


def test_points_that_a_polynomial_brings_back_are_not_in_the_picture():
    """Beyond its turning point a barrel lens maps far points into the frame once more."""
    lens = camera((-0.3, 0.0, 0.0, 0.0, 0.0))
    ray = np.array([[0.1, 0.05, 1.0], [0.0, 1.77, 1.0], [3.0, 0.0, 1.0], [0.1, 0.0, -1.0]])
    assert np.abs(lens.project(ray[1:2])[0] - (150.2, 125.0)).max() < 10
    assert in_picture(lens, ray).tolist() == [True, False, False, False]
    assert in_picture(wide(), np.array([[1.0, 0.0, -0.05], [0.0, 0.0, -1.0]])).tolist() == [
        True,
        False,
    ]


def test_a_lens_that_is_no_fisheye_stays_limited():
    with pytest.raises(LimitError) as refused:
        ray_map(camera(focal=8.0))
    assert refused.value.error_code == "field_of_view_too_wide"
