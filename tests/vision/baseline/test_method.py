"""The paper's method as a whole: its ranges, its silence, its trace."""

import numpy as np
import pytest
from paper_frames import errors, frame_of, paper_camera, sample_pad

from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.detector import Detector
from padstudio.vision.stage.trace import STAGES, Reason, StageFailure


@pytest.fixture(scope="module")
def detector():
    return Detector(sample_pad(), paper_camera(), method="paper")


@pytest.mark.parametrize(
    ("height_mm", "tilt_deg", "layers"),
    [
        (80.0, 0.0, {"red"}),
        (120.0, 40.0, {"red"}),
        (180.0, 20.0, {"red", "blue"}),
        (400.0, 0.0, {"blue"}),
        (700.0, 40.0, {"blue"}),
        (1500.0, 10.0, {"blue"}),
        (4000.0, 30.0, {"outline"}),
    ],
)
def test_holds_in_the_papers_ranges(detector, height_mm, tilt_deg, layers):
    pose = look_at_pad(
        height_mm, tilt_deg=tilt_deg, heading_deg=35 + height_mm, tilt_towards_deg=140
    )
    found = detector.detect(frame_of(pose))
    assert found.ok, found.failure
    assert found.layer in layers
    position, attitude = errors(found.pose, pose)
    assert position < 1.5
    assert attitude < 1.0
    assert found.log10_false_alarm <= -4
    assert found.cells_wrong <= 0.05 * found.cells_read


def test_where_the_window_grows_too_small_the_outline_takes_over(detector):
    """Window and outline share these heights."""
    for heading_deg in (35, 110, 200, 290):
        pose = look_at_pad(1800.0, tilt_deg=10, heading_deg=heading_deg, tilt_towards_deg=140)
        found = detector.detect(frame_of(pose))
        assert found.ok, found.failure
        assert found.layer in {"blue", "outline"}
        assert errors(found.pose, pose)[0] < 1.5


def test_a_whole_sign_is_found_beside_something_larger_of_its_colours(detector):
    pose = look_at_pad(3000.0, tilt_deg=5, heading_deg=15)
    picture = frame_of(pose)
    # It reaches beyond the frame, as a near sign's parts do.
    picture[:, :700] = (150, 20, 170)
    found = detector.detect(picture)
    assert found.ok, found.failure
    assert errors(found.pose, pose)[0] < 1.5


def test_parts_of_a_sign_that_reaches_beyond_the_frame_are_not_taken_for_signs(detector):
    pose = look_at_pad(120.0, tilt_deg=10, heading_deg=15)
    found = detector.detect(frame_of(pose), trace=True)
    assert found.ok
    assert [record.name for record in found.trace.records].count("outline") == 1


def test_every_heading_is_told_apart(detector):
    for heading_deg in (0.0, 90.0, 180.0, 270.0):
        pose = look_at_pad(600.0, tilt_deg=15, heading_deg=heading_deg, target_mm=(150, -200))
        found = detector.detect(frame_of(pose))
        assert found.ok, found.failure
        assert errors(found.pose, pose)[0] < 1.0


@pytest.mark.parametrize("height_mm", [500.0, 900.0])
def test_exchanged_channels_give_no_pose_and_are_named(detector, height_mm):
    """The pad's layers share a code: the fine one in the blue channel reads as the coarse one."""
    pose = look_at_pad(height_mm, tilt_deg=10, heading_deg=80, target_mm=(-300, 300))
    frame = frame_of(pose)
    assert detector.detect(frame).ok
    found = detector.detect(np.ascontiguousarray(frame[:, :, ::-1]))
    assert not found.ok
    assert found.failure.reason is Reason.CHANNELS_SWAPPED


@pytest.mark.parametrize("height_mm", [200.0, 700.0])
def test_a_grey_picture_gives_no_pose_of_another_scale(detector, height_mm):
    pose = look_at_pad(height_mm, tilt_deg=10, heading_deg=80, target_mm=(-450, 450))
    grey = frame_of(pose).mean(axis=2, keepdims=True).astype(np.uint8)
    found = detector.detect(np.repeat(grey, 3, axis=2))
    assert not found.ok or errors(found.pose, pose)[0] < 2


def foreign_pad():
    rng = np.random.default_rng(12)
    return Pad(
        tuple(
            Layer(layer.channel, layer.cell_mm, rng.integers(0, 2, layer.field.shape))
            for layer in sample_pad().layers
        )
    )


def checkerboard():
    cells = (np.add.outer(np.arange(25), np.arange(25)) % 2).astype(np.uint8)
    return Pad(tuple(Layer(c, 50.0, cells) for c in ("red", "blue")), window=3)


@pytest.mark.parametrize("height_mm", [150.0, 700.0, 2600.0])
@pytest.mark.parametrize("pad", [foreign_pad(), checkerboard()], ids=["foreign", "checkerboard"])
def test_is_silent_on_what_is_not_this_pad(detector, pad, height_mm):
    pose = look_at_pad(height_mm, tilt_deg=10, heading_deg=20, tilt_towards_deg=70)
    found = detector.detect(frame_of(pose, pad=pad))
    assert not found.ok
    assert found.failure.detail


def test_is_silent_on_bare_ground(detector):
    tiny = Pad((Layer("red", 1e-2, sample_pad().layers[0].field),))
    found = detector.detect(frame_of(look_at_pad(900.0), pad=tiny, ground="bricks"))
    assert not found.ok


@pytest.mark.parametrize("height_mm", [500.0, 2600.0])
def test_a_trace_shows_every_stage_of_both_channels_and_changes_nothing(detector, height_mm):
    image = frame_of(look_at_pad(height_mm, tilt_deg=12, heading_deg=50))
    plain, traced = detector.detect(image), detector.detect(image, trace=True)
    np.testing.assert_allclose(plain.pose.position_mm, traced.pose.position_mm, rtol=1e-12)
    names = {(record.name, record.channel) for record in traced.trace.records}
    for channel in ("red", "blue"):
        for stage in ("channel", "block_mean", "clean", "edges", "lines"):
            assert (stage, channel) in names
    assert {"stretch", "denoise", "outline", "pose"} <= {name for name, _ in names}
    assert {name for name, _ in names} <= set(STAGES)
    assert plain.elapsed_ms["total"] > 0


def test_a_video_is_a_row_of_stills(detector):
    images = [
        frame_of(look_at_pad(height_mm, tilt_deg=8, heading_deg=50)) for height_mm in (500.0, 480.0)
    ]
    for tracked, image in zip(detector.track(images, fuse=False), images, strict=True):
        still = detector.detect(image)
        # Sums of NumPy end in other bits where arrays begin elsewhere in memory.
        np.testing.assert_allclose(
            tracked.pose.position_mm, still.pose.position_mm, rtol=0, atol=1e-6
        )


def test_a_failure_is_the_one_nearest_to_an_answer(detector):
    close = detector.detect(frame_of(look_at_pad(35.0, heading_deg=20)), trace=True)
    assert not close.ok
    stages = [
        record.name for record in close.trace.records if isinstance(record.output, StageFailure)
    ]
    order = ("outline", "edges", "lines", "grid", "decode", "pose")
    assert close.failure.stage == max(stages, key=order.index)
