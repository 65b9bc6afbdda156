"""The whole sign: four sides to a part of a pixel, the turn told by the cells."""

import numpy as np
import pytest
from paper_frames import errors, frame_of, paper_camera, sample_pad, small_camera

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.layout import outline_mm
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.radiance.scene import Occluder
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import find_regions
from padstudio.vision.outline.quadrilateral import (
    Outline,
    OutlinePose,
    find_outline,
    outline_pose,
)
from padstudio.vision.stage.params import OutlineParams
from padstudio.vision.stage.trace import Reason, StageFailure


def half_camera():
    full = paper_camera()
    return full.for_frame(full.width // 2, full.height // 2)


def found_in(image, camera, pad=None):
    pad = pad or sample_pad()
    pyramid = Pyramid(image)
    return find_outline(pyramid, camera, pad, find_regions(pyramid, pad)[0], OutlineParams())


def posed(image, camera, pad=None):
    pad = pad or sample_pad()
    outline = found_in(image, camera, pad)
    assert isinstance(outline, Outline)
    return outline_pose(outline, Pyramid(image), camera, pad, -7.0)


@pytest.mark.parametrize(
    ("height_mm", "ground", "margin_mm", "limit_px"),
    [
        (2500.0, "grass", 60.0, 0.25),
        (4000.0, "bricks", 60.0, 0.25),
        (7000.0, "concrete", 60.0, 0.25),
        (2500.0, "grass", 0.0, 1.2),  # ink on grass: little contrast, and stalks
    ],
)
def test_corners_are_found_to_a_part_of_a_pixel(height_mm, ground, margin_mm, limit_px):
    camera = half_camera()
    pose = look_at_pad(height_mm, tilt_deg=15, heading_deg=130, tilt_towards_deg=70)
    image = frame_of(pose, camera=camera, ground=ground, quiet_mm=margin_mm)
    outline = found_in(image, camera)
    assert isinstance(outline, Outline)
    true = camera.project((outline_mm(sample_pad()) - pose.position_mm) @ pose.rotation)
    off = np.linalg.norm(outline.corners_xy[:, None] - true, axis=2).min(axis=0)
    assert off.max() < limit_px
    assert isinstance(posed(image, camera), OutlinePose)


@pytest.mark.parametrize("heading_deg", [10.0, 100.0, 190.0, 280.0])
def test_cells_tell_which_corner_is_which(heading_deg):
    camera = half_camera()
    pose = look_at_pad(2600.0, tilt_deg=20, heading_deg=heading_deg, tilt_towards_deg=200)
    found = posed(frame_of(pose, camera=camera), camera)
    assert isinstance(found, OutlinePose)
    position, attitude = errors(found.pose, pose)
    assert position < 1.0
    assert attitude < 0.5
    assert found.read.evidence.log10_false_alarm < -50


def test_a_strongly_distorting_lens_is_no_matter():
    matrix = np.array([[620.0, 0, 679.5], [0, 620.0, 382.0], [0, 0, 1]])
    camera = Camera(1360, 765, matrix, np.array([-0.28, 0.09, 6e-4, -4e-4]))
    pose = look_at_pad(1800.0, tilt_deg=25, heading_deg=40, tilt_towards_deg=300)
    found = posed(frame_of(pose, camera=camera), camera)
    assert isinstance(found, OutlinePose)
    assert errors(found.pose, pose)[0] < 1.0


def test_something_on_the_rim_does_not_bend_the_sides():
    camera = half_camera()
    pose = look_at_pad(2600.0, tilt_deg=10, heading_deg=30)
    leaf = Occluder(x_mm=-100, y_mm=640, radius_mm=90)
    image = frame_of(pose, camera=camera, occluders=(leaf,), ground="asphalt")
    found = posed(image, camera)
    assert isinstance(found, OutlinePose)
    assert errors(found.pose, pose)[0] < 1.0


def test_a_pad_that_leaves_the_frame_has_no_outline():
    camera = half_camera()
    pose = look_at_pad(2000.0, heading_deg=30, target_mm=(900.0, 0.0))
    found = found_in(frame_of(pose, camera=camera), camera)
    assert isinstance(found, StageFailure)
    assert found.reason is Reason.NO_OUTLINE


def test_bare_ground_has_no_outline():
    pose = look_at_pad(2000.0)
    pad = sample_pad()
    empty = frame_of(
        pose, pad=Pad((Layer("red", 0.01, pad.layers[0].field),)), camera=small_camera()
    )
    assert isinstance(found_in(empty, small_camera()), StageFailure)


def test_another_pad_of_the_same_kind_is_refused():
    rng = np.random.default_rng(1)
    other = Pad(
        tuple(
            Layer(layer.channel, layer.cell_mm, rng.integers(0, 2, layer.field.shape))
            for layer in sample_pad().layers
        )
    )
    camera = half_camera()
    image = frame_of(look_at_pad(2600.0, heading_deg=20), pad=other, camera=camera)
    found = posed(image, camera)
    assert isinstance(found, StageFailure)
    assert found.stage == "outline"
    assert found.reason is Reason.UNKNOWN_CODE


def test_a_pad_that_uses_all_channels_has_no_colour_to_go_by():
    layer = sample_pad().layers[0]
    pad = Pad(tuple(Layer(c, layer.cell_mm, layer.field) for c in ("red", "green", "blue")))
    camera = half_camera()
    found = found_in(frame_of(look_at_pad(2600.0), pad=pad, camera=camera), camera, pad)
    assert isinstance(found, StageFailure)
    assert found.reason is Reason.NO_OUTLINE
