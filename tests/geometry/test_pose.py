import math

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.geometry.pose import (
    Pose,
    look_at_pad,
    rotation_angle_deg,
    rotation_from_vector,
    vector_from_rotation,
)

angles = st.floats(-math.pi, math.pi)
lengths = st.floats(-5000, 5000)


@st.composite
def poses(draw):
    axis = np.array([draw(angles) for _ in range(3)])
    rotation = np.asarray(cv2.Rodrigues(axis)[0], float)
    return Pose(np.array([draw(lengths) for _ in range(3)]), rotation)


def matrix_of_quaternion(q):
    x, y, z, w = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


@given(poses())
def test_the_quaternion_is_the_same_rotation(pose):
    q = pose.quaternion_xyzw
    assert np.linalg.norm(q) == pytest.approx(1)
    assert q[3] >= 0
    np.testing.assert_allclose(matrix_of_quaternion(q), pose.rotation, atol=1e-9)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1)])
def test_the_quaternion_of_a_half_turn(axis):
    rotation = 2 * np.outer(axis, axis) - np.eye(3)
    quaternion = Pose(np.zeros(3), rotation).quaternion_xyzw
    np.testing.assert_allclose(np.abs(quaternion), [*axis, 0], atol=1e-12)


@given(poses())
def test_transforms_invert_each_other(pose):
    np.testing.assert_allclose(pose.T_pad_camera @ pose.T_camera_pad, np.eye(4), atol=1e-8)


@given(poses())
def test_a_solvers_answer_gives_the_pose_back(pose):
    rotation = np.asarray(cv2.Rodrigues(pose.rvec)[0], float)
    back = Pose.from_T_camera_pad(rotation, pose.tvec_mm.reshape(3, 1))
    # OpenCV's Rodrigues takes turns of less than about 1e-7 for none.
    reach_mm = 1 + np.linalg.norm(pose.position_mm)
    np.testing.assert_allclose(back.position_mm, pose.position_mm, atol=1e-6 * reach_mm)
    np.testing.assert_allclose(back.rotation, pose.rotation, atol=1e-6)


@given(poses())
def test_euler_angles_compose_to_the_rotation(pose):
    roll, pitch, yaw = map(math.radians, pose.euler_deg)
    about = np.eye(3)
    for angle, axis in ((yaw, (0, 0, 1)), (pitch, (0, 1, 0)), (roll, (1, 0, 0))):
        about = about @ np.asarray(cv2.Rodrigues(angle * np.array(axis, float))[0], float)
    np.testing.assert_allclose(about, pose.rotation, atol=1e-7)


@given(st.floats(0, 359.9), st.floats(10, 20_000))
def test_heading_of_a_camera_that_looks_straight_down(heading_deg, height_mm):
    pose = look_at_pad(height_mm, heading_deg=heading_deg)
    difference = (pose.heading_deg - heading_deg + 180) % 360 - 180
    assert difference == pytest.approx(0, abs=1e-6)
    assert pose.tilt_deg == pytest.approx(0, abs=1e-6)
    np.testing.assert_allclose(pose.position_mm, [0, 0, height_mm], atol=1e-9)


@given(st.floats(0, 80), st.floats(0, 360), st.floats(0, 360), lengths, lengths)
def test_the_axis_of_a_tilted_camera_meets_its_target(tilt_deg, lean_deg, heading_deg, x_mm, y_mm):
    pose = look_at_pad(
        1000,
        tilt_deg=tilt_deg,
        tilt_towards_deg=lean_deg,
        heading_deg=heading_deg,
        target_mm=(x_mm, y_mm),
    )
    assert pose.tilt_deg == pytest.approx(tilt_deg, abs=1e-5)
    assert pose.position_mm[2] == pytest.approx(1000)
    along = pose.T_camera_pad @ [x_mm, y_mm, 0, 1]
    np.testing.assert_allclose(along[:2], 0, atol=1e-6)
    assert along[2] > 0


def test_a_camera_that_leans_north_looks_north():
    forward = look_at_pad(1000, tilt_deg=30, tilt_towards_deg=0).rotation[:, 2]
    np.testing.assert_allclose(forward, [0, 0.5, -math.sqrt(0.75)], atol=1e-12)
    forward = look_at_pad(1000, tilt_deg=30, tilt_towards_deg=90).rotation[:, 2]
    np.testing.assert_allclose(forward, [0.5, 0, -math.sqrt(0.75)], atol=1e-12)


def test_image_up_and_right_without_heading_are_the_pads_y_and_x():
    rotation = look_at_pad(1000).rotation
    np.testing.assert_allclose(rotation @ [1, 0, 0], [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(rotation @ [0, -1, 0], [0, 1, 0], atol=1e-12)


@given(poses(), st.floats(0.01, math.pi - 0.01))
def test_the_angle_between_rotations(pose, angle):
    turned = pose.rotation @ np.asarray(cv2.Rodrigues(np.array([0.6, 0, 0.8]) * angle)[0], float)
    assert rotation_angle_deg(pose.rotation, turned) == pytest.approx(math.degrees(angle), abs=1e-5)


@given(
    angle=st.floats(1e-12, 3.14),
    axis=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1),
)
def test_rotation_vectors_and_rotations_are_one_to_one(angle, axis):
    vector = angle * np.array(axis) / np.linalg.norm(axis)
    back = vector_from_rotation(rotation_from_vector(vector))
    np.testing.assert_allclose(back, vector, rtol=1e-5, atol=1e-15)
