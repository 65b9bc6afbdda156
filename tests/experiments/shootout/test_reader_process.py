"""A reader's process may raise, crash or hang: whoever asked is told, and goes on."""

from __future__ import annotations

import math
import os
import time

import numpy as np
import pytest

from padstudio.experiments.shootout.boards.sheets import Page
from padstudio.experiments.shootout.contestant import MOST_LOSSES, Contestant
from padstudio.experiments.shootout.reader_process import (
    ReaderFailedError,
    ReaderLostError,
    ReaderProcess,
)
from padstudio.geometry.camera import Camera


def test_it_gives_values_and_errors_and_lives_on() -> None:
    with ReaderProcess() as process:
        assert process.call(20, math.sqrt, 9.0) == 3.0
        with pytest.raises(ReaderFailedError, match="ValueError"):
            process.call(20, math.sqrt, -1.0)
        # What a library prints does not come between.
        process.call(20, os.write, 1, b"noise")
        assert process.call(20, os.getenv, "OMP_NUM_THREADS") == "1"


def test_a_crash_and_a_hang_are_told_apart() -> None:
    with ReaderProcess() as process, pytest.raises(ReaderLostError, match="died of signal 6"):
        process.call(20, os.abort)
    with ReaderProcess() as process:
        process.call(20, math.sqrt, 9.0)
        with pytest.raises(ReaderLostError, match=r"longer than 0\.2 s"):
            process.call(0.2, time.sleep, 30)


def test_a_reader_that_is_lost_again_and_again_is_given_up() -> None:
    camera = Camera(64, 48, np.array([[60.0, 0, 31.5], [0, 60.0, 23.5], [0, 0, 1]]), np.zeros(5))
    with Contestant("aruco-single", "fast", Page(100.0, 100.0), camera) as reader:
        for frame in range(MOST_LOSSES + 2):
            assert reader.read(b"no picture", f"Frame {frame + 1}") is None
    assert len(reader.troubles) == MOST_LOSSES + 1
    assert reader.troubles[0].startswith("Frame 1: the reader failed")
    assert "not started again" in reader.troubles[-1]
