"""Prints of sheets that lie off their places, and what becomes of their pose."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from dense_frames import sample_pad, small_camera

from padstudio import Detector
from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.lay.tiles import Tiles
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging

POSE = look_at_pad(450.0, tilt_deg=18, heading_deg=40, tilt_towards_deg=150)


@pytest.mark.parametrize(
    "tiles",
    [
        Tiles(columns=5, rows=5, gap_mm=1.5, offset_mm=1.0, turn_deg=0.2, seed=2),
        Tiles(columns=5, rows=4, gap_mm=0.5, offset_mm=1.0, turn_deg=0.5, seed=3),
    ],
    ids=["gaps", "turned"],
)
def test_a_print_of_many_sheets_has_the_pose_of_its_sheets(tiles):
    camera, pad = small_camera(), sample_pad()
    imaging = replace(Imaging(), exposure_ms=0.0)
    frame = render(Scene(pad=pad, lay=tiles), camera, POSE, imaging, seed=3)
    found = Detector(pad, camera).detect(frame.image)
    assert found.flatness_mm is None
    truths = [frame.truth.pose, *frame.truth.also_true]
    away = [np.linalg.norm(found.pose.position_mm - truth.position_mm) for truth in truths]
    assert min(away) < 0.004 * 450
    normalized = []
    for truth in truths:
        turn = cv2.Rodrigues(found.pose.rotation.T @ truth.rotation)[0].ravel()
        error = np.concatenate([truth.position_mm - found.pose.position_mm, turn])
        normalized.append(error @ np.linalg.solve(found.uncertainty.covariance, error) / 6)
    assert min(normalized) < 4
