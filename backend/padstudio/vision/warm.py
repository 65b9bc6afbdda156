"""Compiles the detector's inner loops ahead, by a small pad that it reads.

The machine code is kept on disk, so that one process warms all later ones.
"""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np

from padstudio.arrays import Image, YuvFrame
from padstudio.geometry.camera import Camera
from padstudio.pad.layout import layout
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.detector import Detector
from padstudio.vision.frame.pyramid import halved
from padstudio.vision.stage.params import DetectorParams, RefineParams

_SIDE_PX = 640
_CELLS = 25
# Widths of a cell: the sign fills the frame and is found by its lattice, or is matched as a whole.
_CELL_PX = (36.0, 3.6)
_NARROW = DetectorParams(refine=RefineParams(least_cell_px=40.0))
_MATRIX = np.array([[1000.0, 0, _SIDE_PX / 2], [0, 1000.0, _SIDE_PX / 2], [0, 0, 1]])
_CAMERA = Camera(_SIDE_PX, _SIDE_PX, _MATRIX)
# Hardly distorted, so that the frame is what they see, too.
_LENSES = (
    Camera(_SIDE_PX, _SIDE_PX, _MATRIX, np.array([1e-3, 0, 0, 0, 0])),
    Camera(_SIDE_PX, _SIDE_PX, _MATRIX, np.array([1 / 3, 0.13, 0, 0]), model="fisheye"),
)


def warm_up() -> bool:
    """Take all steps; True where every frame gave what it shows."""
    return all(list(steps()))


def steps() -> Iterator[bool]:
    """Read and follow a small pad by all methods; whether each frame gave what it shows.

    It is seen from near and from afar, through lenses of both kinds; another pad's frames, which
    have none of its cells, take the ways that end without a pose.
    """
    pad, other = _pad(1), _pad(2)
    detector = Detector(pad, _CAMERA)
    for cell_px in _CELL_PX:
        frame = _frame(pad, cell_px)
        for frames in ([frame] * 3, [_in_planes(frame)] * 2):
            for detection in detector.track(frames, smooth=True):
                yield detection.ok
    near = _frame(pad, _CELL_PX[0])
    # Cells too narrow to be fitted, as perspective makes some of them; the coarse ones are too few.
    yield not Detector(pad, _CAMERA, params=_NARROW).detect(near).ok
    for lens in _LENSES:
        yield Detector(pad, lens).detect(near).ok
    yield Detector(pad, _CAMERA, method="paper").detect(near).ok
    others = [_frame(other, cell_px) for cell_px in _CELL_PX] + [_veiled(_frame(other, 12.0))]
    for frame in others:
        yield not detector.detect(frame, reasons=True).ok


def _veiled(frame: Image) -> Image:
    """As if through fog."""
    return np.asarray(frame * 0.12 + 150, np.uint8)


def _in_planes(bgr: Image) -> YuvFrame:
    """The frame as a video's decoder leaves it."""
    y, red, blue = cv2.split(cv2.cvtColor(bgr, cv2.COLOR_BGR2YCrCb))
    u, v = (np.asarray(halved(np.asarray(colour)), np.uint8) for colour in (blue, red))
    return YuvFrame(np.asarray(y, np.uint8), u, v, bgr.shape[1], "bt601", True, lambda: bgr)


def _pad(seed: int) -> Pad:
    rng = np.random.default_rng(seed)
    fine = rng.integers(0, 2, (_CELLS, _CELLS)).astype(np.uint8)
    coarse = rng.integers(0, 2, (_CELLS // 5, _CELLS // 5)).astype(np.uint8)
    return Pad((Layer("red", 10.0, fine), Layer("blue", 50.0, coarse)), window=5)


def _frame(pad: Pad, cell_px: float) -> Image:
    """The pad amid a grey picture, slightly turned."""
    bgr = np.ascontiguousarray(layout(pad).colors[:, :, ::-1])
    angle = np.radians(7.0)
    turn = cell_px * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    # Array pixels have their centres at whole numbers.
    middle = np.full(2, _SIDE_PX / 2) - turn @ np.full(2, (_CELLS - 1) / 2)
    frame = cv2.warpAffine(
        bgr,
        np.column_stack([turn, middle]),
        (_SIDE_PX, _SIDE_PX),
        flags=cv2.INTER_NEAREST,
        borderValue=(110, 110, 110),
    )
    return np.asarray(cv2.GaussianBlur(frame, (0, 0), 0.8), np.uint8)
