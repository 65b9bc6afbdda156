import json

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from plain_texts import plain_texts

from padstudio import Camera
from padstudio.errors import CameraFormatError
from padstudio.geometry import presets

K = np.array([[880.5, 0, 652.3], [0, 881.25, 471.8], [0, 0, 1]])
D = np.array([-0.28, 0.09, 0.0006, -0.0004, -0.01])

ROS = """\
image_width: 1280
image_height: 960
camera_name: nadir
camera_matrix:
  rows: 3
  cols: 3
  data: [880.5, 0., 652.3, 0., 881.25, 471.8, 0., 0., 1.]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.28, 0.09, 6e-4, -0.0004, -0.01]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
"""
KALIBR = """\
cam0:
  cam_overlaps: []
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.09, 0.0006, -0.0004]
  distortion_model: radtan
  intrinsics: [880.5, 881.25, 652.3, 471.8]
  resolution: [1280, 960]
  rostopic: /nadir/image_raw
"""
PHOTONVISION = {
    "resolution": {"width": 1280.0, "height": 960.0},
    "cameraIntrinsics": {"rows": 3, "cols": 3, "type": 6, "data": K.ravel().tolist()},
    "distCoeffs": {"rows": 1, "cols": 5, "type": 6, "data": D.tolist()},
    "calobjectWarp": [],
    "observations": [{"snapshotName": "a.png", "locationInImageSpace": [{"x": 1, "y": 2}]}],
    "lensmodel": "LENSMODEL_OPENCV",
}


def opencv_file(path, **values):
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for key, value in values.items():
        storage.write(key, value)
    storage.release()
    return path


def assert_is_the_camera(camera, coefficients=D):
    assert (camera.width, camera.height, camera.model) == (1280, 960, "radtan")
    np.testing.assert_allclose(camera.matrix, K)
    np.testing.assert_allclose(camera.distortion, coefficients)
    assert not camera.nominal


def test_ros():
    camera = Camera.loads(ROS)
    assert_is_the_camera(camera)
    assert camera.name == "nadir"


def test_kalibr():
    camera = Camera.loads(KALIBR)
    assert_is_the_camera(camera, D[:4])
    assert camera.name == "/nadir/image_raw"


def test_kalibr_fisheye():
    text = KALIBR.replace("radtan", "equidistant")
    assert Camera.loads(text).model == "fisheye"


def test_photonvision():
    camera = Camera.loads(json.dumps(PHOTONVISION), "photon_1280x960.json")
    assert_is_the_camera(camera)
    assert camera.name == "photon_1280x960"


def test_photonvision_of_before_2024():
    old = {key: value for key, value in PHOTONVISION.items() if key != "lensmodel"}
    old["cameraExtrinsics"] = old.pop("distCoeffs")
    assert_is_the_camera(Camera.loads(json.dumps(old)))


@pytest.mark.parametrize("ending", ["yaml", "yml", "json"])
def test_opencv_as_opencv_writes_it(tmp_path, ending):
    path = opencv_file(
        tmp_path / f"calibration.{ending}",
        image_width=1280,
        image_height=960,
        camera_matrix=K,
        distortion_coefficients=D.reshape(-1, 1),
        flags=4,
    )
    camera = Camera.load(path)
    assert_is_the_camera(camera)
    assert camera.name == "calibration"


def test_opencv_with_other_spellings(tmp_path):
    path = opencv_file(
        tmp_path / "c.yml", image_Width=1280, image_Height=960, cameraMatrix=K, dist_coeffs=D
    )
    assert_is_the_camera(Camera.load(path))


def test_opencv_with_a_size_in_one(tmp_path):
    path = opencv_file(tmp_path / "c.yml", imageSize=np.array([[1280, 960]]), K=K, D=D)
    assert_is_the_camera(Camera.load(path))


def test_opencv_fisheye(tmp_path):
    path = opencv_file(
        tmp_path / "c.yml",
        fisheye_model=1,
        image_width=1280,
        image_height=960,
        camera_matrix=K,
        distortion_coefficients=D[:4],
    )
    assert Camera.load(path).model == "fisheye"


def test_fourteen_coefficients_of_which_eight_are_used(tmp_path):
    long = np.concatenate([D, [0.1, 0.2, 0.3], np.zeros(6)])
    text = ROS.replace("cols: 5", "cols: 14")
    text = text.replace("[-0.28, 0.09, 6e-4, -0.0004, -0.01]", str(long.tolist()))
    assert len(Camera.loads(text).distortion) == 8
    with pytest.raises(CameraFormatError, match="thin prism or a tilt"):
        Camera.loads(text.replace("0.3, 0.0, 0.0", "0.3, 0.0, 0.001"))


def test_without_distortion_only_where_the_file_or_the_user_says_so():
    silent = ROS[: ROS.index("distortion_model")]
    with pytest.raises(CameraFormatError, match="--no-distortion on the command line") as refused:
        Camera.loads(silent)
    assert refused.value.error_code == "distortion_not_said"
    assert not Camera.loads(silent, no_distortion=True).distorted
    assert not Camera.loads(silent + "distortion_model: none\n").distorted
    assert not Camera.loads(silent + "distortion_coefficients: []\n").distorted
    assert not Camera.loads(silent + "D: [0, 0, 0, 0, 0]\n").distorted
    with pytest.raises(CameraFormatError, match="names a fisheye and holds none"):
        Camera.loads(silent + "distortion_model: equidistant\n", no_distortion=True)
    with pytest.raises(CameraFormatError, match="and you say there is none"):
        Camera.loads(ROS, no_distortion=True)


@given(
    st.sampled_from([("radtan", 0), ("radtan", 4), ("radtan", 5), ("radtan", 8), ("fisheye", 4)]),
    st.lists(st.floats(-1, 1), min_size=8, max_size=8),
    st.floats(1e-3, 1e6),
    plain_texts(30),
    st.booleans(),
    st.none() | st.floats(0, 1000),
)
def test_what_is_written_is_read_back(lens, coefficients, focal_px, name, nominal, readout_ms):
    model, count = lens
    matrix = K.copy()
    matrix[0, 0] = focal_px
    camera = Camera(
        1280, 960, matrix, coefficients[:count], model, name, nominal, readout_ms=readout_ms
    )
    back = Camera.loads(camera.to_ros_yaml())
    assert (back.width, back.height, back.model) == (1280, 960, model)
    assert (back.name, back.nominal, back.readout_ms) == (name, nominal, readout_ms)
    np.testing.assert_array_equal(back.matrix, matrix)
    np.testing.assert_array_equal(back.distortion[:count], camera.distortion)
    assert not back.distortion[count:].any()


@pytest.mark.parametrize(
    "text",
    [
        ROS + "readout_ms: 12.5\n",
        KALIBR + "  readout_ms: 12.5\n",
        json.dumps({**PHOTONVISION, "readout_ms": 12.5}),
    ],
)
def test_every_kind_may_say_how_long_the_shutter_rolls(text):
    assert Camera.loads(text).readout_ms == 12.5
    assert Camera.loads(text).for_frame(640, 480).readout_ms == 12.5
    assert Camera.loads(text.replace("12.5", "0")).readout_ms == 0
    with pytest.raises(CameraFormatError, match="readout_ms"):
        Camera.loads(text.replace("12.5", "-3"))


def test_save_and_load(tmp_path):
    camera = Camera.loads(ROS)
    camera.save(tmp_path / "camera.yaml")
    assert_is_the_camera(Camera.load(tmp_path / "camera.yaml"))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "c.yaml: holds no keys and values"),
        ("just words", "c.yaml: holds no keys and values"),
        ("[1, 2]", "c.yaml: holds no keys and values"),
        ("a: 1", "c.yaml: has neither camera_matrix"),
        ('{"format": "padstudio.pad", "layers": []}', "c.yaml: is a pad file; give it as the pad"),
        (ROS.replace("image_width: 1280\n", ""), "has no image_width and image_height"),
        (ROS.replace("1280", "0"), r"the image size is \[0, 960\]"),
        (ROS.replace("1280", "99999999"), "the image size is"),
        (ROS.replace("1280", "1280.5"), "the image size is"),
        (ROS.replace("1280", "wide"), "image size holds something that is no finite number"),
        (ROS.replace("1280", "640"), r"principal point \(652.3, 471.8\) lies outside"),
        (ROS.replace("880.5, 0.", "880.5, 3."), "has skew"),
        (ROS.replace("471.8, ", ""), "camera_matrix has 8 numbers and says 3 x 3"),
        (ROS.replace("471.8", ".nan"), "camera_matrix holds something that is no finite number"),
        (ROS.replace("471.8", "true"), "camera_matrix holds something that is no finite number"),
        (ROS.replace("880.5", "-880.5"), "positive focal lengths"),
        (ROS.replace(", -0.01]", "]").replace("6e-4, ", ""), "has 3 numbers and says 1 x 5"),
        (ROS.replace("plumb_bob", "thin_prism"), "distortion_model is 'thin_prism', a lens"),
        (ROS.replace("plumb_bob", "equidistant"), "fisheye takes 4 distortion"),
        (KALIBR.replace("pinhole", "omni"), "camera_model is 'omni'"),
        (KALIBR + KALIBR.replace("cam0", "cam1"), r"holds 2 cameras \(cam0, cam1\)"),
        (KALIBR.replace("[880.5, ", "["), "intrinsics has 3 numbers"),
        (KALIBR.replace("  resolution: [1280, 960]\n", ""), "image size is missing"),
        ("cam0: 5", "cam0 holds no keys and values"),
        (
            json.dumps(PHOTONVISION | {"lensmodel": "LENSMODEL_STEREOGRAPHIC"}),
            "lensmodel is 'LENSMODEL_STEREOGRAPHIC'",
        ),
        (json.dumps(PHOTONVISION | {"resolution": None}), "image size is missing"),
        (json.dumps(PHOTONVISION | {"cameraIntrinsics": 7}), "cameraIntrinsics is missing"),
    ],
)
def test_what_is_no_camera_is_refused_by_name(content, message):
    with pytest.raises(CameraFormatError, match=message):
        Camera.loads(content, "c.yaml")


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(CameraFormatError, match=r"cannot read gone.yaml: No such file"):
        Camera.load(tmp_path / "gone.yaml")


@given(st.binary(max_size=300))
def test_bytes_that_are_no_camera_raise_nothing_else(data):
    with pytest.raises(CameraFormatError, match=r"^camera file: "):
        Camera.loads(data)


@pytest.mark.parametrize("preset", presets.PRESETS.values(), ids=presets.PRESETS)
def test_presets_are_written_as_nominal(preset):
    back = Camera.loads(preset.camera.to_ros_yaml())
    assert back.nominal
    assert back.name == preset.camera.name
