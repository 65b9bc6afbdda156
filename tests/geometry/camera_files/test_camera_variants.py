"""No variant of a camera file is read with another lens than was written: the same, or refused."""

import re

import numpy as np
import pytest
from camera_forms import MAPPINGS, RAYS, TEXTS, as_json, as_yaml, pixels
from hypothesis import assume, given
from hypothesis import strategies as st

from padstudio import Camera
from padstudio.errors import CameraFormatError

SYNONYMS = {
    "distortion_coefficients": ["dist_coeffs", "distCoeff", "Distortion Coefficients", "D", "dist"],
    "dist": ["distortion", "distortion_coeffs", "dist_coeff"],
    "d": ["D", "dist_coefs"],
    "camera_matrix": ["cameraMatrix", "K", "CameraMat", "intrinsic_matrix"],
    "mtx": ["k", "camera_mtx"],
    "distortion_model": ["model", "camera_model", "lensModel", "DISTORTION-MODEL"],
    "image_width": ["width", "imageWidth", "img_width"],
    "image_height": ["height", "image_Height"],
    "img_size": ["resolution", "DIM", "imageSize"],
    "fisheye": ["fisheye_model", "isFisheye"],
}
# What somebody may call a key who knows none of these programs.
ODD_KEYS = st.sampled_from(
    ["coeffs", "distortions", "lens", "k1", "kc", "params", "notes", "flags", "xi", "alpha"]
    + ["images", "header", "fov", "lens_name", "model", "type", "projection", "rms_error", "foo"]
    + ["new_camera_matrix", "size", "camera", "D", "K", "fisheye", "none", "fx"]
) | st.text("abcdkpx_. 1", min_size=1, max_size=6)
ODD_VALUES = (
    st.sampled_from(["equidistant", "omni", "plumb_bob", "fov", "wide", 1.2, 0.1, True, None])
    | st.lists(st.floats(-1, 1), min_size=1, max_size=6)
    | st.just({"k1": 0.1})
)


def read(text):
    """Where the camera of a file sees the rays, or None where the file is refused."""
    try:
        camera = Camera.loads(text, "camera")
    except CameraFormatError:
        return None
    return camera.project(RAYS)


def assert_same_or_refused(text, truth):
    seen = read(text)
    if seen is not None:
        np.testing.assert_allclose(seen, pixels(truth), rtol=0, atol=1e-6)


def part(values):
    """The mapping that holds the lens: the file's own, or that of its one camera."""
    inner = next(iter(values.values()))
    return inner if len(values) == 1 else values


@pytest.mark.parametrize("form", TEXTS)
@given(data=st.data())
def test_texts_are_read_as_they_are_written(form, data):
    write, cameras = TEXTS[form]
    truth = data.draw(cameras)
    seen = read(write(truth))
    np.testing.assert_allclose(seen, pixels(truth), rtol=0, atol=1e-6)


@pytest.mark.parametrize("form", MAPPINGS)
@given(data=st.data())
def test_mappings_are_read_in_any_order_and_as_yaml_and_json(form, data):
    write, cameras = MAPPINGS[form]
    truth = data.draw(cameras)
    values = write(truth)
    inner = part(values)
    items = data.draw(st.permutations(list(inner.items())))
    inner.clear()
    inner.update(items)
    dump = data.draw(st.sampled_from([as_yaml, as_json]))
    np.testing.assert_allclose(read(dump(values)), pixels(truth), rtol=0, atol=1e-6)


@pytest.mark.parametrize("form", ["ros", "ros message", "script"])
@given(data=st.data())
def test_other_names_of_known_keys(form, data):
    write, cameras = MAPPINGS[form]
    truth = data.draw(cameras)
    names = {key: data.draw(st.sampled_from([key, *SYNONYMS.get(key, [])])) for key in write(truth)}
    renamed = {names[key]: value for key, value in write(truth).items()}
    np.testing.assert_allclose(read(as_yaml(renamed)), pixels(truth), rtol=0, atol=1e-6)


@pytest.mark.parametrize("form", MAPPINGS)
@given(data=st.data())
def test_renamed_missing_and_added_keys(form, data):
    write, cameras = MAPPINGS[form]
    truth = data.draw(cameras)
    values = write(truth)
    inner = part(values)
    # k3 of ORB-SLAM's PinHole may be left out, and then there is none.
    key = data.draw(st.sampled_from([each for each in inner if not each.endswith(".k3")]))
    what = data.draw(st.sampled_from(["rename", "remove", "empty", "add"]))
    if what == "add":
        inner.setdefault(data.draw(ODD_KEYS), data.draw(ODD_VALUES))
    elif what == "empty":
        inner[key] = data.draw(st.sampled_from([None, "", {}]))
    else:
        value = inner.pop(key)
        if what == "rename":
            inner.setdefault(data.draw(ODD_KEYS), value)
    assert_same_or_refused(as_yaml(values), truth)


@pytest.mark.parametrize("form", [*MAPPINGS, *TEXTS])
@given(data=st.data())
def test_numbers_that_went_missing(form, data):
    write, cameras = {**MAPPINGS, **TEXTS}[form]
    truth = data.draw(cameras)
    written = write(truth)
    text = written if isinstance(written, str) else as_json(written)
    # Metashape leaves out what is 0, ORB-SLAM k3, and lists alone may have four for five: one
    # less says another lens.
    numbers = [
        match
        for match in re.finditer(r"(?<![\w.\"'<-])-?\d+\.\d+(e-?\d+)?,?", text)
        if form != "agisoft" and not text[: match.start()].endswith('k3": ')
    ]
    is_bare = form in ("script", "ros message") and len(truth.distortion) == 5
    if numbers and not is_bare:
        gone = data.draw(st.sampled_from(numbers))
        assert_same_or_refused(text[: gone.start()] + text[gone.end() :], truth)


@pytest.mark.parametrize("form", [*MAPPINGS, *TEXTS])
@given(data=st.data())
def test_files_that_were_cut_off(form, data):
    write, cameras = {**MAPPINGS, **TEXTS}[form]
    truth = data.draw(cameras)
    written = write(truth)
    text = written if isinstance(written, str) else as_yaml(written)
    end = data.draw(st.integers(1, len(text) - 1))
    # A number that lost digits is one still.
    assume(not re.fullmatch(r"[\d.e-]{2}", text[end - 1 : end + 1]))
    assert_same_or_refused(text[:end], truth)
