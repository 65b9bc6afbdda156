"""The frames of the paper's experiments: of the paper's sizes, each its own, always the same."""

from __future__ import annotations

import numpy as np
import pytest

from padstudio.errors import SpecError
from padstudio.experiments.reproduction import plan
from padstudio.experiments.reproduction.experiment import wanted
from padstudio.experiments.reproduction.plan import EXPERIMENTS, PLACES, SEEDS, Shot, shots_of


def test_pad_and_camera_are_the_papers() -> None:
    pad, camera = plan.paper_pad(), plan.paper_camera()
    assert pad.size_mm == (1250.0, 1250.0)
    assert [(layer.channel, layer.cell_mm, layer.rows) for layer in pad.layers] == [
        ("red", 10.0, 125),
        ("blue", 50.0, 25),
    ]
    assert (pad.window, pad.levels) == (5, 2)
    assert (camera.width, camera.height, camera.focal_px) == (2720, 1530, 1886)


def test_each_frame_is_taken_once() -> None:
    shots = shots_of(EXPERIMENTS, SEEDS)
    assert len({(s.series, s.place, s.seed) for s in shots}) == len(shots)
    assert len(shots) == SEEDS * sum(len(places) for places in PLACES.values())
    # Of the ranges the same frames, and each layer by itself.
    assert shots_of(["ranges"], 2) == [s for s in shots if s.series == "vertical" and s.seed < 2]
    assert not any(s.by_layer for s in shots_of(["vertical"], 2))
    assert shots_of(["stages"], 2) == []


def test_frames_differ_from_seed_to_seed_and_not_from_time_to_time() -> None:
    a, b = Shot("horizontal", 2, 0), Shot("horizontal", 2, 1)
    assert np.array_equal(plan.pose_of(a).position_mm, plan.pose_of(a).position_mm)
    assert plan.pose_of(a).heading_deg != plan.pose_of(b).heading_deg
    assert plan.imaging_of(a) != plan.imaging_of(b)
    assert plan.scene_of(a).light != plan.scene_of(b).light
    assert plan.noise_of(a) != plan.noise_of(b)


@pytest.mark.parametrize("series", PLACES)
def test_cameras_are_near_their_places(series: plan.ExperimentName) -> None:
    for place, where in enumerate(PLACES[series]):
        pose = plan.pose_of(Shot(series, place, 3))
        assert abs(pose.position_mm[2] - where.height_mm) <= 10
        assert abs(pose.tilt_deg - where.tilt_deg) <= 2
        axis = pose.rotation[:, 2]
        meets = pose.position_mm - axis * pose.position_mm[2] / axis[2]
        assert np.abs(meets[:2] - (where.x_mm, where.y_mm)).max() <= 10


def test_a_rail_moves_by_whole_cells_and_a_flight_keeps_its_heading() -> None:
    places = range(len(PLACES["continuity"]))
    rail = np.array([plan.pose_of(Shot("continuity", k, 5)).position_mm for k in places])
    assert np.diff(rail, axis=0) == pytest.approx(np.tile((10.0, 0.0, 0.0), (len(rail) - 1, 1)))
    flight = [plan.pose_of(Shot("landing", k, 5)) for k in range(len(PLACES["landing"]))]
    up = np.array([np.radians(pose.heading_deg) for pose in flight])
    assert np.cos(up - up[0]).min() > np.cos(np.radians(3))


@pytest.mark.parametrize("seeds", [0, plan.MOST_SEEDS + 1])
def test_seeds_have_bounds(seeds: int) -> None:
    with pytest.raises(SpecError, match="seeds"):
        shots_of(["vertical"], seeds)


def test_experiments_are_known_by_name() -> None:
    assert wanted(["landing", "ranges"]) == ["ranges", "landing"]
    assert wanted([]) == list(EXPERIMENTS)
    with pytest.raises(SpecError, match="no experiment 'flight'; choose from stages"):
        wanted(["flight"])
