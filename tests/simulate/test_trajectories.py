"""Simulated flights: paths, velocities, looks, and what is written with its truth."""

import json
import re
import subprocess
import sys
from dataclasses import replace

import cv2
import numpy as np
import pytest
from places import TESTS

from padstudio.errors import LimitError, SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import rotation_angle_deg
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.looks import LOOKS, dress
from padstudio.simulate.motion import Motion, poses_at
from padstudio.simulate.paths import motion_along
from padstudio.simulate.paths import wandering_path as path_of
from padstudio.simulate.radiance.scene import GROUND_KINDS, Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.trajectories import (
    FLIGHT_KINDS,
    MAX_FRAMES,
    Flight,
    FlightSpec,
    Setup,
    plan,
)
from padstudio.simulate.video_writer import VideoWriter
from padstudio.simulate.writer import write_flight

SCORE = TESTS / "benchmarks" / "score.py"


def camera(width=160, height=120):
    return Camera(width, height, np.array([[110.0, 0, 79.5], [0, 110.0, 59.5], [0, 0, 1]]))


def pad():
    field = np.random.default_rng(2).integers(0, 2, (20, 20)).astype(np.uint8)
    return Pad((Layer("red", 20.0, field),), window=4)


def flight(kind="landing", frames=5, **options):
    return plan(FlightSpec(kind=kind, frames=frames, from_mm=900.0, to_mm=200.0, **options))


@pytest.mark.parametrize("kind", FLIGHT_KINDS)
def test_flights_start_and_end_where_they_should_and_repeat(kind):
    course, again = flight(kind, seed=4), flight(kind, seed=4)
    assert len(course) == 5
    heights = [pose.position_mm[2] for pose in course.poses]
    start, end = {"hover": (900, 900), "tilts": (900, 900 * np.cos(np.radians(70)))}.get(
        kind, (900, 200)
    )
    assert heights[0] == pytest.approx(start)
    assert heights[-1] == pytest.approx(end)
    for a, b in zip(course.poses, again.poses, strict=True):
        assert np.array_equal(a.position_mm, b.position_mm)
        assert np.array_equal(a.rotation, b.rotation)
        assert np.allclose(a.rotation @ a.rotation.T, np.eye(3), atol=1e-12)
    other = flight(kind, seed=5)
    assert not np.array_equal(course.poses[0].rotation, other.poses[0].rotation)


def test_tilts_lean_from_0_to_70_degrees_at_one_distance():
    course = flight("tilts", frames=8)
    assert [round(pose.tilt_deg) for pose in course.poses] == list(range(0, 71, 10))
    axis_meets = [p.position_mm + p.rotation[:, 2] * 900.0 for p in course.poses]
    assert np.allclose(axis_meets, 0, atol=1e-9)


def test_velocities_carry_a_pose_along_its_path():
    path = path_of(np.random.default_rng(1), 2000.0, 300.0, 4.0, 3.0)
    for time in (0.4, 1.9, 3.3):
        motion = motion_along(path, time)
        rotation, position = poses_at(path(time), motion, np.array(0.004))
        after = path(time + 0.004)
        assert np.linalg.norm(position - after.position_mm) < 0.05
        assert np.linalg.norm(after.position_mm - path(time).position_mm) > 0.3
        assert rotation_angle_deg(rotation, after.rotation) < 0.01
        assert rotation_angle_deg(path(time).rotation, after.rotation) > 0.03


def test_gusts_move_the_camera_more():
    def speed(kind):
        course = flight(kind, frames=60)
        return np.mean([np.linalg.norm(m.angular_deg_s) for m in course.motions])

    assert speed("gusty") > 2 * speed("landing")


def test_stills_are_written_with_their_truth(tmp_path):
    done = []
    truth = write_flight(
        tmp_path / "out",
        flight("descent", 3),
        Setup(scene=Scene(pad=pad()), camera=camera()),
        progress=done.append,
    )
    records = json.loads(truth.read_text())
    assert done == [1, 2, 3]
    assert [r["file"] for r in records] == [f"stills/descent_{k}.jpg" for k in range(3)]
    poses = flight("descent", 3).poses
    for record, pose in zip(records, poses, strict=True):
        picture = cv2.imread(str(tmp_path / "out" / record["file"]))
        assert picture.shape == (120, 160, 3)
        assert np.allclose(record["position_mm"], pose.position_mm)
        assert np.allclose(record["rotation"], pose.rotation)
        assert record["camera"] == "camera.yaml"
    assert np.allclose(Camera.load(tmp_path / "out" / "camera.yaml").matrix, camera().matrix)
    assert np.array_equal(
        Pad.load(tmp_path / "out" / "pad.json").layers[0].field, pad().layers[0].field
    )


@pytest.mark.parametrize("codec", ["h264", "h265"])
def test_videos_are_written_with_their_truth(tmp_path, codec):
    course = flight("landing", 6, fps=25.0)
    setup = Setup(scene=Scene(pad=pad(), ground="concrete"), camera=camera(), seed=3)
    truth = write_flight(tmp_path, course, setup, codec=codec)
    data = json.loads(truth.read_text())
    assert data["fps"] == 25.0
    assert [f["frame"] for f in data["frames"]] == list(range(6))
    assert data["frames"][5]["time_s"] == pytest.approx(0.2)
    reader = cv2.VideoCapture(str(tmp_path / "flights" / "landing.mp4"))
    frames = [reader.read()[1] for _ in range(6)]
    assert not reader.read()[0]
    plain = Imaging(jpeg_quality=None)
    shot = next(course.frames(replace(setup, imaging=plain))).image
    difference = cv2.absdiff(frames[0], shot).mean()
    assert difference < 12
    assert cv2.absdiff(frames[5], shot).mean() > difference


def test_the_score_reads_what_was_written(tmp_path):
    for kind, video in (("descent", False), ("landing", True)):
        course = flight(kind, 3)
        setup = Setup(scene=Scene(pad=pad()), camera=camera())
        truth = write_flight(tmp_path, course, setup, codec="h264" if video else None)
        lines = [
            {
                "source": f"{kind}.mp4" if video else f"stills/{kind}_{k}.jpg",
                "frame": k if video else 0,
                "status": "ok",
                "position_mm": pose.position_mm.tolist(),
                "rotation": pose.rotation.tolist(),
            }
            for k, pose in enumerate(course.poses)
        ]
        poses = tmp_path / "poses.jsonl"
        poses.write_text("\n".join(json.dumps(line) for line in lines))
        command = [sys.executable, str(SCORE), str(truth), str(poses)]
        report = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        assert re.search(r"^all +3 +0 +0 +0$", report, re.MULTILINE)


def test_bare_ground_has_no_pose_in_its_truth(tmp_path):
    setup = Setup(scene=Scene(pad=None), camera=camera())
    truth = write_flight(tmp_path, flight("descent", 2), setup)
    assert all("position_mm" not in record for record in json.loads(truth.read_text()))
    assert not (tmp_path / "pad.json").exists()


def test_an_odd_size_is_no_video(tmp_path):
    with pytest.raises(SpecError, match="even size"):
        VideoWriter(tmp_path / "a.mp4", width=161, height=120, fps=30)
    assert list(tmp_path.iterdir()) == []


def test_half_a_video_is_removed(tmp_path):
    def stop(done):
        raise RuntimeError("stop")

    setup = Setup(scene=Scene(pad=pad(), ground="plain"), camera=camera())
    with pytest.raises(RuntimeError, match="stop"):
        write_flight(tmp_path, flight(), setup, codec="h264", progress=stop)
    assert list((tmp_path / "flights").iterdir()) == []


def test_limits_are_named():
    with pytest.raises(LimitError, match=str(MAX_FRAMES)) as caught:
        flight(frames=100_000)
    assert caught.value.error_code == "too_many_frames"
    with pytest.raises(SpecError, match="height lies above 1") as below:
        FlightSpec(kind="descent", frames=3, from_mm=100.0, to_mm=-5.0)
    assert below.value.error_code == "pose_below_ground"
    with pytest.raises(SpecError, match="choose one of descent"):
        flight("loop")
    with pytest.raises(SpecError, match="at least 1"):
        flight(frames=0)
    with pytest.raises(SpecError, match="fps"):
        flight(fps=0.0)


@pytest.mark.parametrize("look", sorted(LOOKS))
def test_every_look_changes_the_picture_and_shows_the_pad(look):
    scene, imaging = dress(Scene(pad=pad(), ground="concrete"), look, seed=2)
    pose = flight("hover", 1).poses[0]
    motion = Motion(velocity_mm_s=(400.0, 0.0, 0.0), angular_deg_s=(0.0, 0.0, 40.0))
    plain = render(Scene(pad=pad(), ground="concrete"), camera(), pose, motion=motion).image
    seen = render(scene, camera(), pose, imaging, motion=motion).image
    assert (look == "clear") == np.array_equal(seen, plain)
    assert seen[40:80, 60:100].std() > 3


def test_an_unknown_look_names_the_known():
    with pytest.raises(SpecError, match="clear, "):
        dress(Scene(pad=pad()), "foggy")


@pytest.mark.parametrize("ground", GROUND_KINDS)
def test_grounds_have_no_seam_and_differ_by_seed(ground):
    from padstudio.simulate.radiance.ground import SIZE, texture

    tile = texture(ground, 3).texels[: SIZE * SIZE].reshape(SIZE, SIZE, 3)
    inner = np.abs(np.diff(tile[:, SIZE // 2 - 1 : SIZE // 2 + 1, 1], axis=1)).mean()
    seam = np.abs(tile[:, 0, 1] - tile[:, -1, 1]).mean()
    assert seam <= 2.5 * inner + 1e-4
    levels = texture(ground, 3).texels
    assert np.allclose(levels[-1], tile.mean(axis=(0, 1), dtype=float), atol=1e-4)
    assert (ground == "plain") == np.array_equal(levels, texture(ground, 4).texels)


def test_a_flight_of_stills_has_no_times():
    course = flight("descent", 2)
    assert isinstance(course, Flight)
    assert course.time_s(1) is None
    assert flight("landing", 2, fps=20.0).time_s(1) == pytest.approx(0.05)
