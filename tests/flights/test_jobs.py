"""Flights and their chunks in the database: what may follow what, and nothing twice."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import flight_orders
import numpy as np
import pytest
import videos

from padstudio.errors import ConflictError, LimitError, NotFoundError
from padstudio.flights.chunks import Chunks
from padstudio.flights.jobs import Flights
from padstudio.flights.results.frames import FrameFilter, Results
from padstudio.flights.tasks.planning import ChunkPlan, Plan
from padstudio.store.database.flight_tables import FlightRow
from padstudio.store.store import Store

ERROR = {"code": "worker_crashed", "message": "the process died", "detail": {}}
SOURCE = {"upload": "u", "kind": "video", "name": "a.mp4", "url": "a", "first_frame": 0}


class Office:
    """A store with one upload and what works on it."""

    def __init__(self, folder: Path, database_url: str | None) -> None:
        self.store = Store(folder / "data", database_url)
        self.upload = flight_orders.upload(self.store, videos.write(folder / "a.mp4", 2))
        self.flights = Flights(self.store.session, max_open=3)
        self.chunks = Chunks(self.store.session, attempts=2)
        self.results = Results(self.store.session)

    def order(self) -> FlightRow:
        return self.flights.create(flight_orders.order(self.upload))

    def planned(self, chunks: int = 2, frames: int = 3) -> FlightRow:
        """A flight whose chunks are queued."""
        flight = self.order()
        [claim] = self.chunks.claim(1)
        assert self.chunks.finish_plan(claim, plan(chunks, frames))
        return self.flights.get(flight.id)


def plan(chunks: int = 2, frames: int = 3) -> Plan:
    pts = np.arange(frames, dtype="<i8").tobytes()
    parts = [ChunkPlan(0, frames * place, frames, pts) for place in range(chunks)]
    return Plan([SOURCE | {"frames": chunks * frames}], parts, None)


def records(first: int, count: int = 3) -> list[dict[str, Any]]:
    return [
        {
            "source": "a.mp4",
            "frame": number,
            "time_s": number / 10,
            "status": "failed",
            "stage": "decode",
            "reason": "unknown_code",
            "detail": "",
            "advice": "",
            "elapsed_ms": {"total": 1.0},
        }
        for number in range(first, first + count)
    ]


@pytest.fixture
def office(tmp_path: Path, new_database: Callable[[], str | None]) -> Iterator[Office]:
    made = Office(tmp_path, new_database())
    yield made
    made.store.close()


def test_a_flight_from_order_to_end(office: Office) -> None:
    flight = office.order()
    assert (flight.state, flight.frames_total) == ("queued", None)
    [claim] = office.chunks.claim(5)
    assert claim.is_plan
    assert office.chunks.claim(5) == []
    assert office.flights.get(flight.id).state == "running"
    assert office.chunks.finish_plan(claim, plan())
    assert office.flights.get(flight.id).frames_total == 6
    for place, claim in enumerate(office.chunks.claim(5)):
        assert office.flights.get(flight.id).state == "running"
        assert office.chunks.finish(claim, records(3 * place))
    over = office.flights.get(flight.id)
    assert (over.state, over.frames_done, over.frames_ok, over.error) == ("done", 6, 0, None)
    assert over.finished_at is not None
    assert [record["frame"] for record in office.results.every(over)] == list(range(6))


def test_a_result_is_taken_once_and_only_from_the_last_claim(office: Office) -> None:
    flight = office.planned(chunks=1)
    [old] = office.chunks.claim(1)
    assert office.chunks.release(old)
    [new] = office.chunks.claim(1)
    assert new.attempt == old.attempt + 1
    assert not office.chunks.finish(old, records(0))
    assert not office.chunks.crash(old, ERROR)
    assert office.chunks.finish(new, records(0))
    assert not office.chunks.finish(new, records(0))
    assert office.flights.get(flight.id).frames_done == 3


def test_a_plan_is_taken_once(office: Office) -> None:
    office.order()
    [old] = office.chunks.claim(1)
    office.chunks.release_all()
    [new] = office.chunks.claim(1)
    assert office.chunks.finish_plan(new, plan())
    assert not office.chunks.finish_plan(old, plan())
    assert len(office.chunks.claim(10)) == 2


def test_older_flights_come_first(office: Office) -> None:
    first, second = office.order(), office.order()
    assert [claim.flight for claim in office.chunks.claim(2)] == [first.key, second.key]


def test_a_restart_queues_what_was_running(office: Office) -> None:
    office.planned()
    [done, running] = office.chunks.claim(2)
    office.chunks.finish(done, records(0))
    assert office.chunks.release_all() == 1
    [again] = office.chunks.claim(5)
    assert again == replace(running, attempt=running.attempt + 1)


def test_crashes_cost_attempts_and_then_the_chunk(office: Office) -> None:
    flight = office.planned()
    [bad, good] = office.chunks.claim(2)
    assert office.chunks.crash(bad, ERROR)
    [bad] = office.chunks.claim(5)
    assert office.chunks.crash(bad, ERROR)
    assert office.chunks.claim(5) == []
    office.chunks.finish(good, records(3))
    over = office.flights.get(flight.id)
    assert (over.state, over.frames_done) == ("failed", 3)
    assert over.error is not None
    assert over.error["code"] == "worker_crashed"
    assert over.error["detail"] == {"missing": [{"first_frame": 0, "frames": 3}]}
    assert "3 frames have no result" in over.error["message"]


def test_retry_does_only_what_is_missing(office: Office) -> None:
    flight = office.planned()
    [bad, good] = office.chunks.claim(2)
    office.chunks.finish(good, records(3))
    office.chunks.fail(bad, ERROR)
    with pytest.raises(NotFoundError):
        office.flights.retry("0" * 16)
    assert office.flights.retry(flight.id).state == "queued"
    with pytest.raises(ConflictError, match="queued") as caught:
        office.flights.retry(flight.id)
    assert caught.value.error_code == "not_retryable"
    [again] = office.chunks.claim(5)
    assert again.chunk == bad.chunk
    office.chunks.finish(again, records(0))
    over = office.flights.get(flight.id)
    assert (over.state, over.error, over.frames_done) == ("done", None, 6)


def test_a_plan_that_fails_ends_the_flight_by_name(office: Office) -> None:
    flight = office.order()
    [claim] = office.chunks.claim(1)
    error = {"code": "not_a_video", "message": "the file is no video", "detail": {}}
    office.chunks.fail(claim, error)
    over = office.flights.get(flight.id)
    assert (over.state, over.error) == ("failed", error)


def test_cancel_keeps_what_is_finished_and_drops_the_rest(office: Office) -> None:
    flight = office.planned(chunks=3)
    [done, running] = office.chunks.claim(2)
    office.chunks.finish(done, records(0))
    assert office.flights.cancel(flight.id).state == "cancelled"
    assert not office.chunks.is_current(running)
    assert not office.chunks.finish(running, records(3))
    assert office.chunks.claim(5) == []
    assert office.flights.cancel(flight.id).frames_done == 3
    office.flights.retry(flight.id)
    assert len(office.chunks.claim(5)) == 2


def test_what_nobody_is_at_is_queued_again(office: Office) -> None:
    office.planned()
    mine, other = office.chunks.claim(2)
    assert office.chunks.release_all({mine.chunk}) == 1
    assert office.chunks.is_current(mine)
    assert not office.chunks.is_current(other)
    assert [claim.chunk for claim in office.chunks.claim(5)] == [other.chunk]


def test_uploads_stay_while_a_flight_needs_them(office: Office) -> None:
    flight = office.planned()
    with pytest.raises(ConflictError) as caught:
        office.store.uploads.delete(office.upload)
    assert caught.value.error_code == "upload_in_use"
    office.flights.delete(flight.id)
    office.store.uploads.delete(office.upload)
    with pytest.raises(NotFoundError):
        office.order()


def test_deleted_flights_are_gone_at_once_and_purged_little_by_little(office: Office) -> None:
    flight, other = office.order(), office.order()
    for claim in office.chunks.claim(2):
        office.chunks.finish_plan(claim, plan(chunks=1))
    for claim in office.chunks.claim(2):
        office.chunks.finish(claim, records(0))
    office.flights.delete(flight.id)
    with pytest.raises(NotFoundError):
        office.flights.get(flight.id)
    assert office.flights.list(10, 0)[1] == 1
    while office.flights.purge():
        pass
    assert list(office.results.every(flight)) == []
    assert len(list(office.results.every(other))) == 3
    with office.store.session() as session:
        assert session.get(FlightRow, flight.key) is None


def test_too_many_open_flights_are_refused(office: Office) -> None:
    for _ in range(3):
        office.order()
    with pytest.raises(LimitError) as caught:
        office.order()
    assert caught.value.error_code == "too_many_flights"


def test_lists_newest_first_by_state(office: Office) -> None:
    first, second = office.order(), office.order()
    office.flights.cancel(first.id)
    assert [row.id for row in office.flights.list(10, 0)[0]] == [second.id, first.id]
    assert [row.id for row in office.flights.list(1, 1)[0]] == [first.id]
    assert [row.id for row in office.flights.list(10, 0, "cancelled")[0]] == [first.id]


def test_a_flight_without_frames_has_no_page(office: Office) -> None:
    assert office.results.page(office.order(), FrameFilter(), 10) == []
