"""What a reader's process does: print a board, get a reader ready, read a frame on the clock."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.experiments.shootout.boards.aruco import Read
from padstudio.experiments.shootout.boards.catalogue import BOARDS
from padstudio.experiments.shootout.boards.sheets import Page
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.layout import Layout
from padstudio.pad.spec import Pad

#: How a board is read: of the pad "single" and "followed", of others "fast" and "thorough".
SINGLE, FOLLOWED, FAST, THOROUGH = "single", "followed", "fast", "thorough"
#: Those whose time is taken.
TIMED = (SINGLE, FOLLOWED, FAST)
# Readings of the first frame before the clock counts.
_WARM_UP = 3

_read: Read | None = None


@dataclass(frozen=True, eq=False)
class Reading:
    """What a reader made of a frame.

    Attributes
    ----------
    pose : Pose or None
    wall_ms : float
        By the clock on the wall.
    cpu_ms : float
        Of the processor: less disturbed by what else the machine does.
    """

    pose: Pose | None
    wall_ms: float
    cpu_ms: float


def print_board(board: str, page: Page) -> Layout:
    """A board as it is printed on the page."""
    return BOARDS[board].sheet(page)


def prepare(board: str | Pad, setting: str, page: Page, camera: Camera, first: bytes) -> None:
    """Get a reader ready, and warm on a first frame.

    Parameters
    ----------
    board : str or Pad
    setting : str
    page : Page
    camera : Camera
    first : bytes
        A JPEG file.
    """
    global _read
    cv2.setNumThreads(1)
    cv2.setRNGSeed(1)

    def make() -> Read:
        if isinstance(board, Pad):
            return _pad_reader(board, setting, camera)
        return BOARDS[board].reader(page, camera, setting == THOROUGH)

    _read = make()
    if setting in TIMED:
        image = _decoded(first)
        for _ in range(_WARM_UP):
            _read(image)
    if setting == FOLLOWED:
        # What it has seen by now is no part of the flight.
        _read = make()


def read(jpeg: bytes, twice: bool) -> Reading:
    """Read a frame; where it is read twice, the second time counts on the clock."""
    assert _read is not None
    image = _decoded(jpeg)
    if twice:
        _read(image)
    wall, cpu = time.perf_counter(), time.process_time()
    pose = _read(image)
    return Reading(pose, 1000 * (time.perf_counter() - wall), 1000 * (time.process_time() - cpu))


def _decoded(jpeg: bytes) -> Image:
    return np.asarray(cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR), np.uint8)


def _pad_reader(pad: Pad, setting: str, camera: Camera) -> Read:
    # Readers of other boards start sooner without it.
    from padstudio.vision.detector import Detector

    detector = Detector(pad, camera)
    if setting == SINGLE:
        return lambda image: detector.detect(image).pose
    next_image: list[Image] = []

    def frames() -> Iterator[Image]:
        while True:
            yield next_image.pop()

    followed = detector.track(frames())

    def read_next(image: Image) -> Pose | None:
        next_image.append(image)
        return next(followed).pose

    return read_next
