"""The pages' files are looked at seldom, and changes of them are seen all the same."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from padstudio.web.pages import static


def test_addresses_of_files_cost_one_look_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s, looks = [1e6], 0
    walk = Path.rglob

    def counted(path: Path, pattern: str, **options: Any) -> Iterator[Path]:
        nonlocal looks
        looks += 1
        return walk(path, pattern, **options)

    monkeypatch.setattr(static, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(Path, "rglob", counted)
    for _ in range(20):
        static.address("icon.svg")
    assert looks == 1
    now_s[0] += 1.0
    static.address("icon.svg")
    assert looks == 2


def test_a_changed_file_has_another_address(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    now_s = [2e6]
    monkeypatch.setattr(static, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(static, "_FRONTEND", tmp_path)
    icon = tmp_path / "icon.svg"
    icon.write_text("<svg/>", encoding="utf-8")
    first = static.address("icon.svg")
    icon.write_text("<svg><g/></svg>", encoding="utf-8")
    now_s[0] += 1.0
    assert static.address("icon.svg") != first
