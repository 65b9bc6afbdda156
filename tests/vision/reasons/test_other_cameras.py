"""Cameras that are tried: each differs from the one given in one thing, and says in which."""

import numpy as np
from reason_causes import CAMERAS

from padstudio.vision.reasons.other_cameras import other_cameras, wrong_camera


def test_each_differs_in_one_thing():
    camera = CAMERAS["vga"]
    for other in other_cameras(camera):
        bends = other.camera.distortion[: len(camera.distortion)]
        same_lens = np.array_equal(bends, camera.distortion)
        same_matrix = np.array_equal(other.camera.matrix, camera.matrix)
        assert same_lens != same_matrix
        assert other.words.startswith("with ")


def test_the_finding_says_what_to_do():
    found = wrong_camera("it is read with 2 times the focal length")
    assert found.detail.endswith("2 times the focal length")
    assert "calibrate" in found.advice
