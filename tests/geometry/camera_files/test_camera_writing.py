"""What is written is read: by the programs whose form it is, and by ours as the same lens."""

import cv2
import numpy as np
import pytest
import yaml
from camera_forms import RAYS, cameras, pixels
from hypothesis import given
from hypothesis import strategies as st
from plain_texts import plain_texts

from padstudio import Camera
from padstudio.errors import CameraFormatError


def camera_of(truth, name="front"):
    model = "fisheye" if truth.fisheye else "radtan"
    return Camera(truth.width, truth.height, truth.matrix, truth.distortion, model, name)


@given(cameras(), st.sampled_from(["ros", "opencv", "colmap"]), plain_texts(20))
def test_a_camera_comes_back_from_every_form(truth, form, name):
    text = camera_of(truth, name).to_form(form)
    np.testing.assert_allclose(Camera.loads(text).project(RAYS), pixels(truth), rtol=0, atol=1e-6)


@given(cameras((0, 4, 5)))
def test_kalibr_has_four_coefficients_or_the_lens_is_refused(truth):
    camera = camera_of(truth)
    if camera.model == "radtan" and camera.distortion[4:].any():
        with pytest.raises(CameraFormatError, match="Kalibr's radtan has four"):
            camera.to_form("kalibr")
        return
    text = camera.to_form("kalibr")
    np.testing.assert_allclose(Camera.loads(text).project(RAYS), pixels(truth), rtol=0, atol=1e-6)
    chain = yaml.safe_load(text)["cam0"]
    assert chain["intrinsics"] == [truth.fx, truth.fy, truth.cx, truth.cy]
    counts = {"none": 0, "radtan": 4, "equidistant": 4}
    assert len(chain["distortion_coeffs"]) == counts[chain["distortion_model"]]


@given(cameras(), plain_texts(20))
def test_opencv_reads_its_form(truth, name):
    text = camera_of(truth, name).to_form("opencv")
    storage = cv2.FileStorage(text, cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY)
    np.testing.assert_array_equal(storage.getNode("camera_matrix").mat(), truth.matrix)
    read = storage.getNode("distortion_coefficients").mat().ravel()
    count = len(truth.distortion)
    np.testing.assert_array_equal(read[:count], truth.distortion)
    assert not read[count:].any()
    assert storage.getNode("image_width").real() == truth.width
    assert storage.getNode("fisheye_model").real() == truth.fisheye
    storage.release()


def test_readout_and_nominal_are_kept():
    matrix = np.array([[50.0, 0, 31.5], [0, 50, 23.5], [0, 0, 1]])
    camera = Camera(64, 48, matrix, nominal=True, readout_ms=12.5)
    for form in ("ros", "opencv"):
        back = Camera.loads(camera.to_form(form))
        assert (back.nominal, back.readout_ms) == (True, 12.5)
    assert Camera.loads(camera.to_form("kalibr")).readout_ms == 12.5
    with pytest.raises(CameraFormatError, match="not written as 'bmp'; take ros, opencv"):
        camera.to_form("bmp")
