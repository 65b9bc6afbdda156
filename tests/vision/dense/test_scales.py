"""Poses that one channel bears out and another does not: scale, exchanged channels, grey pictures.

In the sample pad, as in the source paper, the coarse layer is a copy of the fine one's corner.
"""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np
import pytest
from dense_frames import errors, frame_of, random_pad, sample_pad, small_camera
from grey_frames import GREY, grey, sodium

from padstudio.arrays import Image
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells.layer_read import LayerRead, read_layer
from padstudio.vision.cells.mixture import find_mixture
from padstudio.vision.dense.scales import other_scales, rescaled
from padstudio.vision.detector import Detector
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.stage.trace import Reason

# Over the pad's top left corner, where the coarse layer's code is that of the fine one.
CORNER_MM = (-480.0, 470.0)
# Heights at which the fine layer, both, and the coarse one are read.
VIEWS = [
    look_at_pad(150.0, tilt_deg=5, heading_deg=20, tilt_towards_deg=80, target_mm=CORNER_MM),
    look_at_pad(400.0, tilt_deg=15, heading_deg=200, tilt_towards_deg=10, target_mm=CORNER_MM),
    look_at_pad(900.0, tilt_deg=10, heading_deg=110, tilt_towards_deg=60, target_mm=(-200, 200)),
    look_at_pad(1800.0, tilt_deg=20, heading_deg=300, tilt_towards_deg=200),
    # Half of the frame is ground.
    look_at_pad(2100.0, tilt_deg=20, heading_deg=62, tilt_towards_deg=75, target_mm=(450, -300)),
]


@cache
def frame(view: int) -> Image:
    return frame_of(VIEWS[view], camera=small_camera())


@cache
def detector() -> Detector:
    return Detector(sample_pad(), small_camera())


def exchanged(bgr: Image) -> Image:
    return np.ascontiguousarray(bgr[:, :, ::-1])


@pytest.mark.parametrize("view", range(len(VIEWS)))
def test_exchanged_channels_give_no_pose_and_a_name(view: int) -> None:
    found = detector().detect(exchanged(frame(view)))
    assert found.failure is not None
    assert found.failure.reason is Reason.CHANNELS_SWAPPED
    assert "exchange red and blue" in found.failure.advice


@pytest.mark.parametrize("view", range(len(VIEWS)))
def test_a_trace_of_exchanged_channels_shows_each_channels_own_stages(view: int) -> None:
    found = detector().detect(exchanged(frame(view)), trace=True)
    assert found.failure is not None
    assert found.trace is not None
    for channel in ("red", "blue"):
        record = found.trace.get("edges", channel)
        assert record is None or record.channel == channel
    assert [r.name for r in found.trace.records if r.channel is None and r.name == "decode"] == []


@pytest.mark.parametrize("view", range(len(VIEWS)))
def test_the_same_frames_give_their_poses_as_they_are(view: int) -> None:
    found = detector().detect(frame(view))
    assert found.ok, found.failure
    assert errors(found.pose, VIEWS[view])[0] < 0.3


@pytest.mark.parametrize("view", range(len(VIEWS)))
@pytest.mark.parametrize("change", GREY.values(), ids=GREY)
def test_grey_pictures_give_the_right_pose_or_none(change, view: int) -> None:
    found = detector().detect(change(frame(view)))
    assert found.pose is None or errors(found.pose, VIEWS[view])[0] < 1.0


def test_most_grey_pictures_over_the_corner_are_read() -> None:
    found = [
        detector().detect(change(frame(view)))
        for view in (0, 1, 2)
        for change in (lambda bgr: grey(bgr, (1 / 3, 1 / 3, 1 / 3)), sodium)
    ]
    assert sum(item.ok for item in found) >= 5


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda bgr: np.ascontiguousarray(bgr[:, ::-1]), Reason.MIRRORED),
        (lambda bgr: np.ascontiguousarray(bgr[::-1]), Reason.MIRRORED),
        (lambda bgr: 255 - bgr, Reason.INVERTED),
        (exchanged, Reason.CHANNELS_SWAPPED),
    ],
    ids=["left for right", "upside down", "inverted", "exchanged"],
)
@pytest.mark.parametrize("pad", [sample_pad(), random_pad(5)], ids=["copied layer", "own codes"])
def test_pads_that_are_shown_wrongly_have_a_name(change, reason: Reason, pad: Pad) -> None:
    pose = look_at_pad(700.0, tilt_deg=12, heading_deg=40, tilt_towards_deg=30)
    shown = change(frame_of(pose, pad=pad, camera=small_camera()))
    found = Detector(pad, small_camera()).detect(shown)
    assert found.failure is not None
    assert found.failure.reason is reason


def test_a_frame_of_something_else_has_none_of_these_names() -> None:
    rng = np.random.default_rng(3)
    noise = rng.integers(0, 2, (48, 64, 3)).astype(np.uint8) * 200
    picture = cv2.resize(noise, (640, 480), interpolation=cv2.INTER_NEAREST)
    found = detector().detect(np.asarray(picture, np.uint8))
    assert found.failure is not None
    named = {Reason.MIRRORED, Reason.INVERTED, Reason.CHANNELS_SWAPPED}
    assert found.failure.reason not in named


def test_an_ink_that_does_not_show_is_no_fault_where_no_other_scale_could_be_meant() -> None:
    """A blue ink that the camera does not see, as in near infrared."""
    pad = random_pad(7)
    pose = look_at_pad(500.0, tilt_deg=10, heading_deg=10, tilt_towards_deg=120)
    unseen = Pad((pad.layers[0], Layer("blue", 50.0, np.ones((25, 25)))), levels=2)
    found = Detector(pad, small_camera()).detect(frame_of(pose, pad=unseen, camera=small_camera()))
    assert found.ok, found.failure
    assert errors(found.pose, pose)[0] < 0.3


@pytest.mark.parametrize("seed", range(4))
def test_dirt_in_one_channel_costs_no_pose_where_no_other_scale_could_be_meant(seed: int) -> None:
    """A blue print that has faded to a seventh, under blotches."""
    pad, rng = random_pad(20 + seed), np.random.default_rng(seed)
    pose = look_at_pad(500.0, tilt_deg=10, heading_deg=70 * seed, tilt_towards_deg=60)
    shown = frame_of(pose, pad=pad, camera=small_camera()).astype(float)
    blotches = cv2.GaussianBlur(rng.normal(0, 1, shown.shape[:2]), (0, 0), 12)
    shown[:, :, 0] = 110 + 0.15 * (shown[:, :, 0] - 110) + 25 * blotches / blotches.std()
    found = Detector(pad, small_camera()).detect(np.clip(shown, 0, 255).astype(np.uint8))
    assert found.ok, found.failure
    assert errors(found.pose, pose)[0] < 0.3


def read_at(pad: Pad, pose: Pose, channel: str) -> LayerRead:
    layer = pad.layer(channel)
    pyramid = Pyramid(frame_of(pose, pad=pad, camera=small_camera()))
    found = read_layer(pyramid, small_camera(), pad, layer, MovingPose(pose), 1)
    assert found is not None
    return found


@pytest.mark.parametrize(("channel", "ratio"), [("red", 5.0), ("blue", 0.2)])
def test_cells_over_the_shared_corner_could_be_read_at_another_scale(channel, ratio) -> None:
    pad = sample_pad()
    assert other_scales(pad, read_at(pad, VIEWS[0], channel)) == pytest.approx((ratio,))


def test_cells_beyond_the_shared_corner_could_not() -> None:
    pad, far = sample_pad(), look_at_pad(150.0, target_mm=(400.0, -400.0))
    assert other_scales(pad, read_at(pad, far, "red")) == ()


def test_ground_beside_the_pad_is_no_cell_beyond_the_shared_corner() -> None:
    """The coarse layer, seen in red, with as much ground about it, read as the fine one."""
    pad, view = sample_pad(), len(VIEWS) - 1
    near = rescaled(pad, MovingPose(VIEWS[view]), 0.2)
    pyramid = Pyramid(exchanged(frame(view)))
    found = read_layer(pyramid, small_camera(), pad, pad.layer("red"), near, 1)
    assert found is not None
    assert found.cells.seen[:25, :25].sum() < 0.5 * found.cells.seen.sum()
    assert other_scales(pad, found) == pytest.approx((5.0,))


def test_layers_with_codes_of_their_own_share_no_scale() -> None:
    pad = random_pad(1)
    assert other_scales(pad, read_at(pad, VIEWS[0], "red")) == ()


def test_a_rescaled_pose_sees_the_same_cells_of_the_other_layer() -> None:
    pad, camera = sample_pad(), small_camera()
    pose = MovingPose(VIEWS[1], np.array([3.0, -2.0, 1.0]), np.array([0.01, 0.0, -0.02]))
    other = rescaled(pad, pose, 5.0)
    width, height = pad.size_mm
    cells = np.random.default_rng(0).uniform(0, 20, (50, 2))

    def corner_of(cell_mm: float) -> np.ndarray:
        x, y = -width / 2 + cells[:, 0] * cell_mm, height / 2 - cells[:, 1] * cell_mm
        return np.column_stack([x, y, np.zeros(len(cells))])

    assert np.allclose(
        pose.project(camera, corner_of(10.0)), other.project(camera, corner_of(50.0)), atol=1e-6
    )


@pytest.mark.parametrize("view", range(len(VIEWS)))
def test_a_mixture_tells_each_layer_in_its_own_channel(view: int) -> None:
    pose = MovingPose(VIEWS[view])
    mixture = find_mixture(Pyramid(frame(view)), small_camera(), sample_pad(), pose)
    assert mixture is not None
    assert (mixture.unexplained, mixture.hidden, mixture.exchanged) == (None, None, False)
    for channel in mixture.channels:
        if channel.channel in mixture.telling:
            assert channel.shows[channel.channel] > 0.5


@pytest.mark.parametrize("ratio", [0.2, 5.0])
@pytest.mark.parametrize("view", [1, 2, 3])
def test_a_pose_of_another_scale_is_contradicted(view: int, ratio: float) -> None:
    pose = rescaled(sample_pad(), MovingPose(VIEWS[view]), ratio)
    mixture = find_mixture(Pyramid(frame(view)), small_camera(), sample_pad(), pose)
    assert mixture is None or mixture.unexplained or mixture.hidden


def test_too_little_of_the_pad_in_view_tells_nothing() -> None:
    aside = Pose(np.array([5000.0, 0.0, 500.0]), VIEWS[0].rotation)
    pose = MovingPose(aside)
    assert find_mixture(Pyramid(frame(0)), small_camera(), sample_pad(), pose) is None
