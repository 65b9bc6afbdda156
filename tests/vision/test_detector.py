"""The detector that callers use."""

import numpy as np
import pytest
from dense_frames import errors, frame_of, near_view, sample_pad, small_camera

from padstudio.errors import CameraMismatchError, ImageError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.coverage.spans import METHOD_LIMITS
from padstudio.vision.detector import Detector
from padstudio.vision.stage.trace import STAGES, Reason


@pytest.fixture(scope="module")
def detector():
    return Detector(sample_pad(), small_camera())


@pytest.mark.parametrize(
    "image",
    [
        np.zeros((480, 640), np.uint8),
        np.zeros((480, 640, 4), np.uint8),
        np.zeros((480, 640, 3), np.float32),
        np.zeros((15, 640, 3), np.uint8),
    ],
)
def test_what_is_no_frame_is_refused(detector, image):
    with pytest.raises(ImageError, match="uint8"):
        detector.detect(image)
    with pytest.raises(ImageError, match="uint8"):
        list(detector.track([image]))


def test_a_frame_of_another_shape_is_refused(detector):
    with pytest.raises(CameraMismatchError):
        detector.detect(np.zeros((640, 480, 3), np.uint8))


def test_a_calibration_of_another_size_is_scaled():
    image, _, pose = near_view()
    small = small_camera()
    matrix = small.matrix * 2
    matrix[:2, 2] = 2 * small.matrix[:2, 2] + 0.5
    matrix[2, 2] = 1
    found = Detector(sample_pad(), Camera(1280, 960, matrix)).detect(image)
    assert errors(found.pose, pose)[0] < 0.3


def test_a_trace_holds_every_stage_and_changes_nothing(detector):
    image, _, _ = near_view()
    plain, traced = detector.detect(image), detector.detect(image, trace=True)
    np.testing.assert_allclose(plain.pose.position_mm, traced.pose.position_mm, rtol=1e-12)
    assert plain.trace is None
    names = [record.name for record in traced.trace.records]
    assert set(names) <= set(STAGES)
    for channel in ("red", "blue"):
        for stage in ("block_mean", "clean", "edges", "lines", "grid", "decode"):
            assert traced.trace.get(stage, channel) is not None
    for stage in ("stretch", "denoise", "choose", "pose"):
        assert traced.trace.get(stage) is not None
    total = plain.elapsed_ms["total"]
    assert 0 < sum(ms for name, ms in plain.elapsed_ms.items() if name != "total") <= total


def test_the_same_frame_gives_the_same_pose(detector):
    image, _, _ = near_view()
    first, second = detector.detect(image), detector.detect(image)
    # Vector units sum in an order that depends on where arrays lie in memory.
    np.testing.assert_allclose(first.pose.position_mm, second.pose.position_mm, rtol=1e-12)
    np.testing.assert_allclose(
        first.uncertainty.covariance, second.uncertainty.covariance, rtol=1e-6, atol=1e-18
    )


def test_the_frame_is_not_written_to(detector):
    image = near_view()[0].copy()
    image.setflags(write=False)
    before = image.copy()
    detector.detect(image, trace=True)
    np.testing.assert_array_equal(image, before)


def test_a_turned_frame_turns_the_pose(detector):
    """Half a turn of the picture is half a turn of the camera about its axis."""
    image, _, pose = near_view()
    found = detector.detect(np.ascontiguousarray(image[::-1, ::-1]))
    turned = pose.rotation @ np.diag([-1.0, -1.0, 1.0])
    assert np.abs(found.pose.rotation - turned).max() < 3e-3
    np.testing.assert_allclose(found.pose.position_mm, pose.position_mm, atol=2.0)


def test_parts_of_the_covariance_agree(detector):
    found = detector.detect(near_view()[0]).uncertainty
    np.testing.assert_allclose(found.covariance, found.covariance.T, atol=1e-12)
    assert np.linalg.eigvalsh(found.covariance)[0] > 0
    np.testing.assert_allclose(found.position_sigma_mm**2, np.diag(found.covariance)[:3])
    np.testing.assert_allclose(
        np.radians(found.attitude_sigma_deg) ** 2, np.diag(found.covariance)[3:]
    )


def test_a_pad_printed_too_large_is_measured_as_printed():
    from dataclasses import replace

    image, _, pose = near_view()
    large = replace(sample_pad(), scale=(1.02, 1.02))
    found = Detector(large, small_camera()).detect(image)
    np.testing.assert_allclose(found.pose.position_mm, 1.02 * pose.position_mm, atol=2.0)


def test_a_layer_that_was_read_is_not_called_unread():
    """From afar the outline leads to the pose; that lattices show too little is then no news."""
    pose = look_at_pad(3500.0, tilt_deg=10, heading_deg=25)
    frame = frame_of(pose, camera=small_camera())
    found = Detector(sample_pad(), small_camera()).detect(frame, trace=True)
    assert errors(found.pose, pose)[0] < 2
    assert found.layer == "blue"
    assert found.trace.get("outline").failure is None
    assert [r for r in found.trace.records if r.channel == "blue" and r.failure] == []
    (red,) = [r.failure for r in found.trace.records if r.channel == "red" and r.failure]
    assert red.reason is Reason.CELLS_TOO_SMALL
    needed = METHOD_LIMITS["dense"].cell_px
    assert f"px wide here, {needed:g} are needed: expected from this height" in red.detail
