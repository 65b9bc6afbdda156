from __future__ import annotations

import errno
import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest
import worker_jobs

from padstudio.errors import (
    BusyError,
    LimitError,
    SearchExhaustedError,
    StorageError,
    StudioError,
    TimeLimitError,
    WorkerCrashError,
)
from padstudio.workers.inside import Limits
from padstudio.workers.pool import WorkerPool
from padstudio.workers.process import Call, NoWorkerError, TaskLostError

MEMORY_BYTES = 1_000_000_000
LIMITS = Limits(MEMORY_BYTES)


@pytest.fixture(scope="module")
def pool() -> Iterator[WorkerPool]:
    pool = WorkerPool(1, LIMITS, 5)
    yield pool
    pool.close()


def _pid(pool: WorkerPool) -> int:
    return pool.submit(worker_jobs.identify, 0, timeout_s=30).result()[1]


def _pid_of_task(pool: WorkerPool) -> int:
    return int(pool.start(worker_jobs.identify, 0).future.result()[1])


def test_calls_share_a_process_of_their_own(pool: WorkerPool) -> None:
    futures = [pool.submit(worker_jobs.identify, n, timeout_s=30) for n in range(4)]
    values, pids = zip(*(future.result() for future in futures), strict=True)
    assert values == (0, 1, 2, 3)
    assert len(set(pids)) == 1
    assert os.getpid() not in pids


def test_errors_come_back_as_their_nearest_known_class(pool: WorkerPool) -> None:
    with pytest.raises(SearchExhaustedError, match="no way on") as caught:
        pool.submit(worker_jobs.refuse, timeout_s=30).result()
    assert caught.value.detail == {"field": 3}
    assert caught.value.error_code == "search_exhausted"
    assert (caught.value.status, caught.value.exit_code) == (418, 5)


def test_a_defect_carries_the_workers_traceback(pool: WorkerPool) -> None:
    with pytest.raises(RuntimeError, match="divide failed") as caught:
        pool.submit(worker_jobs.divide, timeout_s=30).result()
    assert "ZeroDivisionError" in caught.value.__notes__[0]


def test_a_full_disk_is_named(pool: WorkerPool) -> None:
    with pytest.raises(StorageError, match="make room") as caught:
        pool.submit(worker_jobs.fill_the_disk, timeout_s=30).result()
    assert caught.value.error_code == "disk_full"


def test_a_dead_worker_is_replaced(pool: WorkerPool) -> None:
    before = _pid(pool)
    with pytest.raises(WorkerCrashError, match="died"):
        pool.submit(worker_jobs.die, timeout_s=30).result()
    assert _pid(pool) != before


def test_work_beyond_its_time_is_ended(pool: WorkerPool) -> None:
    before = _pid(pool)
    with pytest.raises(TimeLimitError, match=r"0\.2 s"):
        pool.submit(worker_jobs.wait, 600, timeout_s=0.2).result()
    assert _pid(pool) != before
    with pytest.raises(ProcessLookupError):
        os.kill(before, 0)


def test_a_call_that_was_cut_leaves_a_warm_process_behind(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("WARMED_FOLDER", str(tmp_path))
    pool = WorkerPool(1, LIMITS, 5, warming=["worker_warming"])
    try:
        before = _pid(pool)
        with pytest.raises(TimeLimitError):
            pool.submit(worker_jobs.wait, 600, timeout_s=0.01).result()
        # Nobody asks anything of it meanwhile.
        while not (warm := {int(path.name) for path in tmp_path.iterdir()} - {before}):
            time.sleep(0.01)
        (now,) = warm
        assert _pid(pool) == now
    finally:
        pool.close()


def test_limits_count_neither_a_start_nor_imports_nor_compiling(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    pool = WorkerPool(1, LIMITS, 5)
    try:
        # Importing Numba and compiling take a second; the call itself takes none.
        assert pool.submit(worker_jobs.call_a_new_loop, timeout_s=0.5).result() == 45
        task = pool.start(worker_jobs.call_a_new_loop, timeout_s=0.5)
        assert task.future.result() == 45
    finally:
        pool.close()


def test_processes_are_let_go_while_there_is_nothing_to_do() -> None:
    pool = WorkerPool(2, LIMITS, 5, idle_s=0.0)
    try:
        for start in (_pid, _pid_of_task):
            pid = start(pool)
            while psutil.pid_exists(pid):
                time.sleep(0.01)
    finally:
        pool.close()


if sys.platform == "linux":  # other systems do not enforce the limit

    def test_memory_is_limited(pool: WorkerPool) -> None:
        before = _pid(pool)
        assert pool.submit(worker_jobs.allocate, 10**8, timeout_s=30).result() == 10**8
        with pytest.raises(LimitError, match="memory"):
            pool.submit(worker_jobs.allocate, 2 * MEMORY_BYTES, timeout_s=30).result()
        assert _pid(pool) == before


def test_too_many_calls_are_turned_away(tmp_path: Path) -> None:
    pool = WorkerPool(1, LIMITS, 1)
    go = tmp_path / "go"
    futures = [pool.submit(worker_jobs.wait_for, go, timeout_s=60) for _ in range(2)]
    with pytest.raises(BusyError, match="again"):
        pool.submit(worker_jobs.identify, 0, timeout_s=60)
    go.touch()
    assert [future.result() for future in futures] == ["done", "done"]
    assert pool.submit(worker_jobs.identify, 1, timeout_s=60).result()[0] == 1
    pool.close()


def test_close_ends_the_work() -> None:
    pool = WorkerPool(1, LIMITS, 5)
    pid = _pid(pool)
    futures = [pool.submit(worker_jobs.wait, 600, timeout_s=600) for _ in range(2)]
    while not futures[0].running():
        time.sleep(0.01)
    pool.close()
    assert isinstance(futures[0].exception(), WorkerCrashError)
    assert futures[1].cancelled()
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


@pytest.fixture
def task(pool: WorkerPool, tmp_path: Path) -> Iterator[Call]:
    """One that is at work until its file ``go`` is there."""
    call = pool.start(worker_jobs.step_until, tmp_path / "go")
    while not (tmp_path / "go.running").exists():
        time.sleep(0.01)
    yield call
    call.stop()


def test_a_request_is_answered_between_two_steps_of_a_task(
    pool: WorkerPool, task: Call, tmp_path: Path
) -> None:
    assert pool.free == 0
    pids = {_pid(pool) for _ in range(3)}
    assert not task.future.done()
    (tmp_path / "go").touch()
    assert task.future.result(30) == ("done", *pids)
    assert pool.free == 1


def test_requests_without_end_do_not_keep_a_task_waiting(pool: WorkerPool, tmp_path: Path) -> None:
    (tmp_path / "go").touch()
    requests = [pool.submit(worker_jobs.wait, 0.2, timeout_s=30) for _ in range(6)]
    task = pool.start(worker_jobs.step_until, tmp_path / "go")
    assert task.future.result(30)[0] == "done"
    assert not requests[-1].done()
    assert [request.result(30) for request in requests] == [None] * 6


@pytest.mark.parametrize(
    ("job", "error"),
    [((worker_jobs.die,), WorkerCrashError), ((worker_jobs.wait, 60), TimeLimitError)],
)
def test_a_request_that_costs_the_process_is_not_blamed_on_the_task(
    pool: WorkerPool, task: Call, job: tuple[Any, ...], error: type[StudioError]
) -> None:
    with pytest.raises(error):
        pool.submit(*job, timeout_s=0.5).result(30)
    with pytest.raises(TaskLostError):
        task.future.result(30)


def test_a_task_that_dies_takes_no_request_with_it(pool: WorkerPool, task: Call) -> None:
    request = pool.submit(worker_jobs.identify, 3, timeout_s=30)
    task.kill()
    error = task.future.exception(30)
    assert isinstance(error, WorkerCrashError)
    assert not isinstance(error, TaskLostError)
    assert request.result(30)[0] == 3


def test_a_task_is_told_to_stop(pool: WorkerPool, task: Call, tmp_path: Path) -> None:
    waiting = pool.start(worker_jobs.step_until, tmp_path / "go")
    waiting.stop()
    assert waiting.future.cancelled()
    task.stop()
    assert task.future.result(30)[0] == "stopped"
    (tmp_path / "go").touch()
    assert pool.start(worker_jobs.step_until, tmp_path / "go").future.result(30)[0] == "done"


def test_another_process_answers_where_a_task_takes_no_steps() -> None:
    pool = WorkerPool(2, LIMITS, 5)
    hanging = pool.start(worker_jobs.wait, 600)
    assert [pool.submit(worker_jobs.identify, n, timeout_s=30).result(30)[0] for n in range(3)]
    assert not hanging.future.done()
    pool.close()
    assert isinstance(hanging.future.exception(30), WorkerCrashError)


_SERVER = """
import sys, time, worker_jobs
from padstudio.workers.inside import Limits
from padstudio.workers.pool import WorkerPool
if __name__ == "__main__":
    pool = WorkerPool(1, Limits(10**9), 0)
    print(pool.submit(worker_jobs.identify, 0, timeout_s=60).result()[1], flush=True)
    pool.start(worker_jobs.wait, 600)
    time.sleep(600)
"""


def test_a_process_ends_with_its_server_also_in_the_middle_of_a_step() -> None:
    folder = Path(worker_jobs.__file__).parent
    command = [sys.executable, "-c", _SERVER]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE) as server:
        assert server.stdout is not None
        worker = psutil.Process(int(server.stdout.readline()))
        server.kill()
    worker.wait(30)


@pytest.mark.parametrize(
    "fault",
    [
        OSError(errno.EMFILE, "Too many open files"),
        BlockingIOError(errno.EAGAIN, "Resource temporarily unavailable"),
        MemoryError(),
        RuntimeError("no more of them"),
    ],
    ids=lambda fault: type(fault).__name__,
)
def test_a_process_that_cannot_be_started_costs_its_caller_an_error_alone(
    monkeypatch: pytest.MonkeyPatch, fault: Exception
) -> None:
    def fail(*_: object) -> None:
        raise fault

    pool = WorkerPool(1, LIMITS, 5)
    try:
        with monkeypatch.context() as patch:
            patch.setattr("padstudio.workers.worker.Process", fail)
            refused = pool.submit(worker_jobs.identify, 1, timeout_s=30).exception(timeout=30)
            assert isinstance(refused, NoWorkerError)
            assert (refused.status, refused.error_code) == (503, "no_worker")
            assert (getattr(fault, "strerror", None) or str(fault)) in refused.message
            lost = pool.start(worker_jobs.identify, 2).future.exception(timeout=30)
            assert isinstance(lost, TaskLostError)
            assert pool.trouble == lost.message
        assert pool.submit(worker_jobs.identify, 3, timeout_s=30).result(timeout=60)[0] == 3
        assert pool.start(worker_jobs.identify, 4).future.result(timeout=60)[0] == 4
        assert (pool.free, pool.trouble) == (1, None)
    finally:
        pool.close()


@pytest.mark.parametrize("at", [1, 2])
def test_threads_that_cannot_be_started_cost_the_caller_an_error_alone(
    monkeypatch: pytest.MonkeyPatch, at: int
) -> None:
    starts: list[object] = []

    class Thread(threading.Thread):
        def start(self) -> None:
            starts.append(self)
            if len(starts) >= at:
                raise RuntimeError("can't start new thread")
            super().start()

    pool = WorkerPool(1, LIMITS, 0)
    try:
        with monkeypatch.context() as patch:
            patch.setattr(threading, "Thread", Thread)
            # More often than there is room: a refused call takes none.
            for _ in range(3):
                with pytest.raises(NoWorkerError, match="can't start new thread"):
                    pool.submit(worker_jobs.identify, 1, timeout_s=30)
            with pytest.raises(NoWorkerError):
                pool.start(worker_jobs.identify, 2)
            pool.warm_up()
        assert pool.free == 1
        assert pool.submit(worker_jobs.identify, 3, timeout_s=30).result(timeout=60)[0] == 3
        assert pool.start(worker_jobs.identify, 4).future.result(timeout=60)[0] == 4
    finally:
        pool.close()


def test_a_process_that_dies_as_it_starts_is_no_fault_of_its_call() -> None:
    # Too little for an interpreter.
    pool = WorkerPool(1, Limits(1_000_000), 5, warming=["no_such_module"])
    try:
        refused = pool.submit(worker_jobs.identify, 1, timeout_s=30).exception(timeout=60)
        assert isinstance(refused, NoWorkerError), refused
        lost = pool.start(worker_jobs.identify, 2).future.exception(timeout=60)
        assert isinstance(lost, NoWorkerError), lost
        assert pool.trouble == lost.message
        assert pool.free == 1
    finally:
        pool.close()


def test_an_answer_that_cannot_be_sent_is_a_defect_of_its_request_alone(
    pool: WorkerPool, tmp_path: Path
) -> None:
    with pytest.raises(RuntimeError, match="give_what_cannot_be_sent failed"):
        pool.submit(worker_jobs.give_what_cannot_be_sent, timeout_s=30).result(timeout=60)
    task = pool.start(worker_jobs.step_until, tmp_path / "go")
    while not (tmp_path / "go.running").exists():
        time.sleep(0.01)
    with pytest.raises(RuntimeError, match="give_what_cannot_be_sent failed"):
        pool.submit(worker_jobs.give_what_cannot_be_sent, timeout_s=30).result(timeout=60)
    assert pool.submit(worker_jobs.identify, 5, timeout_s=30).result(timeout=60)[0] == 5
    (tmp_path / "go").touch()
    assert task.future.result(timeout=60)[0] != "stopped"
