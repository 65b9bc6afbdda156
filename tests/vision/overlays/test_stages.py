"""Pictures of the stages, and what is drawn into them; what a trace holds."""

import time
from dataclasses import replace

import numpy as np
import pytest
from dense_frames import near_view, random_pad, sample_pad, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.vision.detector import Detector
from padstudio.vision.overlays import canvas
from padstudio.vision.overlays.result import result_picture
from padstudio.vision.overlays.stages import MAX_WIDTH, stage_picture
from padstudio.vision.stage.trace import Reason, Recorder, StageFailure


@pytest.fixture(scope="module")
def seen():
    return Detector(sample_pad(), small_camera()).detect(near_view()[0], trace=True)


@pytest.fixture(scope="module")
def unseen():
    image = render(Scene(pad=None), small_camera(), look_at_pad(900.0)).image
    return Detector(sample_pad(), small_camera()).detect(image, trace=True)


@pytest.mark.parametrize("channel", ["red", "blue"])
@pytest.mark.parametrize(
    "stage",
    ["stretch", "denoise", "channel", "block_mean", "clean", "edges", "lines", "grid", "decode"],
)
def test_every_stage_has_a_picture(seen, unseen, stage, channel):
    for found in (seen, unseen):
        picture = stage_picture(found.trace, stage, channel)
        if picture is None:
            assert found is unseen
            continue
        assert picture.dtype == np.uint8
        assert picture.ndim == 3
        assert picture.shape[2] == 3
        assert picture.shape[1] <= MAX_WIDTH
        assert picture.any()


def test_stages_for_all_channels_and_none_that_did_not_run(seen):
    for stage in ("choose", "pose"):
        picture = stage_picture(seen.trace, stage)
        assert picture.shape == seen.trace.image.shape
        assert (picture != seen.trace.image).any()
    assert stage_picture(seen.trace, "no such stage") is None


def test_cells_that_agree_are_marked_green_where_they_are(seen):
    picture = result_picture(seen.trace, [seen])
    cells = seen.trace.get("choose").output.read.cells
    expected = seen.trace.get("choose").output.read.expected
    agree = (cells.levels(2) == expected) & cells.seen
    xy = np.round(cells.xy[agree]).astype(int)
    inner = (xy > 8).all(axis=1) & (xy < [630, 470]).all(axis=1)
    colors = picture[xy[inner][:, 1], xy[inner][:, 0]].astype(int)
    green = (colors[:, 1] > colors[:, 2]) & (colors[:, 1] > colors[:, 0])
    assert green.mean() > 0.5


def count(picture, color):
    return int((picture == np.array(color, np.uint8)).all(axis=2).sum())


def test_where_the_bearing_alone_is_known_its_end_is_marked_instead_of_axes(seen):
    posed = seen.trace.get("pose").output
    unsure = replace(posed, fit=replace(posed.fit, doubt=np.full(6, 1e3)))
    for found, drawn, left_out in (
        (posed, canvas.AXES, [canvas.FIRST]),
        (unsure, [canvas.FIRST], canvas.AXES),
    ):
        picture = np.zeros_like(seen.trace.image)
        canvas.Canvas(picture, 1.0).axes(found)
        assert all(count(picture, color) > 20 for color in drawn)
        assert not any(count(picture, color) for color in left_out)


@pytest.mark.parametrize(("centre", "ring"), [((400.0, 200.0), True), ((-3000.0, 900.0), False)])
def test_a_ring_about_the_pads_centre_or_an_arrow_to_it(centre, ring):
    picture = np.zeros((480, 640, 3), np.uint8)
    canvas.Canvas(picture, 1.0).way_to(np.array(centre), 16_200.0, 90.0)
    around = picture[180:221, 380:421].any()
    assert bool(around) == ring
    assert bool(picture[235:245, 315:325].any()) != ring


def test_a_frame_without_a_pose_is_shown_as_it_is(unseen):
    picture = result_picture(unseen.trace, [unseen])
    np.testing.assert_array_equal(picture, unseen.trace.image)


def test_drawing_leaves_the_trace_alone(seen):
    before = seen.trace.image.copy()
    for record in seen.trace.records:
        stage_picture(seen.trace, record.name, record.channel)
    np.testing.assert_array_equal(seen.trace.image, before)


def test_wide_pictures_are_made_smaller_and_others_copied():
    wide = np.zeros((30, 4000, 3), np.uint8)
    assert canvas.fit(wide, 1000).shape == (8, 1000, 3)
    small = np.zeros((30, 40, 3), np.uint8)
    copy = canvas.fit(small, 1000)
    assert copy is not small
    assert copy.shape == small.shape


def test_points_beyond_the_picture_are_not_drawn():
    picture = np.zeros((10, 10, 3), np.uint8)
    canvas.points(picture, np.array([[3.2, 4.4], [-1.0, 5.0], [10.0, 0.0]]), (1, 2, 3))
    assert picture.any(axis=2).sum() == 1
    np.testing.assert_array_equal(picture[4, 3], (1, 2, 3))


def test_a_recorder_times_every_run_and_keeps_what_it_is_asked_to():
    for keep in (True, False):
        recorder = Recorder(keep=keep)
        assert recorder.run("edges", "red", lambda a, *, b: a + b, 2, b=3) == 5
        recorder.run("edges", "blue", time.sleep, 0.002)
        recorder.note("pose", None, StageFailure("pose", Reason.POSE_REJECTED, "x"))
        elapsed = recorder.elapsed_ms()
        assert elapsed["total"] >= elapsed["edges"] >= 2
        trace = recorder.trace(np.zeros((2, 2, 3), np.uint8))
        assert (trace is not None) == keep
        if trace is not None:
            assert trace.get("edges", "red").output == 5
            assert trace.get("pose").failure.reason is Reason.POSE_REJECTED
            assert trace.get("grid") is None


def reason_of(imaging=None, *, height_mm=900.0, pad="sample", image=None, **scene):
    detector = Detector(sample_pad(), small_camera())
    if image is None:
        shown = sample_pad() if pad == "sample" else pad
        image = render(
            Scene(pad=shown, **scene), small_camera(), look_at_pad(height_mm), imaging, 1
        ).image
    return detector.detect(image).failure


def test_the_cause_of_a_failure_is_named_with_figures_and_advice():
    burnt = reason_of(Imaging(brightness=100.0))
    assert burnt.reason is Reason.OVEREXPOSED
    assert "%" in burnt.detail
    dark = reason_of(image=np.full((480, 640, 3), 3, np.uint8))
    assert dark.reason is Reason.UNDEREXPOSED
    flat = reason_of(image=np.full((480, 640, 3), 120, np.uint8))
    assert flat.reason is Reason.NO_CONTRAST
    far = reason_of(height_mm=25_000.0)
    assert far.reason is Reason.CELLS_TOO_SMALL
    assert "fly below about" in far.advice
    for failure in (burnt, dark, flat, far):
        assert failure.advice
        assert any(character.isdigit() for character in failure.detail)


def test_another_pad_is_suspected():
    failure = reason_of(pad=random_pad(77))
    assert failure.reason is Reason.UNKNOWN_CODE
    assert "another pad" in failure.advice
