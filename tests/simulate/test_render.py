"""Geometry, photometry and refusals of the simulated camera."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from edge_corners import measured_corner

from padstudio.errors import LimitError, SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.layout import layout
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.motion import Motion, poses_at, row_times_s
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.scene import Light, Occluder, Scene, Shadow
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging

LINEAR = Imaging.ideal().with_changes(tone="linear")
PLAIN_LENS = (0.0, 0.0, 0.0, 0.0, 0.0)
WIDE_LENS = (-0.28, 0.09, 0.0006, -0.0004, -0.01)


def camera(distortion=PLAIN_LENS, width=640, height=480, focal=440.0):
    matrix = np.array([[focal, 0, width * 0.51], [0, focal, height * 0.49], [0, 0, 1]])
    return Camera(width, height, matrix, np.array(distortion))


def checker(rows=7, cols=9, cell_mm=45.0):
    """White cells on black in the red channel, so that every corner is a saddle."""
    field = np.add.outer(np.arange(rows), np.arange(cols)) % 2
    return Pad((Layer("red", cell_mm, field.astype(np.uint8)),), window=3)


def random_pad(seed=5, cells=25, cell_mm=10.0):
    rng = np.random.default_rng(seed)
    fine = rng.integers(0, 2, (cells, cells)).astype(np.uint8)
    coarse = rng.integers(0, 2, (5, 5)).astype(np.uint8)
    return Pad((Layer("red", cell_mm, fine), Layer("blue", cell_mm * cells / 5, coarse)), window=4)


def scene(pad, **changes):
    return Scene(pad=pad, inks=Inks.ideal(), ground="plain", **changes)


def corner_errors(frame):
    """(N, 2) measured minus true corners, of those well within the frame."""
    grid = frame.truth.corners_px("red")
    image = frame.image[:, :, 2].astype(float)
    limit = np.array([image.shape[1], image.shape[0]]) - 27
    errors = []
    for row in range(1, grid.shape[0] - 1):
        for col in range(1, grid.shape[1] - 1):
            corner = grid[row, col]
            if (corner > 26).all() and (corner < limit).all():
                along = grid[row, col + 1] - grid[row, col - 1]
                across = grid[row + 1, col] - grid[row - 1, col]
                errors.append(measured_corner(image, corner, along, across) - corner)
    return np.array(errors)


@pytest.mark.parametrize("distortion", [PLAIN_LENS, WIDE_LENS], ids=["plain", "wide"])
@pytest.mark.parametrize(("heading", "tilt"), [(0.0, 0.0), (31.0, 0.0), (77.0, 30.0)])
def test_corners_lie_where_the_geometry_says(distortion, heading, tilt):
    pose = look_at_pad(380.0, tilt_deg=tilt, heading_deg=heading, tilt_towards_deg=20.0)
    errors = corner_errors(render(scene(checker()), camera(distortion), pose, LINEAR))
    assert len(errors) > 12
    assert np.linalg.norm(errors, axis=1).max() < 0.005
    assert np.abs(errors.mean(axis=0)).max() < 0.002


@pytest.mark.parametrize("height", [500.0, 2000.0, 4000.0])
def test_area_sampling_agrees_with_a_16_times_finer_picture(height):
    small = camera(WIDE_LENS, 80, 60, 120.0)
    pose = look_at_pad(height, tilt_deg=25.0, heading_deg=13.0)
    frame = render(scene(random_pad()), small, pose, LINEAR)
    fine = render(scene(random_pad()), small.for_frame(1280, 960), pose, LINEAR)
    reference = fine.image.reshape(60, 16, 80, 16, 3).mean(axis=(1, 3))
    difference = frame.image - reference
    assert np.sqrt((difference**2).mean()) < 0.3
    assert abs(difference.mean()) < 0.02
    assert np.abs(difference).max() < 2.0


def test_motion_blur_is_the_mean_of_the_path():
    cam, pose = camera(width=160, height=120, focal=110.0), look_at_pad(400.0, heading_deg=20.0)
    motion = Motion(velocity_mm_s=(900.0, -300.0, 400.0), angular_deg_s=(20.0, 0.0, 60.0))
    moving = render(
        scene(random_pad()), cam, pose, LINEAR.with_changes(exposure_ms=20.0), motion=motion
    )
    instants = (np.arange(48) + 0.5) / 48 * 0.02 - 0.01
    rotations, positions = poses_at(pose, motion, instants)
    stills = [
        render(scene(random_pad()), cam, type(pose)(p, r), LINEAR).image.astype(float)
        for p, r in zip(positions, rotations, strict=True)
    ]
    difference = moving.image - np.mean(stills, axis=0)
    assert np.sqrt((difference**2).mean()) < 2.0
    assert abs(difference.mean()) < 0.2
    still = render(scene(random_pad()), cam, pose, LINEAR).image.astype(float)
    assert np.sqrt(((moving.image - still) ** 2).mean()) > 20


def test_rolling_shutter_reads_each_row_at_its_own_time():
    cam, pose = camera(width=160, height=120, focal=110.0), look_at_pad(400.0, heading_deg=20.0)
    motion = Motion(velocity_mm_s=(2000.0, 0.0, 0.0), angular_deg_s=(0.0, 0.0, 90.0))
    imaging = LINEAR.with_changes(readout_ms=30.0)
    rolled = render(scene(random_pad()), cam, pose, imaging, motion=motion).image
    times = row_times_s(120, 30.0)
    for row in (0, 59, 60, 119):
        rotation, position = poses_at(pose, motion, times[row])
        still = render(scene(random_pad()), cam, type(pose)(position, rotation), LINEAR).image
        assert np.abs(rolled[row].astype(int) - still[row]).max() <= 1
    assert abs(times[59] + times[60]) < 1e-12


def test_same_seed_same_picture_other_seed_other_noise():
    cam, pose = camera(width=320, height=240, focal=200.0), look_at_pad(600.0)
    everyday = Scene(pad=random_pad(), ground="grass")
    first, again, other = (render(everyday, cam, pose, seed=seed) for seed in (3, 3, 4))
    assert np.array_equal(first.image, again.image)
    assert first.encoded == again.encoded
    assert not np.array_equal(first.image, other.image)
    stored = cv2.imdecode(np.frombuffer(first.encoded, np.uint8), cv2.IMREAD_COLOR)
    assert np.array_equal(stored, first.image)


def test_sky_stands_over_the_horizon():
    pose = look_at_pad(300.0, tilt_deg=80.0)
    image = render(scene(random_pad()), camera(), pose, LINEAR).image
    assert (image[0] == image[0, 0]).all()
    assert image[0, 0, 0] > image[0, 0, 2]
    assert not (image[-1] == image[0, 0]).all()


def test_shadow_occluder_and_gradient_lie_where_they_were_put():
    pose, cam = look_at_pad(400.0), camera()
    pad = checker()
    plain = render(scene(pad), cam, pose, LINEAR).image.astype(float)
    shadow = Shadow(x_mm=0, y_mm=0, toward_deg=90, softness_mm=0, density=0.5)
    light = Light(shadows=(shadow,))
    shaded = render(scene(pad, light=light), cam, pose, LINEAR).image.astype(float)
    axis = int(cam.matrix[0, 2])
    assert np.allclose(shaded[:, : axis - 2], plain[:, : axis - 2])
    assert np.allclose(shaded[:, axis + 3 :], plain[:, axis + 3 :] * 0.5, atol=1.0)
    leaf = Occluder(x_mm=60.0, y_mm=20.0, radius_mm=9.0, color=(0, 255, 0))
    covered = render(scene(pad, occluders=(leaf,)), cam, pose, LINEAR).image
    x, y = cam.project((np.array([[60.0, 20.0, 0.0]]) - pose.position_mm) @ pose.rotation)[0]
    assert covered[round(y), round(x)].tolist() == [0, 255, 0]
    share = (covered[100:380, 100:540, 1] > 127).sum() / (np.pi * (9.0 * 440 / 400) ** 2)
    assert share == pytest.approx(1.0, abs=0.03)
    slope = Light(gradient_per_m=(2.0, 0.0))
    graded = render(scene(pad, light=slope), cam, pose, LINEAR).image.astype(float)
    x_mm = 20 / 440 * 400 / 1000
    assert graded[300, axis - 20].sum() == pytest.approx(
        plain[300, axis - 20].sum() * (1 - 2 * x_mm), abs=4
    )


def test_quiet_margin_and_measured_scale():
    pose, cam = look_at_pad(900.0), camera()
    pad = Pad(checker().layers, window=3, scale=(1.02, 0.99))
    image = render(scene(pad, quiet_mm=20.0), cam, pose, LINEAR).image
    white = (image.min(axis=2) > 127).sum() * (900 / 440) ** 2
    w, h = pad.size_mm
    expected = (w + 40 * 1.02) * (h + 40 * 0.99) - w * h
    assert white == pytest.approx(expected, rel=0.02)


def test_bare_ground_shows_no_pad():
    image = render(scene(None), camera(), look_at_pad(400.0), LINEAR).image
    assert (image == image[0, 0]).all()


@pytest.mark.parametrize(
    ("height", "tilt", "code"), [(-5.0, 0.0, "pose_below_ground"), (0.4, 0.0, "pose_below_ground")]
)
def test_refuses_a_pose_below_the_ground(height, tilt, code):
    with pytest.raises(SpecError, match="at least 1 mm") as caught:
        render(scene(random_pad()), camera(), look_at_pad(height, tilt_deg=tilt))
    assert caught.value.error_code == code


def test_refuses_a_camera_that_sees_no_ground():
    pose = look_at_pad(500.0)
    upward = type(pose)(pose.position_mm, pose.rotation @ np.diag([1.0, -1.0, -1.0]))
    with pytest.raises(SpecError, match="sees no ground") as caught:
        render(scene(random_pad()), camera(), upward)
    assert caught.value.error_code == "camera_sees_no_ground"


def test_refuses_a_motion_through_the_ground():
    with pytest.raises(SpecError, match="while the frame is exposed"):
        render(
            scene(random_pad()),
            camera(),
            look_at_pad(20.0),
            Imaging(exposure_ms=20.0),
            motion=Motion(velocity_mm_s=(0, 0, -5000.0)),
        )


def test_refuses_a_plain_lens_of_more_than_170_degrees():
    plain = Camera(640, 640, np.array([[20.0, 0, 320], [0, 20.0, 320], [0, 0, 1.0]]))
    with pytest.raises(LimitError, match="170") as caught:
        render(scene(random_pad()), plain, look_at_pad(500.0))
    assert caught.value.error_code == "field_of_view_too_wide"


def test_refuses_a_lens_without_inverse_and_a_giant_frame():
    folded = camera((-0.9, 0.0, 0.0, 0.0, 0.0), focal=200.0)
    with pytest.raises(SpecError, match="cannot be inverted"):
        render(scene(random_pad()), folded, look_at_pad(500.0))
    with pytest.raises(LimitError, match="50000000"):
        render(scene(random_pad()), camera(width=10_000, height=10_000), look_at_pad(500.0))


def test_a_fisheye_lens_is_true_too():
    fisheye = Camera(
        640,
        480,
        np.array([[330.0, 0, 320], [0, 330.0, 240], [0, 0, 1.0]]),
        np.array([0.03, -0.01, 0.002, 0.0]),
        "fisheye",
    )
    frame = render(scene(checker()), fisheye, look_at_pad(220.0, heading_deg=10.0), LINEAR)
    errors = corner_errors(frame)
    assert len(errors) > 12
    assert np.linalg.norm(errors, axis=1).max() < 0.005


def test_a_sheet_is_painted_as_the_pad_of_its_layout():
    pad = replace(random_pad(), quiet_mm=12.0)
    pose = look_at_pad(500.0, tilt_deg=20.0, heading_deg=35.0)
    images = [
        render(scene, camera(), pose, seed=3).image
        for scene in (Scene(pad=pad), Scene(pad=None, sheet=layout(pad)))
    ]
    assert np.array_equal(*images)


def test_a_pad_and_another_sheet_cannot_lie_in_one_place():
    pad = random_pad()
    with pytest.raises(SpecError, match="not both"):
        Scene(pad=pad, sheet=layout(pad))
