"""A flight of two videos, exported by server and command line alike, read by the real programs."""

from __future__ import annotations

import base64
import io
import json
import os
import re
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from command_line import run
from mcap.reader import make_reader
from two_videos import CAMERA, FPS, FRAMES, NAMES, TwoVideos, here

from padstudio.autopilot.vehicle import VehicleTrack
from padstudio.flights.exports.forms import FORMS
from padstudio.flights.exports.from_flight import export_flight
from padstudio.flights.exports.options import ExportChoices
from padstudio.flights.results.frames import Results
from padstudio.store.database.flight_tables import FlightRow
from padstudio.store.store import Store
from padstudio.vision.stage.trace import Recorder

TRACK = "time_s,north_m,east_m,down_m,qw,qx,qy,qz\n" + "".join(
    f"{k / 10},{k},0,-3,1,0,0,0\n" for k in range(12)
)


@pytest.fixture(scope="module")
def flown(
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[tuple[TwoVideos, FlightRow, Results]]:
    """The flight by the command line (poses.jsonl) and by the server."""
    folder = tmp_path_factory.mktemp("flight")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Recorder, "elapsed_ms", lambda self: {"total": 1.0})
        patch.chdir(folder)
        flight = TwoVideos.write(folder)
        flight.by_command_line()
        store = Store(folder / "data")
        row = flight.by_server(store)
        (folder / "vehicle.csv").write_text(TRACK)
        yield flight, row, Results(store.session)
        store.close()


def _by_server(flown: tuple[TwoVideos, FlightRow, Results], form: str) -> bytes:
    _, row, results = flown
    track = VehicleTrack.from_csv(TRACK.splitlines()) if form == "px4" else None
    choices = ExportChoices(form=form, images=form == "mcap", start_unix_s=1e9, vehicle=track)
    return b"".join(export_flight(row, results, choices, here, 10**7))


def _by_command_line(folder: Path, form: str, monkeypatch: pytest.MonkeyPatch) -> bytes:
    monkeypatch.chdir(folder)
    more = ["--images"] if form == "mcap" else []
    more += ["--vehicle", "vehicle.csv"] if form == "px4" else []
    result = run(
        *("export", "poses.jsonl", "--form", form, "--camera", "camera.yaml", "--pad", "pad.json"),
        *("--start-unix-s", "1e9", *more),
    )
    assert result.exit_code == 0, result.stderr
    return result.stdout_bytes


@pytest.mark.parametrize("form", FORMS)
def test_server_and_command_line_write_the_same_bytes(
    flown: tuple[TwoVideos, FlightRow, Results], form: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # What decided on a run is on a server known of its flight.
    here = re.sub(
        rb', "run": "[0-9a-f]+"', b"", _by_command_line(flown[0].folder, form, monkeypatch)
    )
    assert here == _by_server(flown, form)


def test_two_videos_are_one_flight_on_one_clock(
    flown: tuple[TwoVideos, FlightRow, Results],
) -> None:
    flight, row, _ = flown
    lines = [json.loads(line) for line in (flight.folder / "poses.jsonl").read_text().splitlines()]
    assert [line["frame"] for line in lines] == list(range(2 * FRAMES))
    assert [line["source"] for line in lines] == [name for name in NAMES for _ in range(FRAMES)]
    assert [line["time_s"] for line in lines] == pytest.approx(np.arange(2 * FRAMES) / FPS)
    # Truth, where the picture is whole.
    assert row.frames_ok > FRAMES
    damaged = [line for line in lines if line.get("damaged") or line["status"] == "failed"]
    assert damaged
    for line in lines[:FRAMES]:
        true = flight.positions_mm[line["frame"]]
        assert line["position_mm"] == pytest.approx(true, abs=0.02 * true[2])


def test_cameras_are_of_the_frames_size(flown: tuple[TwoVideos, FlightRow, Results]) -> None:
    with zipfile.ZipFile(io.BytesIO(_by_server(flown, "colmap"))) as archive:
        *_, line = archive.read("cameras.txt").decode().splitlines()
        names = [
            each.split()[-1]
            for each in archive.read("images.txt").decode().splitlines()
            if each.endswith(".png")
        ]
    assert line.split()[:4] == ["1", "PINHOLE", "640", "480"]
    focal, _, centre, _ = map(float, line.split()[4:])
    assert (focal, centre) == pytest.approx((CAMERA.matrix[0, 0], CAMERA.matrix[0, 2] + 0.5))
    assert names[:2] == ["first/000000.png", "first/000001.png"]
    assert len(set(names)) == len(names)


def _poses(flown: tuple[TwoVideos, FlightRow, Results]) -> list[dict[str, Any]]:
    lines = (flown[0].folder / "poses.jsonl").read_text().splitlines()
    return [each for each in map(json.loads, lines) if each.get("quality") == "full"]


def test_evo_compares_the_trajectory_with_the_truth(
    flown: tuple[TwoVideos, FlightRow, Results], tmp_path: Path
) -> None:
    (tmp_path / "flight.txt").write_bytes(_by_server(flown, "tum"))
    truth = [
        f"{1e9 + k / FPS:.6f} {' '.join(str(mm / 1000) for mm in position)} 0 0 0 1"
        for k, position in enumerate(flown[0].positions_mm)
    ]
    (tmp_path / "truth.txt").write_text("\n".join(truth))
    command = [Path(sys.executable).parent / "evo_ape", "tum", "truth.txt", "flight.txt"]
    home = {"HOME": str(tmp_path), "MPLBACKEND": "Agg", "PATH": os.environ["PATH"]}
    done = subprocess.run(
        [*command, "--save_results", "out.zip"], cwd=tmp_path, env=home, capture_output=True
    )
    assert done.returncode == 0, done.stderr.decode()
    with zipfile.ZipFile(tmp_path / "out.zip") as archive:
        stats = json.loads(archive.read("stats.json"))
    off = [
        np.subtract(each["position_mm"], flown[0].positions_mm[each["frame"]]) / 1000
        for each in _poses(flown)
    ]
    assert stats["rmse"] == pytest.approx(np.sqrt(np.mean(np.sum(np.square(off), 1))), rel=1e-4)
    assert stats["max"] < 0.05


def test_pycolmap_reads_the_model(
    flown: tuple[TwoVideos, FlightRow, Results], tmp_path: Path
) -> None:
    import pycolmap

    with zipfile.ZipFile(io.BytesIO(_by_server(flown, "colmap"))) as archive:
        archive.extractall(tmp_path)
    model = pycolmap.Reconstruction(str(tmp_path))
    (camera,) = model.cameras.values()
    assert (camera.width, camera.height) == (640, 480)
    images = {image.name: image for image in model.images.values()}
    poses = _poses(flown)
    assert len(images) == len(poses)
    for each in poses:
        name = f"{each['source'].removesuffix('.mp4')}/{each['frame']:06d}.png"
        seen = images[name]
        centre_mm = 1000 * seen.projection_center()
        assert centre_mm == pytest.approx(each["position_mm"], abs=1e-5)
        # The pad's corner, by COLMAP's own camera and by ours.
        corner = np.array([0.3, 0.3, 0.0])
        inside = seen.cam_from_world() * corner
        own = (1000 * corner - each["position_mm"]) @ np.array(each["rotation"])
        pixel = np.ravel(camera.img_from_cam(inside))
        assert pixel - 0.5 == pytest.approx(CAMERA.project(own)[0], abs=1e-4)


def test_no_form_has_a_time_twice(
    flown: tuple[TwoVideos, FlightRow, Results], tmp_path: Path
) -> None:
    from pymavlink import mavutil

    times = [1e9 + each["time_s"] for each in _poses(flown)]
    table = np.loadtxt(io.BytesIO(_by_server(flown, "tum")))
    assert table[:, 0] == pytest.approx(times, abs=1e-6)
    for form in ("ardupilot", "px4"):
        (tmp_path / form).write_bytes(_by_server(flown, form))
        log = mavutil.mavlink_connection(str(tmp_path / form), dialect="common")
        told = []
        while (message := log.recv_match(type="LANDING_TARGET")) is not None:
            told.append(message.time_usec / 1e6)
        log.close()
        assert set(times) <= {round(each, 6) for each in told}
        assert (np.diff(told) > 0).all()


def test_logs_have_calibrations_of_their_pictures(
    flown: tuple[TwoVideos, FlightRow, Results],
) -> None:
    reader = make_reader(io.BytesIO(_by_server(flown, "mcap")))
    topics: dict[str, list[tuple[int, dict[str, Any]]]] = {}
    for _, channel, message in reader.iter_messages():
        told = json.loads(message.data)
        topics.setdefault(channel.topic, []).append((message.log_time, told))
    calibrations, pictures = topics["/camera/calibration"], topics["/camera/image"]
    assert {(told["width"], told["height"]) for _, told in calibrations} == {(640, 480)}
    for _, told in pictures:
        data = np.frombuffer(base64.b64decode(told["data"]), np.uint8)
        assert cv2.imdecode(data, cv2.IMREAD_COLOR).shape == (480, 640, 3)
    for messages in topics.values():
        assert (np.diff([at for at, _ in messages]) > 0).all()
    assert len(calibrations) == 2 * FRAMES


def test_foxglove_knows_every_field(flown: tuple[TwoVideos, FlightRow, Results]) -> None:
    seen = set()
    for schema, _, message in make_reader(io.BytesIO(_by_server(flown, "mcap"))).iter_messages():
        assert schema is not None
        maker, _, name = schema.name.partition(".")
        if maker == "foxglove":
            _foxglove(name, json.loads(message.data))
            seen.add(name)
    assert seen == {
        *("CameraCalibration", "CompressedImage", "FrameTransform", "ImageAnnotations"),
        "PoseInFrame",
    }


# What fields hold that are messages themselves; their names are of no use to who reads JSON.
_NESTED = {
    "timestamp": "Timestamp",
    "pose": "Pose",
    "rotation": "Quaternion",
    "orientation": "Quaternion",
    "translation": "Vector3",
    "texts": "TextAnnotation",
    "text_color": "Color",
    "background_color": "Color",
    "outline_color": "Color",
    "outline_colors": "Color",
    "fill_color": "Color",
}


def _foxglove(name: str, told: dict[str, Any]) -> Any:
    """The message as Foxglove's own class, which takes no field that it does not know."""
    from foxglove import messages

    nested = _NESTED | {
        "points": "PointsAnnotation" if name == "ImageAnnotations" else "Point2",
        "position": "Point2" if name == "TextAnnotation" else "Vector3",
        "circles": "CircleAnnotation",
    }

    def made(field: str, value: Any) -> Any:
        if field == "data":
            return base64.b64decode(value)
        if field == "type":
            return messages.PointsAnnotationType.LineList
        if field not in nested:
            return value
        kind = nested[field]
        if isinstance(value, list):
            return [_foxglove(kind, each) for each in value]
        return _foxglove(kind, value)

    return getattr(messages, name)(**{field: made(field, value) for field, value in told.items()})
