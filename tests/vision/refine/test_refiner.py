"""From a first pose to the best: layers, their fits, cells read with a pose."""

from dataclasses import replace

import numpy as np
import pytest
from dense_frames import (
    errors,
    frame_of,
    near_view,
    params,
    random_pad,
    recorder,
    sample_pad,
    small_camera,
)

from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import lattice_mm, lattice_of
from padstudio.vision.cells.visible import visible_range
from padstudio.vision.dense.answer import Choice, choose
from padstudio.vision.dense.whole_pad import WholeSign, find_whole_sign
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import find_regions
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.search.looks import Search
from padstudio.vision.search.search import Sighting, place, sightings
from padstudio.vision.stage.trace import Reason, StageFailure

CAMERA = small_camera()
RED, BLUE = (sample_pad().layer(channel) for channel in ("red", "blue"))


def refiner(pyramid, attempts=1, pad=None):
    return Refiner(pyramid, CAMERA, pad or sample_pad(), params(), attempts)


def test_a_rough_start_climbs_from_the_coarse_layer_to_the_fine_one():
    _, pyramid, pose = near_view()
    start = MovingPose(pose).moved(np.array([5.0, -4.0, 6.0, 0.004, -0.003, 0.006]))
    work = refiner(pyramid)
    layer_fits = work.coarse_to_fine(start, np.inf)
    assert [fit.layer.channel for fit in layer_fits] == ["blue", "red"]
    found = work.refine_finest(layer_fits)
    assert found is not None
    assert found.layer is RED
    assert errors(found.fit.pose.pose, pose)[0] < 0.1
    assert found.cell_px == pytest.approx(440 * 10 / 600, rel=0.2)
    assert len(found.fit.inliers) == len(found.edge_points.xy)


def test_a_start_a_cell_off_is_not_polished_into_a_pose():
    _, pyramid, pose = near_view()
    start = MovingPose(pose).moved(np.array([50.0, 0, 0, 0, 0, 0]))
    work = refiner(pyramid)
    assert work.refine_finest(work.coarse_to_fine(start, 0.0)) is None


def test_cells_read_with_the_true_pose_agree_and_with_another_do_not():
    _, pyramid, pose = near_view()
    work = refiner(pyramid)
    right = work.read(BLUE, MovingPose(pose))
    wrong = work.read(BLUE, MovingPose(look_at_pad(600.0, target_mm=(170, 90))))
    assert right is not None
    assert wrong is not None
    assert right.evidence.kappa > 0.95
    assert not wrong.evidence.suffices(-6)
    away = work.read(BLUE, MovingPose(look_at_pad(600.0, target_mm=(9000, 0))))
    assert away is None


def test_fewer_places_make_the_same_cells_surer():
    _, pyramid, pose = near_view()
    blind, expected = (refiner(pyramid, n).read(BLUE, MovingPose(pose)) for n in (5, 0))
    assert expected.evidence.log10_false_alarm < blind.evidence.log10_false_alarm


def test_the_measured_layer_is_chosen_where_its_cells_suffice():
    _, pyramid, pose = near_view()
    work = refiner(pyramid)
    reads = [work.read(layer, MovingPose(pose)) for layer in (RED, BLUE)]
    for layer in (RED, BLUE):
        choice = choose(reads, layer, -6.0)
        assert isinstance(choice, Choice)
        assert choice.read.layer is layer
    nothing = choose([], RED, -6.0)
    assert isinstance(nothing, StageFailure)
    assert nothing.reason is Reason.TOO_FEW_CELLS
    doubtful = choose(reads, RED, -100_000.0)
    assert isinstance(doubtful, StageFailure)
    assert doubtful.reason is Reason.UNKNOWN_CODE
    assert "differ from the pad" in doubtful.detail


@pytest.mark.parametrize("heading_deg", [15.0, 105.0, 195.0, 285.0])
def test_a_far_signs_turn_is_told_by_its_cells(heading_deg):
    pose = look_at_pad(7500.0, tilt_deg=10, heading_deg=heading_deg, tilt_towards_deg=100)
    pyramid = Pyramid(frame_of(pose, camera=CAMERA))
    found = find_whole_sign(refiner(pyramid), find_regions(pyramid, sample_pad())[0])
    assert isinstance(found, WholeSign)
    assert errors(found.fit.pose.pose, pose)[1] < 3


def test_a_far_sign_of_another_pad_is_not_this_one():
    pose = look_at_pad(7000.0, tilt_deg=10, heading_deg=15)
    pyramid = Pyramid(frame_of(pose, camera=CAMERA, pad=random_pad(9)))
    found = find_whole_sign(refiner(pyramid), find_regions(pyramid, sample_pad())[0])
    assert isinstance(found, StageFailure)


def search_in(image):
    from padstudio.vision.frame.prepare import find_stretch
    from padstudio.vision.search.known_pads import KnownPad

    pyramid = Pyramid(image)
    known = (KnownPad.of(sample_pad()),)
    frame = Search(pyramid, CAMERA, find_stretch(pyramid), known, params(), recorder())
    return frame, list(sightings(frame, find_regions(pyramid, sample_pad())))


def test_the_search_sees_the_pad_at_its_true_place():
    image, _, pose = near_view()
    frame, found = search_in(image)
    first = found[0]
    assert isinstance(first, Sighting)
    at = np.array([[0.0, 0.0], [2.0, 1.0]])
    there = np.column_stack([at, np.ones(2)]) @ first.placement.pad_from_lattice.T
    points = lattice_mm(sample_pad(), first.placement.layer, there)
    seen = MovingPose(pose).project(CAMERA, points)
    np.testing.assert_allclose(CAMERA.denormalize(first.lattice.to_rays(at)), seen, atol=4.0)
    assert len(frame.lattices) >= 1


def test_few_cells_that_agree_are_joined_by_those_around_them():
    """A region of one colour may hold a part of the cells in view; its lattice reaches farther."""
    image = frame_of(look_at_pad(140.0, heading_deg=12, target_mm=(40, 25)), camera=CAMERA)
    frame, found = search_in(image)
    sighting = found[0]
    assert isinstance(sighting, Sighting)
    layer = sighting.placement.layer
    whole = sighting.lattice
    middle = [sum(ends) // 2 for ends in (whole.columns, whole.rows)]
    narrow = replace(whole, columns=(middle[0] - 2, middle[0] + 1), rows=(middle[1] - 2, middle[1]))
    again = place(frame, narrow, sighting.region)
    assert isinstance(again, Sighting)
    assert again.placement.layer is layer
    assert again.placement.evidence.read > 5 * 3 * 2
    np.testing.assert_allclose(
        again.placement.pad_from_lattice, sighting.placement.pad_from_lattice, atol=1e-9
    )


def test_cells_toward_the_horizon_do_not_hide_the_near_ones():
    """Most cells in view are too small to be read; those below the camera are not."""
    pad = random_pad(3, cells=(250,), cell_mm=(10.0,), channels=("red",))
    pose = look_at_pad(330.0, tilt_deg=55, heading_deg=20, target_mm=(-700, 300))
    image = frame_of(pose, pad=pad, camera=CAMERA)
    start = MovingPose(pose).moved(np.array([1.0, -1.0, 0.5, 0.001, -0.001, 0.002]))
    work = refiner(Pyramid(image), pad=pad)
    found = work.refine_finest(work.coarse_to_fine(start, np.inf))
    assert found is not None
    assert errors(found.fit.pose.pose, pose)[0] < 0.5
    assert found.read.evidence.wrong < 0.05 * found.read.evidence.read
    assert found.read.cells.seen.mean() < 0.5


def test_a_search_in_vain_ends_with_what_came_nearest():
    image = frame_of(look_at_pad(900.0), pad=random_pad(5), camera=CAMERA)
    _, found = search_in(image)
    assert found[-1].failure.reason in {Reason.UNKNOWN_CODE, Reason.TOO_FEW_CELLS}
    assert "cells" in found[-1].failure.detail


def test_what_a_camera_sees_of_a_layer():
    pose = look_at_pad(300.0, tilt_deg=15, heading_deg=30, target_mm=(100, 50))
    rows, cols = visible_range(sample_pad(), RED, CAMERA, pose)
    every = np.stack(np.meshgrid(np.arange(125) + 0.5, np.arange(125) + 0.5), -1).reshape(-1, 2)
    points = lattice_mm(sample_pad(), RED, every)
    pixels = MovingPose(pose).project(CAMERA, points)
    seen = (pixels >= 0).all(axis=1) & (pixels <= [639, 479]).all(axis=1)
    inside = (every >= [cols[0], rows[0]]).all(axis=1) & (every < [cols[1], rows[1]]).all(axis=1)
    assert inside[seen].all()
    column, row = lattice_of(sample_pad(), RED, points).T
    np.testing.assert_allclose(np.column_stack([column, row]), every, atol=1e-9)
    up = look_at_pad(300.0, tilt_deg=89.9, target_mm=(1e6, 0), tilt_towards_deg=90)
    (r0, r1), (c0, c1) = visible_range(sample_pad(), RED, CAMERA, up)
    assert r0 == r1 or c0 == c1
