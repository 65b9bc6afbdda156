"""Segments of drawn strokes, and the normals of pictures' edges."""

import math

import cv2
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision.baseline.hough_kernel import BINS, find_segments

SIDE = 240


def found_in(strokes, turn=None, gap=4, length=20.0, thickness=3):
    """Segments of strokes; `turn` is what all pixels say of their normal, bins."""
    mask = np.zeros((SIDE, SIDE), np.uint8)
    turns = np.zeros((SIDE, SIDE), np.int32)
    for start, end in strokes:
        own = math.atan2(end[1] - start[1], end[0] - start[0]) / math.pi + 0.5
        cv2.line(mask, start, end, 255, thickness)
        cv2.line(turns, start, end, round(own * BINS) % BINS if turn is None else turn, thickness)
    y, x = np.nonzero(mask)
    order = np.random.default_rng(1).permutation(len(x))
    xy = np.stack([x, y], axis=1).astype(np.int32)[order]
    return find_segments(mask.shape, xy, turns[y, x][order], 15, length, gap)


def lengths(segments):
    return np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)


@given(st.floats(0, math.pi), st.integers(40, 100))
def test_segments_of_a_stroke_lie_on_it_and_cover_it(angle, half):
    middle = SIDE // 2
    dx, dy = round(half * math.cos(angle)), round(half * math.sin(angle))
    start, end = np.array([middle - dx, middle - dy]), np.array([middle + dx, middle + dy])
    segments = found_in([(start.tolist(), end.tolist())])
    along = (end - start) / np.linalg.norm(end - start)
    away = (segments - start) @ np.array([-along[1], along[0]])
    assert np.abs(away).max() < 4
    spans = np.sort((segments - start) @ along, axis=1)
    places = np.arange(2, np.linalg.norm(end - start) - 2)
    held = (spans[:, :1] <= places) & (places <= spans[:, 1:])
    assert held.any(axis=0).mean() > 0.95


@given(st.integers(1, 12), st.integers(1, 12))
def test_gaps_are_bridged_up_to_their_limit(width, limit):
    strokes = [((20, 100), (100, 100)), ((101 + width, 100), (200, 100))]
    found = found_in(strokes, gap=limit, thickness=1)
    assert lengths(found).max() == (180 if width <= limit else max(80, 99 - width))


def test_short_strokes_are_left_out():
    strokes = [((20, 50), (38, 50)), ((20, 90), (60, 90))]
    found = found_in(strokes, length=30.0)
    assert np.abs(found[:, :, 1] - 90).max() < 3


def test_pixels_do_not_vote_along_their_gradient():
    stroke = [((20, 50), (200, 50))]
    assert len(found_in(stroke, turn=BINS // 2)) > 0
    assert len(found_in(stroke, turn=0)) == 0


def test_strokes_that_cross_are_found_both():
    found = found_in([((20, 120), (220, 120)), ((120, 20), (120, 220))])
    spans = np.abs(found[:, 1] - found[:, 0]).max(axis=0)
    np.testing.assert_allclose(spans, 200, atol=6)


def test_without_pixels_there_are_no_segments():
    nothing = np.zeros((0, 2), np.int32)
    found = find_segments((SIDE, SIDE), nothing, nothing[:, 0], 15, 20.0, 4)
    assert found.shape == (0, 2, 2)
