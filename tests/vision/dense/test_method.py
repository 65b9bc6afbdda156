"""The dense method as a whole, against the truth of simulated frames."""

from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest
from dense_frames import errors, frame_of, random_pad, random_pose, sample_pad, small_camera

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.scene import Light, Occluder, Scene, Shadow
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Glare, Imaging
from padstudio.vision.detector import Detector
from padstudio.vision.stage.params import DetectorParams, RefineParams

LENS = (-0.28, 0.09, 0.001, -0.0008)


@cache
def detector(lens=(0.0,) * 4):
    return Detector(sample_pad(), small_camera(lens))


def found_well(found, pose, *, percent=0.3, degrees=0.3):
    assert found.ok, found.failure
    position, attitude = errors(found.pose, pose)
    assert position < percent
    assert attitude < degrees
    assert found.log10_false_alarm <= DetectorParams().log10_false_alarm


@pytest.mark.parametrize(
    ("height_mm", "layers"),
    [
        (45.0, {"red"}),
        (90.0, {"red"}),
        (250.0, {"red"}),
        (700.0, {"red", "blue"}),
        (1600.0, {"blue", "red"}),
        (3500.0, {"blue"}),
        (7000.0, {"blue", "outline"}),
        (9500.0, {"blue", "outline"}),
    ],
)
def test_cells_of_two_to_two_hundred_pixels(height_mm, layers):
    """From 490 px a coarse cell and 98 a fine one down to 2.3 px a coarse cell."""
    rng = np.random.default_rng(int(height_mm))
    pose = random_pose(rng, height_mm, tilt_deg=20.0, reach_mm=300.0 if height_mm < 300 else 50.0)
    found = detector().detect(frame_of(pose, camera=small_camera()))
    assert found.layer in layers
    found_well(found, pose, percent=0.5 if 60 < height_mm < 5000 else 2.5, degrees=1.5)


@pytest.mark.parametrize("heading_deg", [1.0, 90.0, 137.0, 271.0])
def test_any_heading(heading_deg):
    pose = look_at_pad(800.0, tilt_deg=12, heading_deg=heading_deg, tilt_towards_deg=60)
    found_well(detector().detect(frame_of(pose, camera=small_camera())), pose)


@pytest.mark.parametrize("tilt_deg", [30.0, 60.0, 70.0])
def test_tilts(tilt_deg):
    height_mm = 700 * np.cos(np.radians(tilt_deg))
    pose = look_at_pad(height_mm, tilt_deg=tilt_deg, heading_deg=200, tilt_towards_deg=75)
    found = detector().detect(frame_of(pose, camera=small_camera()))
    found_well(found, pose, percent=0.6, degrees=0.5)


@pytest.mark.parametrize("target_mm", [(600, 0), (-550, 560), (0, -760)])
def test_the_pads_rim_across_the_picture(target_mm):
    pose = look_at_pad(500.0, tilt_deg=10, heading_deg=50, target_mm=target_mm)
    found_well(detector().detect(frame_of(pose, camera=small_camera())), pose)


@pytest.mark.parametrize("height_mm", [300.0, 1100.0])
def test_a_lens_that_bends_lines(height_mm):
    pose = look_at_pad(height_mm, tilt_deg=25, heading_deg=310, tilt_towards_deg=15)
    found_well(detector(LENS).detect(frame_of(pose, camera=small_camera(LENS))), pose)


@pytest.mark.parametrize("levels", [3, 4])
@pytest.mark.parametrize("height_mm", [220.0, 900.0])
def test_more_levels_than_two_in_good_light(levels, height_mm):
    pad = random_pad(31, levels=levels)
    pose = look_at_pad(height_mm, tilt_deg=10, heading_deg=120, tilt_towards_deg=200)
    image = frame_of(pose, pad=pad, camera=small_camera())
    found_well(Detector(pad, small_camera()).detect(image), pose, percent=0.5)


def salted(image, share):
    rng = np.random.default_rng(3)
    hit = rng.random(image.shape[:2])
    image = image.copy()
    image[hit < share / 2], image[hit > 1 - share / 2] = 0, 255
    return image


LEAVES = tuple(
    Occluder(x_mm=float(x), y_mm=float(y), radius_mm=110.0)
    for x, y in np.random.default_rng(6).uniform(-500, 500, (16, 2))
)
HALF = Shadow(x_mm=50.0, toward_deg=70.0, softness_mm=10.0, density=0.85)

DISTURBED = {
    "dark": (Imaging(brightness=0.04), {}),
    "bright": (Imaging(brightness=2.2), {}),
    "noise": (Imaging(full_well_e=400, read_noise_e=10), {}),
    "jpeg": (Imaging(jpeg_quality=20), {}),
    "defocus": (Imaging(defocus_px=3.5), {}),
    "glare": (Imaging(glare=Glare(x=0.4, y=0.4)), {}),
    "stuck pixels": (Imaging(hot_pixels=0.02), {}),
    "cast": (Imaging(), {"light": Light(cast=(1.6, 1.0, 0.5))}),
    "falling off": (Imaging(), {"light": Light(gradient_per_m=(1.2, 0.6))}),
    "shadow": (Imaging(), {"light": Light(shadows=(HALF,))}),
    "occluders": (Imaging(), {"occluders": LEAVES}),
}


@pytest.mark.parametrize("kind", DISTURBED)
def test_disturbances(kind):
    imaging, scene = DISTURBED[kind]
    pose = look_at_pad(1000.0, tilt_deg=15, heading_deg=77, tilt_towards_deg=240)
    image = frame_of(pose, camera=small_camera(), imaging=imaging, seed=5, **scene)
    found_well(detector().detect(image), pose, percent=0.6)


def test_salt_and_pepper():
    pose = look_at_pad(700.0, tilt_deg=15, heading_deg=77)
    image = salted(frame_of(pose, camera=small_camera()), 0.08)
    found_well(detector().detect(image), pose, percent=0.6)


def blurred(pose, pixels):
    """A frame whose pad moves by so many pixels while the shutter is open."""
    height = float(pose.position_mm[2])
    speed = pixels * height / 440.0 / 0.01
    motion = Motion(velocity_mm_s=(0.8 * speed, 0.6 * speed, 0.0))
    imaging = Imaging(exposure_ms=10.0)
    return render(Scene(pad=sample_pad()), small_camera(), pose, imaging, motion=motion).image


@pytest.mark.parametrize(("height_mm", "pixels"), [(600.0, 8.0), (600.0, 14.0), (150.0, 14.0)])
def test_motion_blur(height_mm, pixels):
    pose = look_at_pad(height_mm, heading_deg=20)
    found_well(detector().detect(blurred(pose, pixels)), pose, percent=1.0, degrees=0.5)


def sigma_of(image, camera=None, **refine):
    params = DetectorParams(refine=RefineParams(**refine))
    found = Detector(sample_pad(), camera or small_camera(), params=params).detect(image)
    assert found.uncertainty is not None
    return found.uncertainty


def test_what_may_roll_leaves_in_doubt_what_motion_shows():
    """A camera that drifts may sink as well, which looks like tilt; one at rest does not."""
    pose = look_at_pad(500.0, tilt_deg=10, heading_deg=70)
    motion = Motion(velocity_mm_s=(60.0, -40.0, 0.0), angular_deg_s=(4.0, -6.0, 8.0))
    imaging = Imaging(exposure_ms=2.0, readout_ms=20.0)
    scene, camera = Scene(pad=sample_pad()), small_camera()
    drifting = render(scene, camera, pose, imaging, motion=motion).image
    assert sigma_of(frame_of(pose, camera=camera)).position_sigma_mm.max() < 0.5
    assert sigma_of(drifting).position_sigma_mm.max() > 2.5
    # Reading the frame takes so little time that nobody can sink far.
    quick = sigma_of(drifting, replace(camera, readout_ms=2.0)).position_sigma_mm.max()
    assert quick < 0.3 * sigma_of(drifting).position_sigma_mm.max()


def test_a_global_shutter_and_a_camera_at_rest_have_no_such_doubt():
    pose = look_at_pad(500.0, tilt_deg=10, heading_deg=70)
    camera = replace(small_camera(), readout_ms=0.0)
    image = blurred(pose, 5.0)
    shut, rest = sigma_of(image, camera), sigma_of(image, at_rest=True)
    for sigma in (shut, rest, sigma_of(image, motion=False)):
        assert sigma.position_sigma_mm.max() < 0.5
    # Where the camera is by the middle of a blur, only rest tells.
    assert shut.attitude_sigma_deg.max() > 3 * rest.attitude_sigma_deg.max()


def test_the_uncertainty_is_that_of_the_error():
    params = DetectorParams(refine=RefineParams(motion=False))
    still = Detector(sample_pad(), small_camera(), params=params)
    squares = []
    for seed in range(10):
        rng = np.random.default_rng(100 + seed)
        pose = random_pose(rng, float(rng.uniform(200, 900)), tilt_deg=30.0, reach_mm=100.0)
        image = frame_of(pose, camera=small_camera(), imaging=Imaging(jpeg_quality=None), seed=seed)
        found = still.detect(image)
        assert found.uncertainty is not None
        turn = cv2.Rodrigues(found.pose.rotation.T @ pose.rotation)[0].ravel()
        error = np.concatenate([pose.position_mm - found.pose.position_mm, turn])
        squares.append(error @ np.linalg.solve(found.uncertainty.covariance, error) / 6)
    assert 0.2 < np.mean(squares) < 2.5


def checkerboard():
    cells = (np.add.outer(np.arange(25), np.arange(25)) % 2).astype(np.uint8)
    return Pad(tuple(Layer(c, 50.0, cells) for c in ("red", "blue")), window=3)


@pytest.mark.parametrize("ground", ["grass", "gravel", "bricks", "sand"])
def test_bare_ground_is_no_pad(ground):
    scene = Scene(pad=None, ground=ground)
    image = render(scene, small_camera(), look_at_pad(1500.0, tilt_deg=20)).image
    found = detector().detect(image)
    assert not found.ok
    assert found.failure.advice


@pytest.mark.parametrize("height_mm", [250.0, 1200.0, 6000.0])
@pytest.mark.parametrize("pad", [random_pad(77), checkerboard()], ids=["foreign", "checkerboard"])
def test_another_pad_is_not_this_one(pad, height_mm):
    pose = look_at_pad(height_mm, tilt_deg=15, heading_deg=33, tilt_towards_deg=140)
    assert not detector().detect(frame_of(pose, pad=pad, camera=small_camera())).ok


def aruco_board():
    board = np.full((480, 640), 255, np.uint8)
    table = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_1000)
    for number in range(70):
        row, col = divmod(number, 10)
        marker = cv2.aruco.generateImageMarker(table, number, 49)
        board[10 + row * 64 : 59 + row * 64, 10 + col * 62 : 59 + col * 62] = marker
    return cv2.cvtColor(board, cv2.COLOR_GRAY2BGR)


def text():
    page = np.full((480, 640, 3), 245, np.uint8)
    for y in range(20, 480, 18):
        cv2.putText(page, "the quick brown fox 0123456789 " * 3, (4, y), 0, 0.5, (20, 20, 20), 1)
    return page


def noise(size):
    rng = np.random.default_rng(size)
    values = rng.integers(0, 2, (480 // size, 640 // size, 3), dtype=np.uint8) * 160 + 40
    values[:, :, 1] = 40
    return np.repeat(np.repeat(values, size, axis=0), size, axis=1)


@pytest.mark.parametrize(
    "image",
    [aruco_board(), text(), noise(1), noise(16)],
    ids=["aruco", "text", "noise 1", "noise 16"],
)
def test_pictures_of_other_things(image):
    assert not detector().detect(image).ok


@pytest.mark.parametrize("shape", [(16, 16), (17, 640), (480, 16)])
def test_pictures_too_small_to_hold_a_pad(shape):
    image = np.random.default_rng(0).integers(0, 255, (*shape, 3), dtype=np.uint8)
    found = Detector(sample_pad(), camera_of(shape)).detect(image)
    assert not found.ok


def camera_of(shape):
    height, width = shape
    return Camera(width, height, np.array([[300.0, 0, width / 2], [0, 300, height / 2], [0, 0, 1]]))
