"""Parts of an experiment, in one process and in several."""

from __future__ import annotations

from pathlib import Path

import pytest
from linear_algebra import threads_after_a_product

from padstudio.experiments.running import run_parts


def test_results_come_in_the_order_of_the_parts_whatever_the_processes() -> None:
    seen: list[tuple[int, int]] = []
    parts = [3, -1, 2]
    assert run_parts(abs, parts, lambda *at: seen.append(at)) == [3, 1, 2]
    assert seen == [(0, 3), (1, 3), (2, 3), (3, 3)]
    assert run_parts(abs, parts, lambda *at: None, 2) == [3, 1, 2]


def test_a_progress_that_raises_ends_the_work() -> None:
    def stop(done: int, total: int) -> None:
        if done == 2:
            raise RuntimeError("enough")

    done: list[int] = []
    with pytest.raises(RuntimeError, match="enough"):
        run_parts(done.append, [1, 2, 3], stop)
    assert done == [1, 2]


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="counts threads as Linux does")
def test_each_process_has_one_thread() -> None:
    parts = [700, 700]
    assert run_parts(threads_after_a_product, parts, lambda *at: None, 2) == [1, 1]
