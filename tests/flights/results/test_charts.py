from __future__ import annotations

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sqlalchemy.orm import Session, sessionmaker

from padstudio.flights.results.charts import OUTCOMES, FigureRows
from padstudio.flights.results.rows import insert_rows
from padstudio.store.database.engine import Sessions, open_database
from padstudio.store.database.flight_tables import FlightRow

FRAMES = 5003
FPS = 25
LAYERS = ("red", "blue", "outline")
# A camera that looks straight down, turned by a half turn about X.
DOWN_XYZW = [1.0, 0.0, 0.0, 0.0]


@pytest.fixture(scope="module")
def session(
    tmp_path_factory: pytest.TempPathFactory, new_database: Callable[[], str | None]
) -> Iterator[sessionmaker[Session]]:
    folder = tmp_path_factory.mktemp("figures")
    engine = open_database(new_database() or f"sqlite:///{folder}/studio.db")
    yield Sessions(engine)
    engine.dispose()


def _frame(key: int, number: int, place: int) -> dict[str, Any]:
    failed = place % 7 == 3
    return {
        "flight": key,
        "number": number,
        "time_s": number / FPS,
        "status": "failed" if failed else "ok",
        "stage": ("grid", "lines")[place % 2] if failed else None,
        "reason": "no_lattice" if failed else None,
        "layer": None if failed else LAYERS[place % 3],
        "quality": None if failed else "bearing" if place % 5 == 1 else "full",
        "x_mm": None if failed else float(place),
        "y_mm": None if failed else -float(place),
        "z_mm": None if failed else 5000.0 - place / 2,
    }


def _store(
    session: sessionmaker[Session], *, first: int = 0, stride: int = 1, frames: int = FRAMES
) -> tuple[FlightRow, list[dict[str, Any]]]:
    """A flight with frames of known outcome; where the telemetry's heights are 5 % too small."""
    telemetry = {
        "time_s": [0.0, FRAMES * stride / FPS],
        "height_m": [5.0 / 1.05, (5.0 - FRAMES / 2000) / 1.05],
    }
    flight = FlightRow(
        id=f"flight-{first}-{stride}-{frames}",
        created_at=datetime.now(UTC),
        name="flight",
        state="done",
        request={"first_frame": first, "stride": stride},
        sources=[],
        pad="",
        camera="",
        telemetry=telemetry,
    )
    with session.begin() as open_session:
        open_session.add(flight)
        open_session.flush()
        rows = [_frame(flight.key, first + place * stride, place) for place in range(frames)]
        if rows:
            details = [
                {"flight": flight.key, "number": row["number"], "chunk": 1,
                 "body": {"quaternion_xyzw": DOWN_XYZW}}
                for row in rows
            ]  # fmt: skip
            insert_rows(open_session, flight.request, rows, details)
    return flight, rows


@pytest.fixture(scope="module")
def flown(session: sessionmaker[Session]) -> tuple[FlightRow, list[dict[str, Any]]]:
    return _store(session)


@pytest.mark.parametrize("columns", [1, 7, 100, 5000])
def test_columns_hold_every_frame_once(
    session: sessionmaker[Session],
    flown: tuple[FlightRow, list[dict[str, Any]]],
    columns: int,
) -> None:
    flight, rows = flown
    found = FigureRows(session).timeline(flight, columns)
    assert len(found["columns"]) <= columns
    assert (found["first_frame"], found["last_frame"]) == (0, FRAMES - 1)
    counted = np.sum([column["outcomes"] for column in found["columns"]], axis=0)
    outcomes = [
        "bearing" if row["quality"] == "bearing" else row["layer"] or "failed" for row in rows
    ]
    truth = [outcomes.count(outcome) for outcome in OUTCOMES]
    assert counted.tolist() == truth
    width = found["frames_per_column"]
    for column in found["columns"]:
        mine = rows[column["column"] * width : (column["column"] + 1) * width]
        heights = [row["z_mm"] for row in mine if row["z_mm"] is not None]
        assert (column["first_frame"], column["last_frame"]) == (
            mine[0]["number"],
            mine[-1]["number"],
        )
        ends = (min(heights), max(heights)) if heights else (None, None)
        assert (column["z_min_mm"], column["z_max_mm"]) == ends
        assert column["time_s"] == mine[0]["time_s"]
        failing = [row["stage"] for row in mine if row["stage"]]
        assert column["stages"] == {stage: failing.count(stage) for stage in set(failing)}


def test_a_part_in_the_columns_of_the_page(
    session: sessionmaker[Session], flown: tuple[FlightRow, list[dict[str, Any]]]
) -> None:
    found = FigureRows(session).timeline(flown[0], 50, 1000, 1099)
    assert found["frames_per_column"] == 2
    assert [column["first_frame"] for column in found["columns"]] == list(range(1000, 1100, 2))


def test_strides_leave_no_column_empty(session: sessionmaker[Session]) -> None:
    flight, _ = _store(session, first=40, stride=12, frames=301)
    found = FigureRows(session).timeline(flight, 100)
    assert found["frames_per_column"] % 12 == 0
    places = [column["column"] for column in found["columns"]]
    assert places == list(range(len(places)))
    counts = {sum(column["outcomes"]) for column in found["columns"][:-1]}
    assert len(counts) == 1


@pytest.mark.parametrize(("first", "stride"), [(40, 12), (7, 1)])
def test_wide_columns_hold_whole_hundreds_from_the_first_frame(
    session: sessionmaker[Session], first: int, stride: int
) -> None:
    flight, rows = _store(session, first=first, stride=stride, frames=1207)
    found = FigureRows(session).timeline(flight, 4, first + 150 * stride)
    assert found["first_frame"] == first + 100 * stride
    assert found["frames_per_column"] == 300 * stride
    frames = [sum(column["outcomes"]) for column in found["columns"]]
    assert frames == [300, 300, 300, 207]
    assert found["columns"][1]["first_frame"] == rows[400]["number"]


def test_a_flight_without_results_has_empty_figures(session: sessionmaker[Session]) -> None:
    flight, _ = _store(session, first=7, frames=0)
    assert FigureRows(session).timeline(flight, 10)["columns"] == []
    found = FigureRows(session).figures(flight)
    assert found["samples"] == []
    assert found["trajectory"]["frame"] == []
    assert found["heights"] is None


def test_the_trajectory_is_thinned_and_keeps_its_gaps(
    session: sessionmaker[Session], flown: tuple[FlightRow, list[dict[str, Any]]]
) -> None:
    flight, rows = flown
    found = FigureRows(session).figures(flight, points=400)["trajectory"]
    assert 350 < len(found["frame"]) <= 400
    for place, number in enumerate(found["frame"]):
        for name in ("time_s", "x_mm", "y_mm", "z_mm", "quality"):
            assert found[name][place] == rows[number][name]
    assert None in found["z_mm"]


def test_samples_look_where_the_camera_looked_and_failed_ones_are_bare(
    session: sessionmaker[Session], flown: tuple[FlightRow, list[dict[str, Any]]]
) -> None:
    flight, rows = flown
    samples = FigureRows(session).figures(flight, samples=40)["samples"]
    assert [sample["number"] for sample in samples] == list(range(1, 41))
    for sample in samples:
        row = rows[sample["frame"]]
        assert ("axis" in sample) == (row["status"] == "ok")
        if "axis" in sample:
            assert sample["quality"] == row["quality"]
            assert sample["axis"] == pytest.approx([0, 0, -1])
            assert sample["position_mm"] == [row["x_mm"], row["y_mm"], row["z_mm"]]


def test_heights_are_compared_at_the_times_of_the_poses(
    session: sessionmaker[Session], flown: tuple[FlightRow, list[dict[str, Any]]], tmp_path: Path
) -> None:
    heights = FigureRows(session).figures(flown[0])["heights"]
    assert heights["fit"]["slope"] == pytest.approx(1.05, abs=1e-3)
    assert heights["fit"]["verdict"] == "too_high"
    assert None not in heights["pose_mm"]
    # A height that is not known to be true is not compared.
    rows = {row["number"]: row for row in flown[1]}
    assert {rows[number]["quality"] for number in heights["frame"]} == {"full"}
    flown[0].telemetry, kept = None, flown[0].telemetry
    try:
        assert FigureRows(session).figures(flown[0])["heights"] is None
    finally:
        flown[0].telemetry = kept
