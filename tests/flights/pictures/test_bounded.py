from __future__ import annotations

import os
from pathlib import Path

import pytest

from padstudio.flights.pictures import bounded
from padstudio.flights.pictures.bounded import BoundedFolder


def test_what_was_not_looked_at_for_longest_goes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bounded, "_TRIM_EVERY_S", 0.0)
    folder = BoundedFolder(tmp_path / "kept", 250)
    for place, name in enumerate("abcd"):
        path = tmp_path / "kept" / f"video-{place % 2}" / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(bytes(100))
        os.utime(path, (1000 + place, 1000 + place))
    os.utime(tmp_path / "kept" / "video-0" / "a")
    folder.trim()
    assert sorted(path.name for path in (tmp_path / "kept").glob("*/*")) == ["a", "d"]
    folder.trim()
    assert len(list((tmp_path / "kept").glob("*/*"))) == 2
    BoundedFolder(tmp_path / "kept", 250)
    assert len(list((tmp_path / "kept").glob("*/*"))) == 2
    BoundedFolder(tmp_path / "kept", 250, is_emptied=True)
    assert not list((tmp_path / "kept").iterdir())
