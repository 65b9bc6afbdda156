"""A runner over a store with one upload, and an engine that ends tasks as it is told."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import flight_orders
import numpy as np
import videos

from padstudio.flights.chunks import Chunks
from padstudio.flights.cluster.task import Outcome
from padstudio.flights.jobs import Flights
from padstudio.flights.runner import Runner
from padstudio.flights.tasks.planning import ChunkPlan, Plan
from padstudio.store.database.flight_tables import ChunkRow, FlightRow
from padstudio.store.store import Store

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
    asked: list[Work] = field(default_factory=list)
    stopped: list[str] = field(default_factory=list)
    restarted: list[str] = field(default_factory=list)
    rested: int = 0
    trouble: str | None = None

    def room(self, at_work: int) -> int:
        return 2 - at_work

    def submit(self, key: str, task: Work, ended: Ended) -> None:
        self.asked.append(task)
        self.answer(key, task, ended)

    def stop(self, key: str) -> None:
        self.stopped.append(key)

    def end_worker_of(self, key: str) -> None:
        self.restarted.append(key)

    def tend(self) -> str | None:
        return self.trouble

    def rest(self) -> None:
        self.rested += 1

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

    def start(
        self, answer: Answer, rest: Mapping[str, Any] | None = None, **options: Any
    ) -> FakeEngine:
        engine = FakeEngine(answer)
        chunks = Chunks(self.store.session, attempts=2, **options)
        runner = Runner(self.flights, chunks, engine, self.task_of, **(rest or {}))  # type: ignore[arg-type]
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
