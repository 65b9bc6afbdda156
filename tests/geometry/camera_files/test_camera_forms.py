"""Each form's own rules: which lens, which of several cameras, what is refused."""

import json

import cv2
import numpy as np
import pytest
from camera_forms import (
    RAYS,
    TrueCamera,
    agisoft,
    colmap,
    kalibr,
    mrcal,
    opencv,
    opensfm,
    orbslam,
    photonvision,
    pixels,
    ros,
    ros_message,
    script,
)
from camera_forms import as_yaml as dump

from padstudio import Camera
from padstudio.errors import CameraFormatError

RADTAN = TrueCamera(1920, 1080, 1402.5, 1400.1, 955.2, 541.7, (-0.27, 0.09, 7e-4, -4e-4), False)
FIVE = RADTAN._replace(distortion=(-0.2714, 0.0932, 7e-4, -4e-4, -0.0178))
FISHEYE = RADTAN._replace(distortion=(-0.0312, 0.0087, -0.0041, 0.0006), fisheye=True)


def assert_is(camera, truth):
    kind = "fisheye" if truth.fisheye else "radtan"
    assert (camera.width, camera.height, camera.model) == (truth.width, truth.height, kind)
    np.testing.assert_allclose(camera.project(RAYS), pixels(truth), rtol=0, atol=1e-6)


def refusal(text, **said):
    with pytest.raises(CameraFormatError) as refused:
        Camera.loads(text, "c", **said)
    return refused.value


# Names and counts of lenses


@pytest.mark.parametrize(
    ("change", "truth"),
    [
        ({"distortion_model": "Plumb Bob"}, FIVE),
        ({"distortion_model": ""}, FIVE),
        ({"distortion_model": "pinhole"}, FIVE),
        ({"distortion_model": None, "camera_model": "fisheye"}, FISHEYE),
        ({"distortion_model": None, "model": "equidistant"}, FISHEYE),
        ({"distortion_model": None, "fisheye": "true"}, FISHEYE),
        ({"camera_model": "pinhole"}, FISHEYE),
        ({"distortion_model": "kannala_brandt"}, FISHEYE),
        ({"distortion_model": None, "fisheye": False}, RADTAN),
    ],
)
def test_names_of_lenses(change, truth):
    assert_is(Camera.loads(dump(ros(truth) | change)), truth)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (ros(RADTAN) | {"distortion_model": None}, "may be k1 k2 p1 p2 or a fisheye's"),
        (ros(FISHEYE) | {"fisheye": False}, "contradict each other"),
        (ros(FIVE) | {"fisheye": True}, "contradict each other"),
        (ros(FIVE) | {"model": "equidistant"}, "contradict each other"),
        (ros(FIVE) | {"distortion_model": "none"}, "names no lens model, and holds coeff"),
        (ros(FIVE) | {"distortion_model": "brown_conrady"}, "not read"),
        (ros(FIVE) | {"D": [0.1, 0, 0, 0, 0]}, "distortion_coefficients and D contradict"),
        (ros(FIVE) | {"K": [1, 0, 1, 0, 1, 1, 0, 0, 1]}, "camera_matrix and K contradict"),
        (ros(FIVE) | {"resolution": [10, 10]}, "sizes of the picture contradict"),
        (ros(FIVE) | {"fx": 3}, "has fx alone"),
        (ros(FIVE) | {"skew": 0.5}, "has skew"),
        (ros(FIVE) | {"fisheye": "maybe"}, "fisheye is neither true nor false"),
        (ros(FIVE) | {"camera_matrix": [0.7, 0, 0.5, 0, 1.2, 0.5, 0, 0, 1]}, "in a corner"),
        # Millimetres, and from the middle of the picture.
        (ros(FIVE) | {"camera_matrix": [4.5, 0, 3.2, 0, 4.5, 2.4, 0, 0, 1]}, "in a corner"),
        (ros(FIVE) | {"camera_matrix": [1402, 0, 4.8, 0, 1400, 1.7, 0, 0, 1]}, "in a corner"),
        (ros(FIVE) | {"distortion_coefficients": ""}, "no finite number"),
        (ros(FIVE) | {"distortion_coefficients": "-0,27 0,09 0,0007 -0,0004"}, "decimal commas"),
        (script(FIVE) | {"dist": [[0.1, 0.2]]}, "takes 4, 5 or 8"),
        (script(FIVE) | {"img_size": {"width": 3, "depth": 4}}, "give width, height"),
    ],
)
def test_what_contradicts_itself_is_refused(values, message):
    assert message in refusal(dump(values)).message


@pytest.mark.parametrize("truth", [FISHEYE, RADTAN._replace(distortion=(0.01,) * 8)])
def test_old_ros_says_five_coefficients_whatever_there_are(truth):
    values = ros(truth)
    values["distortion_coefficients"]["cols"] = 5
    assert_is(Camera.loads(dump(values)), truth)


def test_numbers_as_programs_write_them():
    text = dump(ros(FIVE))
    flat = ", ".join(map(repr, FIVE.distortion))
    for written in (f"[{flat}]", f"[{flat.replace(',', '')}]", f"'({flat})'", f"[[{flat}]]"):
        start = text.index("distortion_coefficients:")
        changed = text[:start] + f"D: {written}\n"
        assert_is(Camera.loads(changed), FIVE)
    single = {key: getattr(FIVE, key) for key in ("fx", "fy", "cx", "cy")}
    assert_is(Camera.loads(json.dumps(script(FIVE) | {"mtx": single})), FIVE)
    without = {key: value for key, value in script(FIVE).items() if key != "mtx"}
    assert_is(Camera.loads(json.dumps(without | single)), FIVE)


# ROS messages


def test_a_region_of_interest_is_applied():
    roi = {"x_offset": 480, "y_offset": 270, "height": 540, "width": 960, "do_rectify": True}
    camera = Camera.loads(dump(ros_message(FIVE) | {"roi": roi}))
    assert (camera.width, camera.height) == (960, 540)
    np.testing.assert_allclose(camera.project(RAYS), pixels(FIVE) - (480, 270), atol=1e-9)
    assert camera.notes == (
        "region of interest 960 x 540 applied: the camera is of frames of 960 x 540 px",
    )


def test_binning_takes_pixels_together():
    roi = {"x_offset": 100, "y_offset": 50, "height": 900, "width": 1500}
    values = ros_message(FIVE) | {"roi": roi, "binning_x": 2, "binning_y": 3}
    camera = Camera.loads(dump(values))
    assert (camera.width, camera.height) == (750, 300)
    # Pixel 0 of the binned picture is as wide as b pixels, and their mean is at (b - 1) / 2.
    binned = (pixels(FIVE) - (100, 50) - (0.5, 1.0)) / (2, 3)
    np.testing.assert_allclose(camera.project(RAYS), binned, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"roi": {"x_offset": 1900, "width": 100, "height": 100}}, "does not lie in the picture"),
        ({"roi": {"width": 100, "height": 0}}, "give all four, or 0"),
        ({"roi": {"x_offset": 5}}, "give all four, or 0"),
        ({"roi": [0, 0, 100, 100]}, "its roi is not x_offset"),
        ({"roi": {"width": 100, "height": 100}}, "leaves out the lens's centre"),
        ({"roi": {"x_offset": 0.5, "width": 100, "height": 100}}, "a whole number of pixels"),
        ({"binning_x": -1}, "a whole number of pixels"),
        ({"binning_x": 5000}, "into none"),
    ],
)
def test_windows_that_cannot_be_are_refused(change, message):
    assert message in refusal(dump(ros_message(FIVE) | change)).message


def test_the_first_message_of_an_echo_is_read():
    text = dump(ros_message(FIVE))
    other = dump(ros_message(RADTAN))
    assert_is(Camera.loads(f"{text}---\n{other}---\n"), FIVE)


# Kalibr, PhotonVision


def test_kalibrs_lens_is_named_or_refused():
    values = kalibr(FISHEYE)
    assert_is(Camera.loads(dump(values)), FISHEYE)
    for key, message in (
        ("distortion_model", "has no distortion_model"),
        ("distortion_coeffs", "has 0 distortion_coeffs, not 4"),
        ("camera_model", "has no camera_model"),
        ("resolution", "image size is missing"),
    ):
        less = {"cam0": {k: v for k, v in values["cam0"].items() if k != key}}
        assert message in refusal(dump(less)).message
    none = {"distortion_model": "none", "distortion_coeffs": []}
    assert not Camera.loads(dump({"cam0": values["cam0"] | none})).distorted
    five = values["cam0"] | {"distortion_coeffs": [0.0] * 5, "distortion_model": "radtan"}
    assert "has 5 distortion_coeffs, not 4" in refusal(dump({"cam0": five})).message


def test_a_camera_of_a_chain_is_chosen():
    chain = {**kalibr(RADTAN), "cam1": kalibr(FISHEYE)["cam0"]}
    refused = refusal(dump(chain))
    assert (refused.error_code, refused.detail) == (
        "several_cameras",
        {"cameras": ["cam0", "cam1"]},
    )
    assert_is(Camera.loads(dump(chain), which="cam1"), FISHEYE)
    assert (
        "holds no camera 'cam2'; it holds cam0, cam1" in refusal(dump(chain), which="cam2").message
    )
    assert "holds one camera" in refusal(dump(ros(FIVE)), which="1").message


def test_photonvisions_snapshots_are_passed_over():
    picture = {"snapshotData": "A" * 9_000_000, "snapshotName": "a.png"}
    text = json.dumps(photonvision(FIVE) | {"observations": [picture]})
    assert_is(Camera.loads(text), FIVE)
    values = photonvision(FIVE) | {"lensmodel": "LENSMODEL_OPENCV8"}
    assert "LENSMODEL_OPENCV8 has 5 distCoeffs" in refusal(json.dumps(values)).message


# COLMAP, OpenSfM, Metashape, mrcal, ORB-SLAM


@pytest.mark.parametrize(
    ("line", "truth"),
    [
        ("SIMPLE_PINHOLE 640 480 500 320.5 240.5", (500, 500, (0,) * 4, False)),
        ("PINHOLE 640 480 500 501 320.5 240.5", (500, 501, (0,) * 4, False)),
        ("SIMPLE_RADIAL 640 480 500 320.5 240.5 0.1", (500, 500, (0.1, 0, 0, 0), False)),
        ("RADIAL 640 480 500 320.5 240.5 0.1 -0.2", (500, 500, (0.1, -0.2, 0, 0), False)),
        ("SIMPLE_RADIAL_FISHEYE 640 480 500 320.5 240.5 0.1", (500, 500, (0.1, 0, 0, 0), True)),
        ("RADIAL_FISHEYE 640 480 500 320.5 240.5 0.1 -0.2", (500, 500, (0.1, -0.2, 0, 0), True)),
    ],
)
def test_colmaps_smaller_models(line, truth):
    fx, fy, distortion, fisheye = truth
    camera = Camera.loads(f"# Camera list\n7 {line}\n", "cameras.txt")
    assert_is(camera, TrueCamera(640, 480, fx, fy, 320, 240, distortion, fisheye))
    assert camera.name == "cameras"


def test_colmaps_cameras_are_chosen_by_number():
    text = colmap(RADTAN) + colmap(FISHEYE).replace("\n1 ", "\n2 ")
    assert refusal(text).error_code == "several_cameras"
    camera = Camera.loads(text, "cameras.txt", which="2")
    assert_is(camera, FISHEYE)
    assert camera.name == "cameras 2"
    assert "stands twice" in refusal(colmap(RADTAN) * 2).message
    assert "the model FOV, which is not" in refusal("1 FOV 640 480 500 500 320 240 0.9").message
    assert "takes width, height and fx" in refusal("1 PINHOLE 640 480 500 500 320").message


def test_opensfms_models():
    base = {"width": 4000, "height": 2250}
    perspective = {"projection_type": "perspective", **base, "focal": 0.81, "k1": 0.02, "k2": -0.04}
    truth = TrueCamera(4000, 2250, 3240, 3240, 1999.5, 1124.5, (0.02, -0.04, 0, 0), False)
    assert_is(Camera.loads(json.dumps({"v2 a": perspective})), truth)
    fisheye = perspective | {"projection_type": "fisheye"}
    assert_is(Camera.loads(json.dumps({"v2 a": fisheye})), truth._replace(fisheye=True))
    kept = perspective | {"focal_prior": 0.85, "k1_prior": 0.0, "k2_prior": 0.0}
    assert_is(Camera.loads(json.dumps({"v2 a": kept})), truth)
    for change, message in (
        ({"projection_type": "spherical"}, "projection_type is 'spherical'"),
        ({"k3": 0.1}, "the key 'k3' is none of a perspective camera"),
        ({"k2": None}, "has no k2"),
    ):
        assert message in refusal(json.dumps({"v2 a": perspective | change})).message
    two = {"a": perspective, "b": opensfm(FIVE)["v2 maker front"]}
    assert refusal(json.dumps(two)).error_code == "several_cameras"
    assert_is(Camera.loads(json.dumps(two), which="b"), FIVE)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("<date>", "<k4>0.1</k4><date>", "its k4 is not 0"),
        ("<date>", "<b2>-4.2</b2><date>", "its b2 is not 0"),
        ("<date>", "<p3>0.1</p3><date>", "its p3 is not 0"),
        ("<f>", "<fx>", "ill-formed XML"),
        ("<date>", "<fx>3</fx><date>", "the element 'fx' is not known"),
        (">frame<", ">spherical<", "projection is 'spherical'"),
        ("<width>1920</width>", "", "has no width"),
    ],
)
def test_what_metashape_has_and_no_lens_here(old, new, message):
    text = agisoft(FIVE)
    assert old in text
    assert message in refusal(text.replace(old, new)).message


def test_metashape_without_distortion_needs_to_be_told():
    frame = "<projection>frame</projection><width>640</width><height>480</height><f>500</f>"
    text = f"<calibration>{frame}</calibration>"
    assert refusal(text).error_code == "distortion_not_said"
    camera = Camera.loads(text, no_distortion=True)
    np.testing.assert_array_equal(camera.matrix, [[500, 0, 319.5], [0, 500, 239.5], [0, 0, 1]])
    assert "and you say there is none" in refusal(agisoft(FIVE), no_distortion=True).message
    assert "is XML of 'document'" in refusal("<document><chunk/></document>").message


def test_mrcals_models():
    twelve = FIVE._replace(distortion=(*FIVE.distortion, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 0.0))
    assert_is(Camera.loads(mrcal(twelve)), twelve._replace(distortion=twelve.distortion[:8]))
    assert "thin prism" in refusal(mrcal(twelve).replace("0.3, 0.0", "0.3, 0.1")).message
    pinhole = mrcal(FIVE._replace(distortion=())).replace("OPENCV0", "PINHOLE")
    assert not Camera.loads(pinhole).distorted
    splined = mrcal(FIVE).replace("OPENCV5", "SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=18")
    assert "lensmodel is 'LENSMODEL_SPLINED" in refusal(splined).message
    assert "LENSMODEL_OPENCV8 has 12 intrinsics" in refusal(mrcal(FIVE).replace("V5", "V8")).message
    called = mrcal(FIVE).replace("b'P)j~w#4'", "__import__('os')")
    assert "ill-formed JSON" in refusal(called).message


def test_orbslams_cameras():
    assert_is(Camera.loads(dump(orbslam(FIVE))), FIVE)
    old = {key.replace("Camera1", "Camera"): value for key, value in orbslam(RADTAN).items()}
    del old["Camera.type"]
    assert_is(Camera.loads("%YAML:1.0\n" + dump(old)), RADTAN)
    both = orbslam(FISHEYE)
    both |= {
        key.replace("Camera1", "Camera2"): value + (key == "Camera1.cx")
        for key, value in both.items()
        if key.startswith("Camera1.")
    }
    assert refusal(dump(both)).error_code == "several_cameras"
    assert_is(Camera.loads(dump(both), which="Camera2"), FISHEYE._replace(cx=FISHEYE.cx + 1))
    for change, message in (
        ({"Camera1.k4": 0.1}, "PinHole takes k1, k2, p1, p2"),
        ({"Camera.type": "Omni"}, "Camera.type is 'Omni'"),
        ({"Camera.type": "Rectified"}, "is Rectified, and it holds distortion"),
        ({"LEFT.D": [0.1, 0, 0, 0]}, "the key 'LEFT.D' is not known"),
        ({"Camera.type": None}, None),
    ):
        text = dump(orbslam(RADTAN) | change)
        if message is None:
            assert_is(Camera.loads(text), RADTAN)
        else:
            assert message in refusal(text).message
    bare = {k: v for k, v in orbslam(RADTAN).items() if k[-2:] not in ("k1", "k2", "p1", "p2")}
    assert refusal(dump(bare)).error_code == "distortion_not_said"
    assert not Camera.loads(dump(bare | {"Camera.type": "Rectified"})).distorted


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"value0": {}}', "a calibration of Basalt"),
        ('{"fisheye_params": {}}', "a lens profile of Gyroflow"),
        ("/**:\n  ros__parameters: {}\n", "a file of ROS parameters"),
        ("[image]\n\nwidth\n1920\n", "ROS's INI form is not read"),
        ("# oST version 5.0 parameters\n[image]\n", "ROS's INI form is not read"),
    ],
)
def test_other_programs_files_are_refused_by_name(text, message):
    assert message in refusal(text).message


def test_what_opencv_writes_in_its_three_ways_is_one_camera():
    for truth in (FIVE, FISHEYE):
        found = [Camera.loads(opencv(truth, ending)) for ending in ("yml", "xml", "json")]
        for camera in found:
            assert_is(camera, truth)
    assert cv2.__version__.split(".")[0] in ("4", "5")
