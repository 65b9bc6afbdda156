"""One flight exported by the server's code and by the command line: the same bytes."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from command_line import run
from two_videos import CAMERA, FPS, FRAMES, NAMES, TwoVideos, here

from padstudio.flights.exports.forms import FORMS
from padstudio.flights.exports.from_flight import export_flight
from padstudio.flights.exports.options import ExportChoices
from padstudio.flights.exports.vehicle import VehicleTrack
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
    assert _by_command_line(flown[0].folder, form, monkeypatch) == _by_server(flown, form)


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
