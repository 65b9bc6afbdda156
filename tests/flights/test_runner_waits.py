"""What keeps work from going on is waited for, and told."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from runner_bench import Bench, Ended, Work, do
from sqlalchemy import event, update
from sqlalchemy.exc import OperationalError

from padstudio.errors import StorageError
from padstudio.flights.chunks import Chunks
from padstudio.flights.cluster.task import Outcome
from padstudio.store.database.flight_tables import ChunkRow, FlightRow

FULL = {"code": "disk_full", "message": "the disk is full; make room", "detail": {}}


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    monkeypatch.setattr("padstudio.flights.runner._RETRY_S", 0.05)
    made = Bench(tmp_path)
    yield made
    made.close()


def test_trouble_is_told_while_it_lasts(bench: Bench) -> None:
    is_broken = True

    def answer(key: str, task: Work, ended: Ended) -> None:
        if is_broken:
            raise TimeoutError("nobody answers")
        do(key, task, ended)

    bench.start(answer)
    (runner,) = bench.runners
    flight = bench.order()
    bench.when(flight, lambda found: runner.trouble is not None)
    assert "workers cannot be started or reached (nobody answers)" in str(runner.trouble)
    is_broken = False
    assert bench.finished(flight).state == "done"
    bench.when(flight, lambda found: runner.trouble is None)


def test_a_start_waits_for_a_database_that_cannot_be_written(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    flight = bench.order()
    release, tries = Chunks.release_all, iter(range(9))

    def release_all(chunks: Chunks, *besides: Any) -> int:
        if next(tries) < 2:
            raise OperationalError("UPDATE", {}, Exception("database or disk is full"))
        return release(chunks, *besides)

    monkeypatch.setattr(Chunks, "release_all", release_all)
    bench.start(do)
    assert bench.finished(flight).state == "done"
    assert next(tries) == 3


def test_a_full_disk_is_waited_for_and_nothing_computed_is_lost(
    bench: Bench, caplog: pytest.LogCaptureFixture
) -> None:
    pages = [10**9]

    def limit(connection: Any, *_: object) -> None:
        connection.execute(f"PRAGMA max_page_count={pages[-1]}")

    engine = bench.store.session.kw["bind"]
    event.listen(engine, "checkout", limit)

    def fill_up(key: str, task: Work, ended: Ended) -> None:
        if task.number == 1:
            pages.append(1)
        do(key, task, ended)

    asked = bench.start(fill_up).asked
    flight = bench.order()
    (runner,) = bench.runners
    waiting = bench.when(flight, lambda _: runner.trouble is not None)
    assert (waiting.state, waiting.error) == ("running", None)
    assert "is full; make room" in str(runner.trouble)
    pages.append(10**9)
    over = bench.finished(flight)
    assert (over.state, over.frames_done, over.error) == ("done", 6, None)
    assert [task.number for task in asked] == [0, 1, 2]
    bench.when(flight, lambda _: runner.trouble is None)
    told = [record for record in caplog.records if record.name.endswith("runner")]
    assert [record.levelno for record in told] == [logging.WARNING] * 2
    assert "is full; make room" in told[0].getMessage()
    assert told[1].getMessage() == "flights go on"


@pytest.mark.parametrize("number", [0, 1])
def test_a_task_that_finds_no_room_is_done_when_there_is(bench: Bench, number: int) -> None:
    is_full = [True]

    def answer(key: str, task: Work, ended: Ended) -> None:
        if task.number == number and is_full:
            ended(Outcome("refused", error=FULL))
        else:
            do(key, task, ended)

    bench.start(answer)
    (runner,) = bench.runners
    flight = bench.order()
    bench.when(flight, lambda _: runner.trouble is not None)
    assert "the disk is full; make room" in str(runner.trouble)
    is_full.clear()
    assert bench.finished(flight).frames_done == 6


def test_a_task_that_cannot_be_made_for_lack_of_room_waits(bench: Bench) -> None:
    is_full, make = [True], bench.task_of

    def no_room(flight: FlightRow, chunk: ChunkRow) -> Work:
        if is_full:
            raise StorageError("no room for a copy", code="disk_full")
        return make(flight, chunk)

    bench.task_of = no_room  # type: ignore[method-assign]
    bench.start(do)
    (runner,) = bench.runners
    flight = bench.order()
    bench.when(flight, lambda _: runner.trouble is not None)
    is_full.clear()
    assert bench.finished(flight).frames_done == 6


def test_a_database_that_is_away_for_long_costs_no_result(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    finish, tries = Chunks.finish, iter(range(99))

    def away(chunks: Chunks, *given: Any) -> bool:
        if next(tries) < 20:
            raise OperationalError("UPDATE", {}, Exception("server closed the connection"))
        return finish(chunks, *given)

    monkeypatch.setattr(Chunks, "finish", away)
    asked = bench.start(do).asked
    assert bench.finished(bench.order()).frames_done == 6
    assert [task.number for task in asked] == [0, 1, 2]


@pytest.mark.parametrize("method", ["claim", "load"])
def test_claims_are_not_forgotten_where_the_database_goes_away_behind_them(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    act: Callable[..., Any] = getattr(Chunks, method)
    faults = iter(range(99))

    def away(chunks: Chunks, *given: Any) -> Any:
        done = act(chunks, *given)
        if done and next(faults) in (0, 1, 4):
            raise OperationalError("COMMIT", {}, Exception("server closed the connection"))
        return done

    monkeypatch.setattr(Chunks, method, away)
    bench.start(do)
    assert bench.finished(bench.order()).frames_done == 6


def test_a_clock_that_is_set_ends_no_work(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    late: list[Callable[[], None]] = []

    def hold(key: str, task: Work, ended: Ended) -> None:
        late.append(lambda: do(key, task, ended))

    engine = bench.start(hold)
    flight = bench.order()
    bench.when(flight, lambda _: bool(late))
    # As it looks where this machine's clock is set forward while work is claimed.
    with bench.store.session.begin() as session:
        past = datetime.now(UTC) - timedelta(hours=20)
        session.execute(update(ChunkRow).values(lease_until=past))
    # What hangs is looked for before new work is taken.
    bench.when(bench.order(), lambda _: len(late) == 2)
    assert engine.restarted == []
    engine.answer = do
    for finish in late:
        finish()
    assert bench.finished(flight).frames_done == 6


def test_waiting_for_a_worker_is_not_work(bench: Bench) -> None:
    waiting: list[tuple[str, Work, Ended]] = []

    def wait(key: str, task: Work, ended: Ended) -> None:
        waiting.append((key, task, ended))

    # All time is over at once.
    engine = bench.start(wait, lease_s=0.0, frame_lease_s=0.0)
    engine.trouble = "no worker is connected"
    flight = bench.order()
    looks = iter(range(10))
    bench.when(flight, lambda found: bool(waiting) and next(looks) > 5)
    engine.answer = do
    for task in waiting:
        do(*task)
    assert bench.finished(flight).state == "done"
    assert engine.restarted == []


def test_the_engine_rests_after_long_without_work_and_is_there_again(bench: Bench) -> None:
    now_s = 1000.0
    engine = bench.start(do, rest={"idle_s": 600.0, "now": lambda: now_s})
    first = bench.order()
    bench.finished(first)
    now_s += 590
    bench.finished(bench.order())
    assert engine.rested == 0

    def rests(_: object) -> bool:
        # When the runner sees that there is nothing to do is its own business.
        nonlocal now_s
        now_s += 610
        return engine.rested > 0

    bench.when(first, rests)
    assert bench.finished(bench.order()).state == "done"
