"""Between database and engine: what the runner makes of every way in which a task can end."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import flight_orders
import numpy as np
import pytest
import videos
from sqlalchemy import event

from padstudio.errors import StorageError
from padstudio.flights.chunks import Chunks
from padstudio.flights.engine_tasks import Outcome
from padstudio.flights.flight_tables import ChunkRow, FlightRow
from padstudio.flights.jobs import Flights
from padstudio.flights.planning import ChunkPlan, Plan
from padstudio.flights.runner import Runner
from padstudio.flights.store import Store

OVER = ("done", "failed", "cancelled")
CRASH = Outcome("crashed", error={"code": "worker_crashed", "message": "it died", "detail": {}})
REFUSAL = Outcome("refused", error={"code": "not_a_video", "message": "no video", "detail": {}})
Ended = Callable[[Outcome], None]
Answer = Callable[[str, Any, Ended], None]


@dataclass(frozen=True)
class Work:
    """A task that says what it is of."""

    number: int
    first_frame: int
    frames: int

    def run(self, stopped: Callable[[], bool]) -> Any:
        if not self.number:
            pts = np.arange(3, dtype="<i8").tobytes()
            source = {"kind": "video", "first_frame": 0, "frames": 6}
            return Plan([source], [ChunkPlan(0, 0, 3, pts), ChunkPlan(0, 3, 3, pts)], None)
        numbers = range(self.first_frame, self.first_frame + self.frames)
        return [
            {"frame": n, "time_s": 0.0, "status": "failed", "stage": "edges", "detail": "x" * 2000}
            for n in numbers
        ]


@dataclass
class FakeEngine:
    """Ends tasks as it is told, at once and in the caller's thread; keeps what it was asked."""

    answer: Answer
    capacity: int = 2
    asked: list[Work] = field(default_factory=list)
    stopped: list[str] = field(default_factory=list)
    restarted: list[str] = field(default_factory=list)

    def submit(self, key: str, task: Work, ended: Ended) -> None:
        self.asked.append(task)
        self.answer(key, task, ended)

    def stop(self, key: str) -> None:
        self.stopped.append(key)

    def restart_worker_of(self, key: str) -> None:
        self.restarted.append(key)

    def tend(self) -> str | None:
        """Nothing to tend."""

    def close(self) -> None:
        """Nothing to close."""


def do(key: str, task: Work, ended: Ended) -> None:
    """Do a task."""
    ended(Outcome("value", task.run(lambda: False)))


def first_then(outcome: Outcome, number: int, times: int = 1) -> Answer:
    """Ends a chunk's first attempts in some way, and does the rest."""
    left = [times]

    def answer(key: str, task: Work, ended: Ended) -> None:
        if task.number == number and left[0]:
            left[0] -= 1
            ended(outcome)
        else:
            do(key, task, ended)

    return answer


class Bench:
    """A runner in its thread, over a store with one upload."""

    def __init__(self, folder: Path) -> None:
        self.store = Store(folder / "data")
        self.upload = flight_orders.upload(self.store, videos.write(folder / "a.mp4", 2))
        self.flights = Flights(self.store.session)
        self.runners: list[Runner] = []

    def start(self, answer: Answer, **options: Any) -> FakeEngine:
        engine = FakeEngine(answer)
        chunks = Chunks(self.store.session, attempts=2, **options)
        runner = Runner(self.flights, chunks, engine, self.task_of)  # type: ignore[arg-type]
        runner.start()
        self.runners.append(runner)
        return engine

    def task_of(self, flight: FlightRow, chunk: ChunkRow) -> Work:
        return Work(chunk.number, chunk.first_frame, chunk.frames)

    def order(self) -> str:
        return self.flights.create(flight_orders.order(self.upload)).id

    def finished(self, flight: str) -> FlightRow:
        return self.when(flight, lambda found: found.state in OVER)

    def when(self, flight: str, reached: Callable[[FlightRow], bool]) -> FlightRow:
        end = time.monotonic() + 60
        while not reached(found := self.flights.get(flight)):
            assert time.monotonic() < end
            for runner in self.runners:
                runner.wake()
            time.sleep(0.01)
        return found

    def close(self) -> None:
        for runner in self.runners:
            runner.close()
        self.store.close()


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path)
    yield made
    made.close()


def test_trouble_is_told_while_it_lasts(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("padstudio.flights.runner._RETRY_S", 0.05)
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


def test_a_full_disk_ends_the_flight_by_name_and_keeps_nothing_half(bench: Bench) -> None:
    limits = []

    def limit(connection: Any, *_: object) -> None:
        connection.execute(f"PRAGMA max_page_count={limits[-1] if limits else 10**9}")

    engine = bench.store.session.kw["bind"]
    event.listen(engine, "checkout", limit)

    def fill_up(key: str, task: Work, ended: Ended) -> None:
        if task.number == 1:
            limits.append(1)
        do(key, task, ended)

    bench.start(fill_up)
    over = bench.finished(bench.order())
    assert over.state == "failed"
    assert over.error is not None
    assert over.error["code"] == "disk_full"
    limits.append(10**9)
    event.remove(engine, "checkout", limit)
    engine.dispose()
    bench.flights.retry(over.id)
    assert bench.finished(over.id).frames_done == 6
