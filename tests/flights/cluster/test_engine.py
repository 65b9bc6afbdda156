"""Workers of tasks: values, errors, deaths, stops; those here, and those lent to a scheduler."""

from __future__ import annotations

import contextlib
import os
import queue
import subprocess
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import cluster_processes
import engine_jobs
import psutil
import pytest

from padstudio.errors import SpecError
from padstudio.flights.cluster.engine import Cluster, ClusterEngine
from padstudio.flights.cluster.local import LocalEngine
from padstudio.flights.cluster.task import Engine, Outcome, Task
from padstudio.workers.inside import Limits
from padstudio.workers.pool import WorkerPool

HERE = Path(engine_jobs.__file__).parent
NICENESS = 10


class Watched:
    """An engine and what its tasks ended with."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._ended: queue.SimpleQueue[Outcome] = queue.SimpleQueue()
        self._count = 0

    def submit(self, task: Task) -> str:
        self._count += 1
        key = f"task-{id(self)}-{self._count}"
        self.engine.submit(key, task, self._ended.put)
        return key

    def next(self) -> Outcome:
        return self._ended.get(timeout=90)

    def run(self, task: Task) -> Outcome:
        self.submit(task)
        return self.next()


@pytest.fixture(scope="module")
def watched() -> Iterator[Watched]:
    pool = WorkerPool(1, Limits(1_000_000_000, NICENESS), max_waiting=0)
    yield Watched(LocalEngine(pool))
    pool.close()


@contextlib.contextmanager
def importable(folder: Path) -> Iterator[None]:
    """Lets workers import the tests' own modules."""
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(folder), *filter(None, [before])])
    try:
        yield
    finally:
        os.environ.pop("PYTHONPATH")
        if before is not None:
            os.environ["PYTHONPATH"] = before


def worker(watched: Watched) -> int:
    """The process id of the worker."""
    return int(watched.run(engine_jobs.Say(0)).value[1])


def test_a_value_comes_from_another_process(watched: Watched) -> None:
    outcome = watched.run(engine_jobs.Say(5))
    assert outcome.kind == "value"
    assert outcome.value[0] == 5
    assert outcome.value[1] != os.getpid()
    assert outcome.value[1] == worker(watched)
    assert watched.engine.room(0) == 1


def test_workers_here_leave_the_server_the_first_turn(watched: Watched) -> None:
    assert psutil.Process(worker(watched)).nice() == max(NICENESS, psutil.Process().nice())


def test_refusals_keep_code_and_detail(watched: Watched) -> None:
    outcome = watched.run(engine_jobs.Refuse())
    assert outcome.kind == "refused"
    assert outcome.error == {"code": "no_way", "message": "no way on", "detail": {"place": 3}}


def test_a_defect_is_named(watched: Watched) -> None:
    outcome = watched.run(engine_jobs.Break())
    assert outcome.kind == "crashed"
    assert outcome.error is not None
    assert outcome.error["code"] == "internal_error"
    assert "ZeroDivisionError" in outcome.error["message"]


def test_a_worker_that_cannot_read_its_task_says_so_and_lives(watched: Watched) -> None:
    before = worker(watched)
    outcome = watched.run(engine_jobs.Foreign())
    assert outcome.kind == "refused"
    assert outcome.error is not None
    assert outcome.error["code"] == "worker_differs"
    assert "same version" in outcome.error["message"]
    assert worker(watched) == before


def test_a_death_is_told_and_another_worker_goes_on(watched: Watched) -> None:
    outcome = watched.run(engine_jobs.Die())
    assert outcome.kind == "crashed"
    assert outcome.error is not None
    assert outcome.error["code"] == "worker_crashed"
    assert watched.run(engine_jobs.Say(1)).value[0] == 1


def test_a_worker_that_hangs_is_ended(watched: Watched, tmp_path: Path) -> None:
    hanging = watched.submit(engine_jobs.WaitForStop(tmp_path))
    cluster_processes.wait_for(tmp_path / "running")
    watched.engine.end_worker_of(hanging)
    assert watched.next().kind == "crashed"
    assert watched.run(engine_jobs.Say(4)).value[0] == 4


def test_stop_reaches_running_and_waiting_tasks(watched: Watched, tmp_path: Path) -> None:
    running = watched.submit(engine_jobs.WaitForStop(tmp_path))
    waiting = watched.submit(engine_jobs.Say(2))
    assert watched.engine.room(2) == 0
    cluster_processes.wait_for(tmp_path / "running")
    watched.engine.stop(waiting)
    assert watched.next().kind == "lost"
    watched.engine.stop(running)
    assert watched.next().kind == "lost"
    cluster_processes.wait_for(tmp_path / "stopped")
    assert watched.run(engine_jobs.Say(3)).value[0] == 3


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:8786", "127.0.0.1:8786", "ws://a:1"])
def test_addresses_without_encryption_are_refused(address: str) -> None:
    with pytest.raises(SpecError, match="not encrypted") as caught:
        Cluster(scheduler=address)
    assert caught.value.error_code == "invalid_setting"


@pytest.mark.parametrize("is_own", [True, False])
def test_workers_join_a_scheduler(is_own: bool, tmp_path: Path) -> None:
    lend: Callable[..., Any] = cluster_processes.plain_worker
    if is_own:
        lend = partial(cluster_processes.worker, options=("--idle-s", "1"))
    tls = cluster_processes.certificates(tmp_path)
    with cluster_processes.scheduler(tls, tmp_path) as (_, address), importable(HERE):
        cluster = Cluster(
            scheduler=address, tls_ca=tls["ca"], tls_cert=tls["cert"], tls_key=tls["key"]
        )
        with contextlib.closing(ClusterEngine(cluster)) as engine:
            assert (engine.room(0), engine.room(1)) == (1, 0)
            assert "no worker is connected" in str(engine.tend())
            with lend(tls, address) as process:
                outcome = Watched(engine).run(engine_jobs.Say(8))
                assert outcome.kind == "value"
                assert outcome.value[0] == 8
                assert outcome.value[1] not in (os.getpid(), process.pid)
                assert engine.tend() is None
                if is_own:
                    _check_that_memory_comes_back(engine, outcome.value[1], process)


def _check_that_memory_comes_back(
    engine: ClusterEngine, idle: int, agent: subprocess.Popen[bytes]
) -> None:
    """Idle processes are let go and come back, and the one that holds them stays."""
    psutil.Process(idle).wait(60)
    again = Watched(engine).run(engine_jobs.Say(9))
    assert again.value[0] == 9
    assert again.value[1] != idle
    assert agent.poll() is None
