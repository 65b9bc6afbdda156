"""Thumbnails show the print and the lens, whatever their sizes."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from padstudio.geometry.camera import Camera
from padstudio.pad.coding.generate import PadSpec, generate_pad
from padstudio.workers import thumbnails


def _read(data: bytes) -> np.ndarray:
    return np.asarray(cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR))


def test_cells_have_their_layers_levels() -> None:
    pad = generate_pad(PadSpec(rows=24, cols=30, ratio=3, distance=1))
    picture = _read(thumbnails.of_pad(pad.dumps()))
    assert picture.shape == (192, 240, 3)
    for layer in pad.layers:
        side = 240 * layer.cell_mm / pad.size_mm[0]
        rows, cols = np.indices(layer.field.shape)
        middles = [((places + 0.5) * side).astype(int) for places in (rows, cols)]
        plane = picture[..., {"blue": 0, "red": 2}[layer.channel]]
        assert np.array_equal(plane[middles[0], middles[1]] > 127, layer.field > 0)


def test_a_large_pad_is_averaged_not_sampled() -> None:
    pad = generate_pad(PadSpec(rows=480, cols=480, window=6, ratio=1, distance=1))
    picture = _read(thumbnails.of_pad(pad.dumps()))
    (layer,) = pad.layers
    means = layer.field.reshape(240, 2, 240, 2).mean(axis=(1, 3)) * 255
    assert np.abs(picture[..., 2].astype(float) - means).max() <= 1


@pytest.mark.parametrize("distortion", [(), (-0.3, 0.1, 0.0, 0.0, 0.0)])
def test_lines_are_as_straight_as_the_lens_shows_them(distortion: tuple[float, ...]) -> None:
    matrix = np.array([[400.0, 0, 319.5], [0, 400.0, 239.5], [0, 0, 1]])
    camera = Camera(640, 480, matrix, np.array(distortion), name="c")
    dark = _read(thumbnails.of_camera(camera.to_ros_yaml()))[..., 0] < 200
    assert dark.shape == (180, 240)
    # The line through the middle stays straight; a row of it is dark from side to side.
    assert dark[88:92].any(axis=0).all()
    # Far from the middle a straight line holds its row, a bent one leaves it.
    straight = max(dark[max(0, row - 1) : row + 2].any(axis=0).mean() for row in range(8, 40))
    assert bool(straight == 1.0) is (not distortion)


def test_a_fisheye_beyond_a_half_space_is_drawn() -> None:
    matrix = np.array([[200.0, 0, 399.5], [0, 200.0, 399.5], [0, 0, 1]])
    camera = Camera(800, 800, matrix, np.zeros(4), model="fisheye", name="f")
    picture = _read(thumbnails.of_camera(camera.to_ros_yaml()))
    assert picture.shape == (240, 240, 3)
    assert 0.02 < (picture < 200).mean() < 0.6
