"""Every key is known, known to be harmless, or refused; the documents list them."""

import re

import pytest
from places import DOCS

from padstudio import Camera
from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.forms import (
    colmap,
    kalibr,
    mrcal,
    opencv,
    opensfm,
    photonvision,
)
from padstudio.geometry.camera_files.parts import keys, lenses

CAMERA = """\
image_width: 640
image_height: 480
camera_matrix: [500, 0, 320, 0, 500, 240, 0, 0, 1]
distortion_coefficients: [0.1, -0.2, 0.001, 0.002, 0.05]
"""


@pytest.mark.parametrize(
    "line",
    [
        "calibration_time: 'Mon 3 Feb 2025'",
        "notes: taken at dusk",
        "whatever: a text",
        "operator_2: Bob",
        "serial_number: 4711",
        "avg_reprojection_error: 0.3",
        "per_view_reprojection_errors: [0.1, 0.2]",
        "dist_coeffs_std_dev: [0.1, 0.2, 0.3, 0.4, 0.5]",
        "std_deviations_intrinsics: [1, 2]",
        "intrinsics_covariance: [[1, 2], [3, 4]]",
        "square_size: 25.0",
        "board_width: 9",
        "flags: 4",
        "new_camera_matrix: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
        "projection_matrix: {rows: 3, cols: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}",
        "P: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]",
        "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]",
        "T_cam_imu: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
        "hfov: 65.2",
        "ret: 0.3",
        "empty: ~",
        "device_model: Mavic 2",
    ],
)
def test_what_says_nothing_of_the_lens_is_passed_over(line):
    plain = Camera.loads(CAMERA)
    assert Camera.loads(CAMERA + line).distortion.tolist() == plain.distortion.tolist()


@pytest.mark.parametrize(
    "line",
    [
        "xi: 1.2",
        "alpha: 0.5",
        "k4: 0.1",
        "k_7: 0.1",
        "p1: 0.001",
        "p: 0.001",
        "thin_prism: [0.1, 0.2]",
        "tau_x: 0.1",
        "distortion_center: [1, 2]",
        "undistorted: false",
        "optics: equidistant",
        "camera: fisheye",
        "lens_name: omni",
        "projection: stereographic",
        "warp: 0.1",
        "warp_text: '0.1, 0.2'",
        "number: '1e-3'",
        "polynomial: [1, 2, 3]",
        "lens: {k1: 0.1}",
        "wide_angle: true",
        "flip: horizontal",
        "is_rectified: yes",
        "camera_name_2: [1, 2]",
    ],
)
def test_what_could_be_a_part_of_the_lens_is_refused_by_name(line):
    key = line.split(":")[0]
    with pytest.raises(CameraFormatError, match=rf"c: the key '{key}' is not known and could hold"):
        Camera.loads(CAMERA + line, "c")


def _told(text):
    outside = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    return {keys.plain(each) for each in re.findall(r"`([^`\n]+)`", outside)}


def test_the_documents_list_every_key_form_and_name():
    page = (DOCS / "camera-files.md").read_text(encoding="utf-8")
    told = _told(page)
    parameters = {name for row in opensfm.MODELS.values() for name in row.split()}
    for names in (
        opencv.KEYS,
        kalibr.KEYS,
        photonvision.KEYS,
        map(keys.plain, (*colmap.MODELS, *opensfm.MODELS)),
        map(keys.plain, parameters - {"k2", "k3"}),
        (lenses.RADTAN_NAMES | lenses.FISHEYE_NAMES | lenses.NONE_NAMES | lenses.PINHOLE_NAMES),
    ):
        assert sorted(set(names) - told) == []
    for model in mrcal.MODELS:
        assert model in page or f"…{model.removeprefix('LENSMODEL_OPENCV')}" in page
