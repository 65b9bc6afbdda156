"""The timeline holds every frame of a flight once, whatever it is made of."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from known_flights import FRAMES, store_flight
from sqlalchemy.orm import Session, sessionmaker

from padstudio.flights.results.charts import FigureRows
from padstudio.flights.results.timeline import OUTCOMES
from padstudio.store.database.flight_tables import FlightRow


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
    flight, _ = store_flight(session, first=40, stride=12, frames=301)
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
    flight, rows = store_flight(session, first=first, stride=stride, frames=1207)
    found = FigureRows(session).timeline(flight, 4, first + 150 * stride)
    assert found["first_frame"] == first + 100 * stride
    assert found["frames_per_column"] == 300 * stride
    frames = [sum(column["outcomes"]) for column in found["columns"]]
    assert frames == [300, 300, 300, 207]
    assert found["columns"][1]["first_frame"] == rows[400]["number"]
