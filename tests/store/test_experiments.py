"""Kept experiments: whole or not at all, the newest ones."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import pytest

from padstudio.errors import NotFoundError
from padstudio.store.experiments import Experiments, KeptExperiment


def made(tmp_path: Path, name: str) -> Path:
    folder = tmp_path / f"made-{name}"
    (folder / "files").mkdir(parents=True)
    (folder / "files" / "report.md").write_text(name)
    (folder / "result.json").write_text(f'{{"title": "{name}"}}')
    return folder


def kept(name: str, minute: int = 0) -> KeptExperiment:
    when = datetime(2026, 5, 4, 9, minute, tzinfo=UTC)
    return KeptExperiment(name, "small", name, when, {"seeds": 1}, 4)


@pytest.fixture
def place(tmp_path: Path) -> Path:
    folder = tmp_path / "experiments"
    folder.mkdir()
    return folder


def test_what_is_kept_is_found_by_another_process(place: Path, tmp_path: Path) -> None:
    Experiments(place, keep=5).add(kept("a"), made(tmp_path, "a"))
    found = Experiments(place, keep=5)
    assert found.newest() == [kept("a")]
    assert found.get("a") == kept("a")
    assert found.result("a") == {"title": "a"}
    assert found.file("a", "report.md").read_text() == "a"
    for wrong in ("record.json", "../record.json", "none"):
        with pytest.raises(NotFoundError):
            found.file("a", wrong)


def test_the_oldest_go(place: Path, tmp_path: Path) -> None:
    experiments = Experiments(place, keep=2)
    for minute, name in enumerate("abc"):
        experiments.add(kept(name, minute), made(tmp_path, name))
    assert [each.id for each in experiments.newest()] == ["c", "b"]
    assert sorted(path.name for path in place.iterdir()) == ["b", "c"]


def test_half_removed_ones_are_gone_at_the_next_start(place: Path, tmp_path: Path) -> None:
    experiments = Experiments(place, keep=2)
    experiments.add(kept("a"), made(tmp_path, "a"))
    (place / "a" / "record.json").unlink()
    with pytest.raises(NotFoundError):
        experiments.get("a")
    Experiments(place, keep=2)
    assert list(place.iterdir()) == []


def test_one_is_deleted_once(place: Path, tmp_path: Path) -> None:
    experiments = Experiments(place, keep=2)
    experiments.add(kept("a"), made(tmp_path, "a"))
    experiments.delete("a")
    with pytest.raises(NotFoundError):
        experiments.delete("a")
