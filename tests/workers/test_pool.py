from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import worker_jobs

from padstudio.errors import (
    BusyError,
    LimitError,
    SearchExhaustedError,
    StorageError,
    TimeLimitError,
    WorkerCrashError,
)
from padstudio.workers.pool import WorkerPool

MEMORY_BYTES = 1_000_000_000


@pytest.fixture(scope="module")
def pool() -> Iterator[WorkerPool]:
    pool = WorkerPool(1, MEMORY_BYTES, 5)
    yield pool
    pool.close()


def _pid(pool: WorkerPool) -> int:
    return pool.submit(worker_jobs.identify, 0, timeout_s=30).result()[1]


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


if sys.platform == "linux":  # other systems do not enforce the limit

    def test_memory_is_limited(pool: WorkerPool) -> None:
        before = _pid(pool)
        assert pool.submit(worker_jobs.allocate, 10**8, timeout_s=30).result() == 10**8
        with pytest.raises(LimitError, match="memory"):
            pool.submit(worker_jobs.allocate, 2 * MEMORY_BYTES, timeout_s=30).result()
        assert _pid(pool) == before


def test_too_many_calls_are_turned_away(tmp_path: Path) -> None:
    pool = WorkerPool(1, MEMORY_BYTES, 1)
    go = tmp_path / "go"
    futures = [pool.submit(worker_jobs.wait_for, go, timeout_s=60) for _ in range(2)]
    with pytest.raises(BusyError, match="again"):
        pool.submit(worker_jobs.identify, 0, timeout_s=60)
    go.touch()
    assert [future.result() for future in futures] == ["done", "done"]
    assert pool.submit(worker_jobs.identify, 1, timeout_s=60).result()[0] == 1
    pool.close()


def test_close_ends_the_work() -> None:
    pool = WorkerPool(1, MEMORY_BYTES, 5)
    pid = _pid(pool)
    futures = [pool.submit(worker_jobs.wait, 600, timeout_s=600) for _ in range(2)]
    while not futures[0].running():
        time.sleep(0.01)
    pool.close()
    assert isinstance(futures[0].exception(), WorkerCrashError)
    assert futures[1].cancelled()
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)
