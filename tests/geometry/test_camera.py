import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.errors import CameraFormatError, CameraMismatchError
from padstudio.geometry.camera import Camera

K = np.array([[880.0, 0, 652.3], [0, 881.0, 471.8], [0, 0, 1]])
LENSES = {
    "pinhole": Camera(1280, 960, K),
    "4 coefficients": Camera(1280, 960, K, [-0.28, 0.09, 0.0006, -0.0004]),
    "5 coefficients": Camera(1280, 960, K, [-0.28, 0.09, 0.0006, -0.0004, -0.01]),
    "8 coefficients": Camera(
        1280, 960, K, [-0.28, 0.09, 0.0006, -0.0004, -0.01, 0.02, 0.003, 0.001]
    ),
    "fisheye": Camera(1280, 960, K, [-0.02, 0.004, -0.001, 0.0002], model="fisheye"),
    "fisheye without coefficients": Camera(1280, 960, K, model="fisheye"),
}


@pytest.mark.parametrize("camera", LENSES.values(), ids=LENSES)
@given(st.lists(st.tuples(st.floats(0, 1279), st.floats(0, 959)), max_size=20))
def test_denormalize_inverts_normalize(camera, pixels):
    pixels = np.array(pixels).reshape(-1, 2)
    back = camera.denormalize(camera.normalize(pixels))
    assert back.shape == pixels.shape
    np.testing.assert_allclose(back, pixels, atol=2e-3)


@pytest.mark.parametrize("camera", LENSES.values(), ids=LENSES)
def test_lenses_are_opencvs(camera):
    """To a part of a pixel that is far below what OpenCV's iteration leaves."""
    x, y = np.meshgrid(np.linspace(0, 1279, 15), np.linspace(0, 959, 12))
    pixels = np.stack([x.ravel(), y.ravel()], axis=1)
    rays = camera.normalize(pixels)
    assert np.abs(camera.denormalize(rays) - pixels).max() < 1e-9
    points, zero = np.column_stack([rays, np.ones(len(rays))])[:, None], np.zeros(3)
    coefficients = np.pad(camera.distortion, (0, 4 - min(len(camera.distortion), 4)))
    project = cv2.fisheye.projectPoints if camera.model == "fisheye" else cv2.projectPoints
    plain = project(points, zero, zero, camera.matrix, coefficients)[0].reshape(-1, 2)
    np.testing.assert_allclose(plain, pixels, atol=1e-9)


@pytest.mark.parametrize("camera", LENSES.values(), ids=LENSES)
def test_sharpness_is_how_far_a_pixel_is_from_the_next_outward(camera):
    rng = np.random.default_rng(3)
    pixels = rng.uniform((0, 0), (1279, 959), (40, 2))
    rays = camera.normalize(pixels)
    sharp = camera.sharpness(pixels, rays)
    if not camera.distorted:
        np.testing.assert_allclose(sharp, 1, atol=1e-12)
    elif not camera.distortion.any():
        squared_cosine = 1 / (1 + (rays**2).sum(axis=1))
        np.testing.assert_allclose(sharp, squared_cosine, rtol=0.02)
    outward = rays + 1e-3 * rays / np.linalg.norm(rays, axis=1, keepdims=True)
    moved = np.linalg.norm(camera.denormalize(outward) - pixels, axis=1)
    np.testing.assert_allclose(sharp, moved / 1e-3 / camera.focal_px, rtol=0.02)


def test_every_pixel_of_a_narrow_lens_has_a_ray():
    x, y = np.meshgrid(np.linspace(0, 1279, 15), np.linspace(0, 959, 12))
    pixels = np.stack([x.ravel(), y.ravel()], axis=1)
    for camera in LENSES.values():
        assert camera.has_ray(pixels, camera.normalize(pixels)).all()


def test_pixels_to_the_side_and_beyond_have_no_ray():
    camera = LENSES["fisheye without coefficients"]
    angles = np.radians([0, 40, 84, 86, 90, 110])
    pixels = np.column_stack([652.3 + 880 * angles, np.full(6, 471.8)])
    seen = camera.has_ray(pixels, camera.normalize(pixels))
    np.testing.assert_array_equal(seen, [True, True, True, False, False, False])


def test_pixels_beyond_where_a_polynomial_turns_back_have_no_ray():
    """r (1 − 0.5 r²) is at most 0.544, at r = 0.816."""
    camera = Camera(1280, 960, K, [-0.5, 0, 0, 0])
    radii = np.array([0.2, 0.5, 0.54, 0.56, 0.7])
    pixels = np.column_stack([652.3 + 880 * radii, np.full(5, 471.8)])
    seen = camera.has_ray(pixels, camera.normalize(pixels))
    np.testing.assert_array_equal(seen, [True, True, True, False, False])


def test_a_point_behind_the_camera_has_no_picture():
    for camera in LENSES.values():
        seen = camera.project([[10, 20, 700], [10, 20, -700], [10, 20, 0]])
        assert np.isfinite(seen[0]).all()
        assert np.isnan(seen[1:]).all()


def test_a_fisheye_sees_rays_up_to_a_right_angle():
    """Rays beyond, which the plane z = 1 does not hold, count as just within."""
    camera = LENSES["fisheye without coefficients"]
    angles = np.radians([10, 60, 89, 89.999, 91, 120])
    pixels = np.column_stack([652.3 + 880 * angles, np.full(6, 471.8)])
    found = camera.normalize(pixels)
    np.testing.assert_allclose(found[:, 1], 0, atol=1e-9)
    np.testing.assert_allclose(np.arctan(found[:4, 0]), angles[:4], atol=1e-12)
    np.testing.assert_allclose(np.arctan(found[4:, 0]), np.pi / 2, atol=2e-6)


@pytest.mark.parametrize("camera", LENSES.values(), ids=LENSES)
def test_points_on_the_axis_meet_the_principal_point(camera):
    np.testing.assert_allclose(camera.project([[0, 0, 700]]), [[652.3, 471.8]], atol=1e-9)


def test_projection_of_a_pinhole_is_similar_triangles():
    pixel = LENSES["pinhole"].project([[10, -20, 100]])[0]
    np.testing.assert_allclose(pixel, [652.3 + 88, 471.8 - 176.2])


def test_radial_distortion_is_the_models_polynomial():
    camera = Camera(1280, 960, K, [-0.2, 0.05, 0, 0])
    x, y = 0.3, -0.2
    factor = 1 - 0.2 * (x * x + y * y) + 0.05 * (x * x + y * y) ** 2
    expected = [652.3 + 880 * factor * x, 471.8 + 881 * factor * y]
    np.testing.assert_allclose(camera.denormalize([[x, y]])[0], expected)


def test_equidistant_fisheye_maps_angle_to_radius():
    camera = LENSES["fisheye without coefficients"]
    angle = np.radians(50)
    pixel = camera.project([[np.tan(angle), 0, 1]])[0]
    np.testing.assert_allclose(pixel, [652.3 + 880 * angle, 471.8], atol=1e-6)


def test_a_matrix_with_skew_is_inverted_exactly():
    camera = Camera(1280, 960, K + np.array([[0, 7.0, 0], [0, 0, 0], [0, 0, 0]]))
    pixels = np.array([[3.0, 900.0], [1200.0, 12.0]])
    np.testing.assert_allclose(camera.denormalize(camera.normalize(pixels)), pixels)


@given(st.integers(20, 2000), st.floats(-0.4, 0.4), st.floats(-0.4, 0.4))
def test_a_scaled_camera_sees_the_same_directions(unit, x, y):
    camera = LENSES["5 coefficients"]
    width, height = 4 * unit, 3 * unit
    scaled = camera.for_frame(width, height)
    corner = np.array([0.5, 0.5])
    factors = np.array([width / 1280, height / 960])
    expected = (camera.denormalize([[x, y]])[0] + corner) * factors - corner
    np.testing.assert_allclose(scaled.denormalize([[x, y]])[0], expected, atol=1e-9)
    assert scaled.scale == pytest.approx(width / 1280)


def test_the_calibrated_size_needs_no_other_camera():
    camera = LENSES["pinhole"]
    assert camera.for_frame(1280, 960) is camera


def test_another_aspect_is_refused_by_name():
    with pytest.raises(CameraMismatchError, match="1280 x 960, of another aspect"):
        LENSES["pinhole"].for_frame(1280, 720)


def test_one_pixel_of_rounding_is_the_same_aspect():
    assert Camera(2720, 1530, K).for_frame(1360, 765).scale == 0.5
    assert Camera(4000, 2250, K).for_frame(1333, 750).scale == pytest.approx(1 / 3, rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"width": 0}, "not positive"),
        ({"matrix": np.eye(2)}, "3 x 3"),
        ({"matrix": K * np.nan}, "finite"),
        ({"matrix": -K}, "positive focal lengths"),
        ({"distortion": [0.1, 0.2]}, "radtan takes 0, 4, 5, 8 distortion coefficients, not 2"),
        ({"distortion": [np.inf] * 4}, "finite"),
        ({"model": "fisheye", "distortion": [0.0] * 5}, "fisheye takes 0, 4"),
        ({"model": "omni"}, "unknown lens model 'omni'"),
    ],
)
def test_impossible_cameras_are_refused(changes, message):
    values = {"width": 1280, "height": 960, "matrix": K} | changes
    with pytest.raises(CameraFormatError, match=message):
        Camera(**values)


def test_a_camera_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        LENSES["pinhole"].matrix[0, 0] = 1
