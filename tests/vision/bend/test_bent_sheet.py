"""Whether a sheet is bent, and what becomes of its pose."""

from dataclasses import replace

import pytest
from dense_frames import errors, sample_pad, small_camera

from padstudio import Detector
from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.lay.relief import Relief, Wave
from padstudio.simulate.lay.tiles import Tiles
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging

POSE = look_at_pad(450.0, tilt_deg=18, heading_deg=40, tilt_towards_deg=150)
WAVES = Relief((Wave(amplitude_mm=5.0, length_mm=420.0, toward_deg=30.0),))


def detection(lay):
    camera, pad = small_camera(), sample_pad()
    imaging = replace(Imaging(), exposure_ms=0.0)
    frame = render(Scene(pad=pad, lay=lay), camera, POSE, imaging, seed=3)
    return Detector(pad, camera).detect(frame.image)


def test_the_pose_of_waving_paper_is_found_with_its_heights():
    found = detection(WAVES)
    assert found.flatness_mm == pytest.approx(10.0, abs=3.0)
    assert errors(found.pose, POSE)[0] < 0.005 * 450
    assert found.reprojection_px < 0.35


def test_a_flat_sheet_is_not_bent():
    found = detection(None)
    assert found.flatness_mm is None
    assert errors(found.pose, POSE)[0] < 0.0005 * 450


def test_a_print_of_many_sheets_is_not_bent():
    assert detection(Tiles(columns=5, rows=5, offset_mm=2.0, turn_deg=0.3)).flatness_mm is None
