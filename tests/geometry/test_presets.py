import math

import pytest

from padstudio.errors import NotFoundError
from padstudio.geometry import presets


def diagonal_view_deg(camera):
    half = math.hypot(camera.width, camera.height) / 2
    return 2 * math.degrees(math.atan(half / camera.focal_px))


def test_the_drone_of_the_published_flights():
    camera = presets.get("preset-dji-mini-27k").camera
    assert (camera.width, camera.height, camera.focal_px) == (2720, 1530, 1886.0)
    assert tuple(camera.matrix[:2, 2]) == (1359.5, 764.5)


@pytest.mark.parametrize(("preset_id", "preset"), presets.PRESETS.items())
def test_every_preset_says_that_it_is_nominal(preset_id, preset):
    assert preset.id == preset_id
    assert preset_id.startswith("preset-")
    assert preset_id == preset_id.lower()
    assert preset.camera.nominal
    assert preset.note == "nominal, calibrate for accuracy"
    assert not preset.camera.distorted


# The makers give the angle of view too, to a degree or so: a check of the focal lengths.
@pytest.mark.parametrize(
    ("preset_id", "view_deg"),
    [
        ("preset-dji-mini-2-still", 83),
        ("preset-dji-mini-3-pro-still", 82.1),
        ("preset-dji-air-2s-still", 88),
        ("preset-dji-mavic-3-still", 84),
        ("preset-dji-mavic-2-pro-still", 77),
        ("preset-dji-phantom-4-pro-still", 84),
        ("preset-webcam-c920", 78),
    ],
)
def test_focal_lengths_agree_with_the_makers_angles_of_view(preset_id, view_deg):
    assert diagonal_view_deg(presets.get(preset_id).camera) == pytest.approx(view_deg, abs=2.5)


def test_the_paper_drones_focal_length_follows_from_its_data_sheet():
    still = presets.get("preset-dji-mini-2-still").camera
    assert still.focal_px * 2720 / 4000 == pytest.approx(1886, abs=1)


def test_an_unknown_preset_is_answered_with_those_there_are():
    with pytest.raises(NotFoundError, match=r"no camera preset 'x'.*preset-dji-mini-27k"):
        presets.get("x")
