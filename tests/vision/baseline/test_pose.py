"""The larger window, and its four corners' pose."""

from dataclasses import replace

import numpy as np
import pytest
from paper_frames import errors, frame_of, paper_camera, sample_pad

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.baseline.decode import WindowRead
from padstudio.vision.baseline.pose import WindowPose, choose_larger, window_pose
from padstudio.vision.detector import Detector
from padstudio.vision.stage.params import PaperParams
from padstudio.vision.stage.trace import Reason, StageFailure

POSE = look_at_pad(450.0, tilt_deg=25, heading_deg=70, tilt_towards_deg=10)


@pytest.fixture(scope="module")
def read():
    detector = Detector(sample_pad(), paper_camera(), method="paper")
    trace = detector.detect(frame_of(POSE), trace=True).trace
    output = trace.get("choose").output.read
    assert isinstance(output, WindowRead)
    return output


def test_the_pose_is_the_true_one_and_says_how_sure_it_is(read):
    found = window_pose(sample_pad(), paper_camera(), read, PaperParams())
    assert isinstance(found, WindowPose)
    position, attitude = errors(found.pose, POSE)
    assert position < 0.5
    assert attitude < 0.25
    sigma = np.sqrt(np.diag(found.covariance)[:3])
    off = np.abs(found.pose.position_mm - POSE.position_mm)
    assert (off < 5 * sigma).all()
    assert found.rms_px < 1.0


def test_the_larger_window_wins(read):
    small = replace(read, window=replace(read.window, area_px=read.window.area_px / 2))
    assert choose_larger([small, read]).read is read
    assert choose_larger([read, small]).read is read
    assert choose_larger([small, read]).reads == (small, read)


def test_a_pose_less_sure_than_asked_for_is_refused(read):
    strict = PaperParams(most_position_share=1e-7)
    found = window_pose(sample_pad(), paper_camera(), read, strict)
    assert isinstance(found, StageFailure)
    assert found.reason is Reason.CELLS_TOO_SMALL
    assert found.stage == "pose"


def test_corners_that_do_not_carry_the_lattice_are_refused(read):
    bent = read.window.corners_xy + np.array([[60.0, 0], [0, 0], [0, 60.0], [0, 0]])
    wrong = replace(read, window=replace(read.window, corners_xy=bent))
    found = window_pose(sample_pad(), paper_camera(), wrong, PaperParams(most_position_share=1.0))
    assert isinstance(found, StageFailure)
    assert found.reason in (Reason.POSE_REJECTED, Reason.CELLS_TOO_SMALL)
