"""Tests of padstudio.flights.results.fusing and fused_rows: no chunk's border is seen."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest
from frame_records import records
from sqlalchemy import select
from sqlalchemy.orm import Session, sessionmaker

from padstudio.flights.results.bins import bins_of, read_bins
from padstudio.flights.results.frames import Results
from padstudio.flights.results.fused_rows import fuse_around
from padstudio.flights.results.fusing import fused_records, single_record
from padstudio.flights.results.rows import insert_rows, rows_of
from padstudio.store.database.engine import Sessions, open_database
from padstudio.store.database.flight_tables import FlightRow, FrameRow

Record = dict[str, Any]


def positions(found: list[Record]) -> np.ndarray:
    return np.array([record["position_mm"] for record in found if record["status"] == "ok"])


@pytest.mark.parametrize("fusion", ["filter", "smooth"])
def test_records_say_what_they_rest_on(fusion: Any) -> None:
    raw = records(60)
    found = list(fused_records(copy.deepcopy(raw), fusion))
    assert [record["frame"] for record in found] == list(range(60))
    for before, after in zip(raw, found, strict=True):
        if before["status"] == "failed":
            assert after == before
            continue
        assert after["estimate"] == {"filter": "filtered", "smooth": "smoothed"}[fusion]
        for key in ("position_mm", "quaternion_xyzw", "position_sigma_mm", "covariance"):
            assert after["single"][key] == before[key]
        assert after["single"]["is_outlier"] is False
    assert not np.allclose(positions(found), positions(raw))
    again = list(fused_records(found, fusion))
    assert np.allclose(positions(again), positions(found), rtol=1e-9)
    own = list(fused_records(found, "none"))
    for before, after in zip(raw, own, strict=True):
        assert set(after) == set(before)
        if before["status"] == "ok":
            assert after["quality"] == before["quality"]
            for key in ("position_mm", "position_sigma_mm", "range_mm", "range_sigma_mm"):
                assert after[key] == pytest.approx(before[key])


def test_stills_and_poses_without_covariance_stay_as_they_are() -> None:
    stills = [record | {"time_s": None} for record in records(5)]
    assert list(fused_records(stills, "smooth")) == stills
    bare = [{k: v for k, v in each.items() if k != "covariance"} for each in records(5)]
    assert list(fused_records(bare, "filter")) == bare


def test_sources_are_fused_each_by_itself() -> None:
    first, second = records(30), records(30, seed=2, source="b.mp4")
    both = list(fused_records(first + second, "filter"))
    assert both[30:] == list(fused_records(second, "filter"))


def test_covariances_out_of_their_senses_spoil_nothing() -> None:
    raw = records(30)
    raw[12]["covariance"] = [float("nan")] * 21
    raw[14]["covariance"] = [0.0] * 21
    found = list(fused_records(raw, "smooth"))
    assert found[12]["estimate"] == found[14]["estimate"] == "frame"
    assert np.isfinite(positions(found)).all()


@pytest.fixture(scope="module")
def session(
    tmp_path_factory: pytest.TempPathFactory, new_database: Callable[[], str | None]
) -> Iterator[sessionmaker[Session]]:
    folder = tmp_path_factory.mktemp("fused")
    engine = open_database(new_database() or f"sqlite:///{folder}/studio.db")
    yield Sessions(engine)
    engine.dispose()


def stored(
    session: sessionmaker[Session], raw: list[Record], request: Record, chunks: list[range]
) -> FlightRow:
    """A flight whose chunks came in, in that order."""
    with session.begin() as at:
        count = len(at.scalars(select(FlightRow.key)).all())
        flight = FlightRow(
            id=f"flight-{count}",
            created_at=datetime.now(UTC),
            name="flight",
            state="done",
            request=request,
            sources=[],
            pad="",
            camera="",
        )
        at.add(flight)
    for number, chunk in enumerate(chunks, 1):
        with session.begin() as at:
            some = [copy.deepcopy(raw[place]) for place in chunk]
            insert_rows(at, request, *rows_of(flight.key, number, some))
            fuse_around(at, flight.key, request, chunk)
    return flight


ORDER = {"first_frame": 0, "stride": 1, "fuse": True}
IN_ORDER = [range(120), range(120, 240), range(240, 300)]
OTHERWISE = [range(130, 210), range(210, 300), range(70), range(70, 130)]


@pytest.mark.parametrize("smooth", [False, True])
def test_borders_and_order_of_chunks_are_not_seen(
    session: sessionmaker[Session], smooth: bool
) -> None:
    raw, request = records(300), ORDER | {"smooth": smooth}
    whole = list(fused_records(copy.deepcopy(raw), "smooth" if smooth else "filter"))
    sigma = np.array([r["position_sigma_mm"] for r in whole if r["status"] == "ok"])
    for chunks in (IN_ORDER, OTHERWISE):
        flight = stored(session, raw, request, chunks)
        found = list(Results(session).every(flight))
        assert [r["status"] for r in found] == [r["status"] for r in raw]
        assert (np.abs(positions(found) - positions(whole)) < 0.05 * sigma).all()
        singles = positions([single_record(record) for record in found])
        assert np.allclose(singles, positions(raw))


def test_charts_and_filters_hold_what_frames_hold(session: sessionmaker[Session]) -> None:
    flight = stored(session, records(300), ORDER | {"smooth": True}, OTHERWISE)
    found = list(Results(session).every(flight))
    with session() as at:
        rows = at.scalars(select(FrameRow).where(FrameRow.flight == flight.key)).all()
        heights = {row.number: row.z_mm for row in rows}
        bins = read_bins(at, flight)
        for part in bins:
            inside = [r for r in found if part.first_frame <= r["frame"] <= part.last_frame]
            frames, _ = rows_of(flight.key, 0, inside)
            (summed,) = bins_of(frames, ORDER | {"first_frame": part.first_frame})
            assert (part.z_min_mm, part.z_max_mm) == (summed["z_min_mm"], summed["z_max_mm"])
            assert part.body == {**summed["body"], "damaged": 0}
    for record in found:
        if record["status"] == "ok":
            assert heights[record["frame"]] == record["position_mm"][2]


def test_flights_of_older_programs_stay_as_they_were(session: sessionmaker[Session]) -> None:
    raw = records(30)
    flight = stored(session, raw, {"first_frame": 0, "stride": 1}, [range(30)])
    assert all("single" not in record for record in Results(session).every(flight))
