"""The pad is found through cameras that are guessed, and taken for flat."""

from __future__ import annotations

import pytest
from calibration_shots import LENSES, poses_about, shots
from dense_frames import random_pad

from padstudio.calibration.first_views import ROUGHLY, best_guess, guessed, look
from padstudio.vision.bend import bent_sheet
from padstudio.vision.detector import Detector

PAD = random_pad(3, cells=(60, 12), cell_mm=(20.0, 100.0))
SIDE_MM = max(PAD.size_mm)


def test_a_wrong_lens_starts_no_search_for_bent_paper(monkeypatch: pytest.MonkeyPatch) -> None:
    camera = LENSES["bent"]
    (picture,) = shots(PAD, camera, poses_about(SIDE_MM, camera, 1, seed=1))
    wrong = guessed(camera.width, camera.height, "radtan", 0.7, (0.0, 0.0))
    searches: list[bool] = []

    def no_bend(*_: object, short: bool = False) -> None:
        searches.append(short)

    monkeypatch.setattr(bent_sheet, "_flattened", no_bend)
    assert Detector(PAD, wrong).detect(picture).ok
    assert searches
    searches.clear()
    assert Detector(PAD, wrong, params=ROUGHLY).detect(picture).ok
    assert not searches


def test_a_fisheye_s_pictures_are_read_by_the_guess_that_is_taken() -> None:
    camera = LENSES["fisheye"]
    pictures = shots(PAD, camera, poses_about(SIDE_MM, camera, 4, seed=1))
    told: list[None] = []
    found = best_guess(pictures, PAD, ("radtan", "fisheye"), lambda: told.append(None))
    assert sum(pose is not None for pose in look(pictures, PAD, found, lambda: None).poses) >= 3
    assert told
