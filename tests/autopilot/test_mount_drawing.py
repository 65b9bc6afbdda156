"""The drawing in the documents is what the program's own mount gives."""

from __future__ import annotations

import os
import re

import pytest
from document_pictures import MOST_BYTES
from mount_drawing import FILE, drawing

_NUMBER = r"-?\d+\.\d+"


def test_the_drawing_shows_the_mount() -> None:
    if os.environ.get("PADSTUDIO_TAKE_PICTURES"):
        FILE.write_text(drawing(), encoding="utf-8")
    kept, made = FILE.read_text(encoding="utf-8"), drawing()
    assert re.sub(_NUMBER, "#", kept) == re.sub(_NUMBER, "#", made)
    found, expected = ([float(n) for n in re.findall(_NUMBER, text)] for text in (kept, made))
    assert found == pytest.approx(expected, abs=0.2)
    assert FILE.stat().st_size <= MOST_BYTES
