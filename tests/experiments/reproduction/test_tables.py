"""Tables: truth, what was measured, the error, its spread, and what is missing."""

from __future__ import annotations

import math

import pytest
from synthetic_frames import frames_of, synthetic

from padstudio.experiments.report import Column
from padstudio.experiments.reproduction.charts import first_flight
from padstudio.experiments.reproduction.plan import PLACES, Shot, shots_of
from padstudio.experiments.reproduction.tables import ranges_table, samples_table, series_table


def test_a_series_has_truth_measured_error_and_spread() -> None:
    def dense_misses_one(kind: str, shot: Shot) -> bool:
        return kind == "paper" or shot.seed < 3

    shots = shots_of(["horizontal"], 4)
    frames = [synthetic(shot, dense_misses_one, 0.1 * shot.seed) for shot in shots]
    nominal = (Column("X", 0), lambda place: place.x_mm)
    table = series_table(frames, "horizontal", "X, mm", nominal, lambda xyz, tilt: xyz[0])
    assert len(table.rows) == 2 * len(PLACES["horizontal"])
    dense, paper = table.rows[:2]
    assert dense[:4] == (-300.0, -300.0, "dense", 75.0)
    assert paper[:4] == (-300.0, -300.0, "paper", 100.0)
    # Errors 0, 0.1, 0.2 and, of the paper's, 0.3.
    assert dense[4:7] == pytest.approx((-299.9, 0.1, 0.1))
    assert paper[4:7] == pytest.approx((-299.85, 0.15, math.sqrt(0.05 / 3)))
    assert dense[7] == pytest.approx(0.1 * math.sqrt(3))


def test_where_nothing_was_read_figures_are_missing() -> None:
    frames = frames_of(lambda *_: False, ["landing"], seeds=2)
    nominal = (Column("cm", 0), lambda place: place.height_mm / 10)
    table = series_table(frames, "landing", "Z, mm", nominal, lambda xyz, tilt: xyz[2])
    assert table.shown[0][3:] == ["0", "–", "–", "–", "–", "–"]
    samples = samples_table(first_flight(frames))
    assert len(samples.rows) == len(PLACES["landing"])
    assert samples.rows[0][4:8] == (None, None, None, "decode: unknown_code")


def test_ranges_count_false_poses_beside_what_is_read() -> None:
    def fine_only(kind: str, shot: Shot) -> bool:
        return not kind.endswith("coarse")

    table = ranges_table(frames_of(fine_only, ["ranges"]))
    titles = [column.title for column in table.columns]
    row = dict(zip(titles, table.rows[0], strict=True))
    assert (row["paper fine, %"], row["paper coarse, %"], row["false poses"]) == (100, 0, 0)
