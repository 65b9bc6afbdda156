"""Files that fuzzing found worth keeping are read or refused, and never more than that."""

from __future__ import annotations

import pytest
from fuzz_targets import CORPUS, TARGETS, kept, outcome


@pytest.mark.parametrize("name", TARGETS)
def test_kept_files_are_taken_or_refused(name: str) -> None:
    outcomes = {outcome(TARGETS[name], data) for _, data in kept(name)}
    assert "taken" in outcomes
    assert len(outcomes) > 1


@pytest.mark.parametrize("name", TARGETS)
def test_seeds_are_taken_or_refused(name: str) -> None:
    outcomes = [outcome(TARGETS[name], data) for data in TARGETS[name].seeds()]
    assert "taken" in outcomes


def test_the_corpus_stays_small() -> None:
    files = [path for path in CORPUS.rglob("*") if path.is_file()]
    assert {path.parent.name for path in files} == set(TARGETS)
    assert len(files) <= 300
    assert sum(path.stat().st_size for path in files) <= 300_000
