"""What keeps work from going on is waited for, and told."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from runner_bench import Bench, Ended, Work, do
from sqlalchemy.exc import OperationalError

from padstudio.flights.chunks import Chunks


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


def test_a_start_waits_for_a_database_that_cannot_be_written(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("padstudio.flights.runner._RETRY_S", 0.05)
    flight = bench.order()
    release, tries = Chunks.release_all, iter(range(9))

    def release_all(chunks: Chunks) -> int:
        if next(tries) < 2:
            raise OperationalError("UPDATE", {}, Exception("database or disk is full"))
        return release(chunks)

    monkeypatch.setattr(Chunks, "release_all", release_all)
    bench.start(do)
    assert bench.finished(flight).state == "done"
    assert next(tries) == 3
