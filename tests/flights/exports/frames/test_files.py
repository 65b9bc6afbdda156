"""Pictures and sizes of the files that a poses file names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import videos

from padstudio.flights.exports.frames.files import SourceFiles

FRAMES = 12


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two videos of 12 frames, 25 a second, and a still."""
    for name, turned in (("a.mp4", 0), ("b.mp4", 90)):
        videos.write(tmp_path / name, FRAMES, rotation_deg=turned)
    cv2.imwrite(str(tmp_path / "c.png"), np.zeros((20, 30, 3), np.uint8))
    return tmp_path


def _record(source: str, frame: int, time_s: float | None, **more: Any) -> dict[str, Any]:
    return {"source": source, "frame": frame, "time_s": time_s, "status": "ok"} | more


def _shown(picture: bytes | None) -> Any:
    assert picture is not None
    return cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR)


def test_frames_of_a_second_video_are_counted_on(folder: Path) -> None:
    files = SourceFiles(folder, {"a.mp4": None, "b.mp4": (videos.WIDTH, videos.HEIGHT)}, {})
    for number in (2, 7):
        picture = files.picture(_record("a.mp4", number, number / 25))
        assert videos.number_of(_shown(picture)) == number
    for number in (1, 5):
        picture = files.picture(_record("b.mp4", FRAMES + number, (FRAMES + number) / 25))
        assert videos.number_of(_shown(picture)) == number
    assert files.missing == 0


def test_frames_of_older_files_are_counted_in_each_video(folder: Path) -> None:
    files = SourceFiles(folder, {"a.mp4": None, "b.mp4": (videos.WIDTH, videos.HEIGHT)}, {})
    assert videos.number_of(_shown(files.picture(_record("b.mp4", 4, 4 / 25)))) == 4
    # A number and a time that are not of one frame are of another file.
    assert files.picture(_record("b.mp4", 4, 0.9)) is None
    assert files.missing == 1


def test_pictures_are_turned_as_they_were_detected(folder: Path) -> None:
    shown = (videos.HEIGHT, videos.WIDTH)
    turned = SourceFiles(folder, {"b.mp4": shown}, {})
    assert turned.frame_px(_record("b.mp4", 0, 0.0)) == shown
    assert _shown(turned.picture(_record("b.mp4", 0, 0.0))).shape[:2] == shown[::-1]
    stored = SourceFiles(folder, {"b.mp4": shown[::-1]}, {})
    assert _shown(stored.picture(_record("b.mp4", 0, 0.0))).shape[:2] == shown


def test_stills_and_what_is_not_there(folder: Path) -> None:
    files = SourceFiles(folder, {"c.png": None, "d.png": None, "e.mp4": None}, {})
    assert files.frame_px(_record("c.png", 0, None)) == (30, 20)
    assert _shown(files.picture(_record("c.png", 0, None))).shape == (20, 30, 3)
    for record in (_record("d.png", 1, None), _record("e.mp4", 2, 0.0)):
        assert files.frame_px(record) is None
        assert files.picture(record) is None
    # What could not be read when it was detected is not missed.
    assert files.picture(_record("e.mp4", 2, 0.0, status="failed", stage="read")) is None
    assert files.missing == 2
