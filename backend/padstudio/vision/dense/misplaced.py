"""Sheets in each other's place: which of the places that a view shows is the pad's?

A sheet that lies where another one belongs shows cells that fit a place of their own. Where one
fills most of the view, its place has the most cells, and a pose as clear as it is wrong. So where
many cells differ together, each piece of them is looked for elsewhere on the pad. A sheet in a
wrong place is one piece: the place that is seen in more pieces is that of more sheets. Where pieces
do not tell, no pose is given.
"""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Pad
from padstudio.vision.cells.evidence import Evidence, judge
from padstudio.vision.cells.layer_read import LayerRead
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.refine.results import RefinedPose
from padstudio.vision.stage.trace import Reason, StageFailure

# Cells that agree so much better than by chance leave no room for another place.
_AGREED = 0.75
# Cells of so large a neighbourhood agree or differ together, and differ below this share.
_TOGETHER, _DIFFER = 5, 0.8
# Another place is one where chance is below this, log10; so many cells may be aside of it.
_LOG10_ELSEWHERE, _ASIDE = -7.0, 1
# So many of the largest pieces are looked for.
_MOST_PIECES = 4

Cells = NDArray[np.int8]
Mask = NDArray[np.bool_]


class _Place(NamedTuple):
    """Where cells that differ belong.

    Attributes
    ----------
    away : (rows, columns)
        From where the pose puts them.
    more : int
        How many more pieces are seen there than where the pose is right.
    """

    away: tuple[int, int]
    more: int


def at_its_place(refiner: Refiner, refined: RefinedPose) -> RefinedPose | StageFailure:
    """The pose, or that of the place which more sheets show; a failure where none can be told.

    Parameters
    ----------
    refiner : Refiner
    refined : RefinedPose
        Of a still, borne out by its cells.
    """
    place = _other_place(refiner, refined.read)
    if place is None or place.more < 0:
        return refined
    if place.more > 0:
        again = refiner.follow(_moved(refiner.pad, refined, place.away), 0.0)
        if again is not None and again.read.evidence.suffices(_LOG10_ELSEWHERE):
            other = _other_place(refiner, again.read)
            if other is None or other.more < 0:
                return again
    detail = "cells in view belong to two places of the pad: its sheets lie in each other's place"
    return StageFailure("pose", Reason.POSE_REJECTED, detail)


def _other_place(refiner: Refiner, read: LayerRead) -> _Place | None:
    """Where cells that differ from a pose's belong; None where they belong nowhere else."""
    if read.evidence.kappa > _AGREED:
        return None
    count, places = refiner.pad.levels, 4 * read.layer.field.size * max(refiner.attempts, 1)
    levels = read.cells.levels(count)
    differ, found = _differing(levels, read.expected), []
    for piece in _pieces(differ)[:_MOST_PIECES]:
        own = np.where(piece, levels, -1).astype(np.int8)
        evidence, away = _looked_for(own, read, count, places)
        # Rows of a shaken frame put cells off by a few; sheets are larger than a window.
        is_far = max(np.abs(away)) >= refiner.pad.window
        if is_far and evidence.suffices(_LOG10_ELSEWHERE):
            found.append((evidence.log10_false_alarm, away))
    if not found:
        return None
    _, best = min(found)
    there = sum(np.abs(np.subtract(away, best)).max() <= _ASIDE for _, away in found)
    return _Place(best, int(there) - len(_pieces((levels >= 0) & ~differ)))


def _differing(levels: Cells, expected: Cells) -> Mask:
    """Cells (R, C) that differ from what is expected together with those round them."""
    known = (levels >= 0) & (expected >= 0)
    agree, every = (_summed(mask) for mask in (known & (levels == expected), known))
    return np.asarray((levels >= 0) & (agree < _DIFFER * every))


def _summed(mask: Mask) -> NDArray[np.float32]:
    """How many cells of a mask are near each."""
    window, border = (_TOGETHER, _TOGETHER), cv2.BORDER_CONSTANT
    every = cv2.boxFilter(mask.astype(np.float32), -1, window, normalize=False, borderType=border)
    return np.asarray(every, np.float32)


def _pieces(mask: Mask) -> list[Mask]:
    """Connected pieces of some size, the largest first."""
    count, label, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    areas = stats[:, cv2.CC_STAT_AREA]
    large = [k for k in range(1, count) if areas[k] >= _TOGETHER**2]
    return [np.asarray(label == k) for k in sorted(large, key=lambda k: -areas[k])]


def _looked_for(
    own: Cells, read: LayerRead, count: int, places: int
) -> tuple[Evidence, tuple[int, int]]:
    """The place on the layer, in this turn, that agrees best with some cells (−1 for others)."""
    field, (rows, cols) = read.layer.field, own.shape
    rim = (rows - 1, rows - 1, cols - 1, cols - 1, cv2.BORDER_CONSTANT)
    votes = np.zeros((field.shape[0] + rows - 1, field.shape[1] + cols - 1), np.float32)
    for level in range(count):
        padded = cv2.copyMakeBorder((field == level).astype(np.float32), *rim)
        mine = (own == level).astype(np.float32)
        votes += cv2.matchTemplate(padded, mine, cv2.TM_CCORR)
    row, col = np.unravel_index(int(votes.argmax()), votes.shape)
    padded = cv2.copyMakeBorder(field.astype(np.int16), *rim, value=-1)
    there = padded[row : row + rows, col : col + cols].astype(np.int8)
    evidence = judge(own, there, count, places)
    away = (int(row) - rows + 1 - read.cells.row0, int(col) - cols + 1 - read.cells.column0)
    return evidence, away


def _moved(pad: Pad, refined: RefinedPose, away: tuple[int, int]) -> MovingPose:
    """The pose that sees cells so many rows and columns farther on."""
    side = refined.layer.cell_mm
    shift = np.array([away[1] * side * pad.scale[0], -away[0] * side * pad.scale[1], 0.0])
    pose = refined.fit.pose.pose
    return MovingPose(Pose(pose.position_mm + shift, pose.rotation))
