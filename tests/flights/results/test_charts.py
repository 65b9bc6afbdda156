"""What charts of a flight show is what its frames say, thinned."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from known_flights import store_flight
from sqlalchemy.orm import Session, sessionmaker

from padstudio.flights.results.charts import FigureRows
from padstudio.store.database.flight_tables import FlightRow


def test_a_flight_without_results_has_empty_figures(session: sessionmaker[Session]) -> None:
    flight, _ = store_flight(session, first=7, frames=0)
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
