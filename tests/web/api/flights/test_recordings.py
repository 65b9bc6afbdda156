"""Recordings of robots over REST: the same poses as on the command line, and every picture."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
import pytest
import recordings as made
from command_line import run
from flight_api import API, Api
from places import FOOTAGE
from recordings import START_NS, STEP_NS, TOPIC, Scene

from padstudio.geometry.camera import Camera

FRAMES = 4
OTHER = "/up/image_raw"
Refused = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module")
def frames() -> list[made.Image]:
    """Frames of the landing in half its size."""
    found = []
    with av.open(str(FOOTAGE / "flights" / "landing.mp4")) as container:
        for number, frame in zip(range(30 + FRAMES), container.decode(video=0), strict=False):
            if number >= 30:
                small = frame.reformat(frame.width // 2, frame.height // 2, "bgr24")
                found.append(np.asarray(small.to_ndarray(), np.uint8))
    return found


@pytest.fixture(scope="module")
def bag(frames: list[made.Image], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A ROS 2 bag's folder, zipped."""
    height, width = frames[0].shape[:2]
    camera = Camera.load(FOOTAGE / "camera_drone_2k7.yaml").for_frame(width, height)
    scene = Scene(made.shots(FRAMES), "compressed", paint=lambda n: frames[n], camera=camera)
    folder = made.write_bag2(tmp_path_factory.mktemp("bag") / "flight", scene)
    path = folder.with_suffix(".zip")
    with zipfile.ZipFile(path, "w") as archive:
        for file in folder.iterdir():
            archive.write(file, f"flight/{file.name}")
    return path


def test_a_bag_gives_what_it_gives_on_the_command_line(
    api: Api, bag: Path, frames: list[made.Image]
) -> None:
    upload = api.upload(bag.read_bytes(), "flight.zip")
    assert api.client.get(f"{API}/uploads/{upload}").json()["kind"] == "recording"
    ordered = api.order(upload, camera=None, fuse=False).raise_for_status().json()
    flight = api.finished(ordered["id"])
    assert (flight["state"], flight["frames_ok"]) == ("done", FRAMES), flight["error"]
    assert flight["request"]["camera_name"] == f"recorded with {TOPIC}"
    (source,) = flight["sources"]
    assert (source["kind"], source["recording"]["topic"]) == ("recording", TOPIC)
    assert source["video"]["container"] == "rosbag2"

    told = api.get(f"{flight['id']}/frames?limit=100")["items"]
    folder = bag.with_suffix("")
    result = run("detect", "--pad", FOOTAGE / "pad_a.json", folder, "--no-fuse", "-q", "-o", "-")
    assert result.exit_code == 0, result.stderr
    lines = [json.loads(line) for line in result.stdout.splitlines()]
    for number, (found, line) in enumerate(zip(told, lines, strict=True)):
        assert found["frame"] == line["frame"] == number
        assert found["stamp_ns"] == line["stamp_ns"] == START_NS + number * STEP_NS
        assert found["topic"] == line["topic"] == TOPIC
        for name in ("time_s", "position_mm", "quaternion_xyzw", "position_sigma_mm"):
            assert found[name] == line[name]

    address = f"{API}/flights/{flight['id']}/frames/2"
    stages = api.client.get(f"{address}/stages").raise_for_status().json()
    height, width = frames[0].shape[:2]
    assert stages["image"] == {"width": width, "height": height}
    picture = api.client.get(f"{address}/pictures/frame.png").raise_for_status().content
    shown = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR)
    assert np.array_equal(shown, frames[2])
    assert api.client.get(f"{API}/flights/{flight['id']}/proxies/0").status_code == 200


def test_a_topic_is_chosen_from_those_there_are(api: Api, tmp_path: Path, refused: Refused) -> None:
    scene = Scene(made.shots(2), "compressed", topics=(TOPIC, OTHER))
    path = made.write_mcap(tmp_path / "a.mcap", scene)
    upload = api.upload(path.read_bytes(), "a.mcap")
    error = refused(api.order(upload), 422, "several_topics")
    assert error["message"].startswith("a.mcap: the recording holds 2 topics with pictures: ")
    assert error["detail"] == {"topics": [TOPIC, OTHER]}
    refused(api.order(upload, topic="/none"), 422, "unknown_topic")
    refused(api.order(upload, topic=OTHER, camera=None), 422, "camera_required")
    refused(api.order(camera=None), 422, "camera_required")
    refused(api.order(upload, api.video, topic=OTHER, camera=None), 422, "camera_required")


def test_a_topic_is_of_recordings(api: Api, refused: Refused) -> None:
    upload = api.upload((FOOTAGE / "stills" / "a_cast0_1300.jpg").read_bytes(), "still.jpg")
    error = refused(api.order(upload, topic=TOPIC), 422, "no_recording")
    assert "leave it out" in error["message"]


def test_any_frame_of_a_video_stream_is_shown(api: Api, tmp_path: Path) -> None:
    path = made.write_mcap(tmp_path / "stream.mcap", Scene(kind="video"))
    upload = api.upload(path.read_bytes(), "stream.mcap")
    matrix = [[200.0, 0, 96], [0, 200, 64], [0, 0, 1]]
    camera = Camera(made.videos.WIDTH, made.videos.HEIGHT, matrix)
    stored = api.post_file("/cameras", "small.yaml", camera.to_ros_yaml().encode())
    ordered = api.order(upload, camera=stored).raise_for_status().json()
    flight = api.finished(ordered["id"])
    assert (flight["state"], flight["frames_total"]) == ("done", 12), flight["error"]
    address = f"{API}/flights/{flight['id']}/frames"
    for number in (7, 3, 11):
        picture = api.client.get(f"{address}/{number}/pictures/frame.png").raise_for_status()
        shown = cv2.imdecode(np.frombuffer(picture.content, np.uint8), cv2.IMREAD_COLOR)
        assert made.videos.number_of(shown) == number
        assert api.get(f"{flight['id']}/frames/{number}")["stamp_ns"] == START_NS + number * STEP_NS
