"""Hough segments and their merging."""

import math

import cv2
import numpy as np
import pytest
from paper_frames import HEIGHT, WIDTH, edge_map

from padstudio.vision.baseline.edges import EdgeMap
from padstudio.vision.baseline.hough import find_merged_lines, homogeneous
from padstudio.vision.baseline.hough_kernel import BINS
from padstudio.vision.stage.params import PaperParams
from padstudio.vision.stage.trace import Reason, StageFailure


def drawn(strokes):
    """An edge map with straight strokes in it, and the normals of each."""
    blank = edge_map()
    thin = np.zeros((HEIGHT, WIDTH), np.uint8)
    turns = np.zeros((HEIGHT, WIDTH), np.int32)
    for start, end in strokes:
        cv2.line(thin, start, end, 255, 1)
        along = math.atan2(end[1] - start[1], end[0] - start[0])
        turn = round((along / math.pi + 0.5) * BINS) % BINS
        cv2.line(turns, start, end, turn, 3)
    y, x = np.nonzero(thin)
    mask = cv2.dilate(thin, np.ones((3, 3), np.uint8))
    points = np.stack([x, y], axis=1).astype(float)
    y, x = np.nonzero(mask)
    xy = np.stack([x, y], axis=1).astype(np.int32)
    return EdgeMap(thin, mask, points, xy, turns[y, x], blank.plane, blank.camera)


DASHES = [((60 + 90 * k, 100), (110 + 90 * k, 100)) for k in range(6)]
UPRIGHT = [((x, 40), (x, 440)) for x in (150, 300, 450)]


def test_pieces_of_a_line_become_one():
    found = find_merged_lines(drawn([*DASHES, *UPRIGHT]), PaperParams())
    flat = [k for k, line in enumerate(found.homogeneous) if abs(line[1]) > 0.99]
    assert len(found.ends) == 4
    assert len(flat) == 1
    ends = np.sort(found.ends[flat[0]][:, 0])
    np.testing.assert_allclose(ends, (60, 560), atol=3)
    # Six dashes of 50 pixels: the gaps between them are no support.
    assert found.support[flat[0]] == pytest.approx(300, abs=25)


def test_parallel_lines_stay_apart():
    found = find_merged_lines(
        drawn([((50, y), (590, y)) for y in (100, 112, 124, 136)]), PaperParams()
    )
    offsets = np.sort(np.abs(found.homogeneous[:, 2]))
    np.testing.assert_allclose(offsets, (100, 112, 124, 136), atol=0.4)


def test_a_slanting_line_is_fitted_to_a_part_of_a_pixel():
    strokes = [((40, 60), (600, 401)), *UPRIGHT]
    found = find_merged_lines(drawn(strokes), PaperParams())
    true = homogeneous(np.array([strokes[0]], float))[0]
    slanting = min(found.homogeneous, key=lambda line: abs(abs(line @ [*true[:2], 0]) - 1))
    for x in (40, 320, 600):
        y = -(true[0] * x + true[2]) / true[1]
        assert abs(slanting @ (x, y, 1)) < 0.35


def test_no_lines_is_a_failure():
    found = find_merged_lines(edge_map(), PaperParams())
    assert isinstance(found, StageFailure)
    assert found.reason is Reason.TOO_FEW_LINES
