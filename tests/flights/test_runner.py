"""Between database and engine: what the runner makes of every way in which a task can end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from runner_bench import CRASH, REFUSAL, Bench, Ended, Work, do, first_then

from padstudio.errors import StorageError
from padstudio.flights.cluster.task import Outcome
from padstudio.store.database.flight_tables import ChunkRow, FlightRow


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path)
    yield made
    made.close()


def test_a_flight_is_done_chunk_by_chunk(bench: Bench) -> None:
    engine = bench.start(do)
    over = bench.finished(bench.order())
    assert (over.state, over.frames_done, over.error) == ("done", 6, None)
    assert [task.number for task in engine.asked] == [0, 1, 2]


@pytest.mark.parametrize("number", [0, 1])
def test_a_lost_task_is_done_again_as_often_as_it_takes(bench: Bench, number: int) -> None:
    engine = bench.start(first_then(Outcome("lost"), number, times=5))
    assert bench.finished(bench.order()).state == "done"
    assert [task.number for task in engine.asked].count(number) == 6


def test_one_crash_is_forgiven(bench: Bench) -> None:
    bench.start(first_then(CRASH, 1))
    assert bench.finished(bench.order()).state == "done"


def test_crashes_without_end_are_told(bench: Bench) -> None:
    engine = bench.start(first_then(CRASH, 1, times=99))
    over = bench.finished(bench.order())
    assert (over.state, over.frames_done) == ("failed", 3)
    assert over.error is not None
    assert over.error["code"] == "worker_crashed"
    assert over.error["detail"]["missing"] == [{"first_frame": 0, "frames": 3}]
    assert [task.number for task in engine.asked].count(1) == 2


def test_a_refusal_is_final(bench: Bench) -> None:
    engine = bench.start(first_then(REFUSAL, 0))
    over = bench.finished(bench.order())
    assert (over.state, over.error) == ("failed", REFUSAL.error)
    assert len(engine.asked) == 1


def test_a_task_that_cannot_be_made_fails_by_name(bench: Bench) -> None:
    def no_room(flight: FlightRow, chunk: ChunkRow) -> Work:
        raise StorageError("cannot copy an upload", code="storage")

    bench.task_of = no_room  # type: ignore[method-assign]
    bench.start(do)
    over = bench.finished(bench.order())
    assert over.error == {"code": "storage", "message": "cannot copy an upload", "detail": {}}


def test_cancelled_work_is_stopped_and_its_late_result_dropped(bench: Bench) -> None:
    late: list[Callable[[], None]] = []

    def hold(key: str, task: Work, ended: Ended) -> None:
        if task.number == 0:
            do(key, task, ended)
        else:
            late.append(lambda: do(key, task, ended))

    engine = bench.start(hold)
    flight = bench.order()
    bench.when(flight, lambda _: len(late) == 2)
    bench.flights.cancel(flight)
    bench.when(flight, lambda _: len(engine.stopped) == 2)
    for finish in late:
        finish()
    # The next flight is worked on, so the late results have been looked at by then.
    engine.answer = do
    bench.finished(bench.order())
    assert bench.flights.get(flight).frames_done == 0


def test_a_task_that_hangs_costs_an_attempt_and_its_worker(bench: Bench) -> None:
    hanging = [1]

    def hang_once(key: str, task: Work, ended: Ended) -> None:
        if task.number == 1 and hanging:
            hanging.pop()
        else:
            do(key, task, ended)

    engine = bench.start(hang_once, lease_s=0.2, frame_lease_s=0.0)
    assert bench.finished(bench.order()).state == "done"
    assert len(engine.restarted) == 1


def test_a_restart_goes_on_where_the_last_server_ended(bench: Bench) -> None:
    def stuck_at_two(key: str, task: Work, ended: Ended) -> None:
        if task.number != 2:
            do(key, task, ended)

    bench.start(stuck_at_two)
    flight = bench.order()
    bench.when(flight, lambda found: found.frames_done == 3)
    bench.runners.pop().close()
    engine = bench.start(do)
    assert bench.finished(flight).frames_done == 6
    assert [task.number for task in engine.asked] == [2]
