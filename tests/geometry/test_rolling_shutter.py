"""Poses that change while a frame is read."""

import cv2
import numpy as np
import pytest
from dense_frames import seen_by, small_camera
from hypothesis import given
from hypothesis import strategies as st

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose, cross, picture_change, row_times
from padstudio.simulate.motion import Motion, poses_at

LENS = (-0.28, 0.09, 0.001, -0.0008)
POINTS = np.column_stack([np.random.default_rng(4).uniform(-200, 200, (60, 2)), np.zeros(60)])


def fisheye():
    plain = small_camera()
    return Camera(640, 480, plain.matrix, np.array([0.02, -0.01, 0.003, 0.0]), "fisheye")


CAMERAS = {"pinhole": small_camera(), "lens": small_camera(LENS), "fisheye": fisheye()}

MOVES = st.tuples(*[st.floats(-20, 20)] * 3, *[st.floats(-0.02, 0.02)] * 3)


@given(
    which=st.sampled_from(sorted(CAMERAS)),
    tilt=st.floats(0, 40),
    heading=st.floats(0, 360),
    lean=st.floats(0, 360),
)
def test_a_still_pose_projects_as_the_camera_does(which, tilt, heading, lean):
    camera = CAMERAS[which]
    pose = look_at_pad(600.0, tilt_deg=tilt, heading_deg=heading, tilt_towards_deg=lean)
    seen = (POINTS - pose.position_mm) @ pose.rotation
    moving = MovingPose(pose)
    assert moving.still
    np.testing.assert_allclose(pose.to_camera(POINTS), seen, atol=1e-9)
    np.testing.assert_allclose(moving.project(camera, POINTS), camera.project(seen), atol=1e-6)


@given(which=st.sampled_from(sorted(CAMERAS)), move=MOVES, heading=st.floats(0, 360))
def test_a_point_is_seen_where_it_is_when_its_row_is_read(which, move, heading):
    """The law of a rolling shutter: row, time and place agree with each other."""
    camera = CAMERAS[which]
    pose = look_at_pad(600.0, tilt_deg=10, heading_deg=heading)
    moving = MovingPose(pose, np.array(move[:3]), np.array(move[3:]))
    pixels = moving.project(camera, POINTS)
    inside = (pixels[:, 1] >= 0) & (pixels[:, 1] < camera.height)
    row_time = row_times(camera, pixels[:, 1])
    again = camera.project(seen_by(moving, POINTS, row_time))
    np.testing.assert_allclose(again[inside], pixels[inside], atol=0.02)


@pytest.mark.parametrize("readout_ms", [10.0, 30.0])
def test_row_times_and_moves_are_the_simulators(readout_ms):
    camera = small_camera()
    pose = look_at_pad(800.0, tilt_deg=15, heading_deg=70)
    motion = Motion(velocity_mm_s=(300, -200, -400), angular_deg_s=(8, -5, 12))
    change = readout_ms / 1000
    moving = MovingPose(
        pose,
        change * np.array(motion.velocity_mm_s),
        change * np.radians(motion.angular_deg_s),
    )
    for row in (0.0, 200.0, 479.0):
        row_time = float(row_times(camera, np.array([row]))[0])
        rotation, position = poses_at(pose, motion, np.array([row_time * change]))
        there = (POINTS - position[0]) @ rotation[0]
        # First order in the turn: exact to its square.
        np.testing.assert_allclose(seen_by(moving, POINTS, row_time), there, atol=0.02)


def test_points_behind_the_camera_have_no_picture():
    pose = look_at_pad(100.0, tilt_deg=80)
    behind = pose.position_mm - 500 * pose.rotation[:, 2]
    for camera in CAMERAS.values():
        for moving in (MovingPose(pose), MovingPose(pose, np.ones(3), np.full(3, 0.01))):
            assert np.isnan(moving.project(camera, behind[None])).all()


@given(move=MOVES)
def test_steps_add_up_and_stay_rotations(move):
    start = MovingPose(look_at_pad(500.0, tilt_deg=20), np.ones(3), np.full(3, 0.01))
    step = np.array([*move, *move])
    there = start.moved(step)
    np.testing.assert_allclose(there.pose.rotation @ there.pose.rotation.T, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(there.shift_mm, 1 + step[6:9])
    np.testing.assert_allclose(there.rotvec, 0.01 + step[9:])
    np.testing.assert_allclose(start.step_to(there), step[:6], atol=1e-9)
    six = start.moved(step[:6])
    np.testing.assert_array_equal(six.shift_mm, start.shift_mm)
    np.testing.assert_array_equal(six.pose.rotation, there.pose.rotation)


def test_cross_products():
    a, b = np.random.default_rng(1).normal(size=(2, 9, 3))
    np.testing.assert_allclose(cross(a, b), np.cross(a, b), atol=1e-12)


def test_a_pose_is_the_inverse_of_what_it_projects():
    camera, pose = CAMERAS["lens"], look_at_pad(500.0, tilt_deg=25, heading_deg=120)
    pixels = MovingPose(pose).project(camera, POINTS)
    found = cv2.solvePnP(POINTS, pixels, camera.matrix, camera.distortion)
    back = Pose.from_T_camera_pad(cv2.Rodrigues(found[1])[0], found[2])
    np.testing.assert_allclose(back.position_mm, pose.position_mm, atol=1e-2)


def test_pictures_change_as_the_camera_moves():
    pose = look_at_pad(700.0, tilt_deg=25.0, heading_deg=40.0)
    change = picture_change(pose.to_camera(POINTS), pose.rotation)

    def picture(step):
        seen = MovingPose(pose).moved(step).pose.to_camera(POINTS)
        return seen[:, :2] / seen[:, 2:]

    for k, size in enumerate([1e-3] * 3 + [1e-6] * 3):
        step = size * np.eye(6)[k]
        plain = (picture(step) - picture(-step)) / (2 * size)
        np.testing.assert_allclose(change[:, :, k], plain, atol=1e-6)
