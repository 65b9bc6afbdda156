"""A calibration in a worker ends where nobody waits for it any more."""

from __future__ import annotations

import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from padstudio.errors import ConflictError
from padstudio.workers import steps
from padstudio.workers.cameras import calibrate_pictures
from padstudio.workers.steps import STOP, steps_of


@pytest.mark.parametrize("by", ["a word", "its folder's end"])
def test_it_stops_between_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, by: str
) -> None:
    folder = tmp_path / "work"
    folder.mkdir()
    files = []
    for name in ("a.png", "b.png", "c.png"):
        path = tmp_path / name
        assert cv2.imwrite(path.as_posix(), np.zeros((48, 64, 3), np.uint8))
        files.append((name, path))
    looked: list[int] = []

    def checkpoint() -> bool:
        looked.append(steps_of(folder).total)
        if by == "a word":
            (folder / STOP).touch()
        else:
            shutil.rmtree(folder)
        return False

    monkeypatch.setattr(steps, "checkpoint", checkpoint)
    with pytest.raises(ConflictError, match="stopped") as caught:
        calibrate_pictures("never read", files, ("radtan",), 10**6, folder)
    assert caught.value.error_code == "cancelled"
    assert looked == [0]
