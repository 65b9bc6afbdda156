"""Each cell's expected level, read level, grey value and thresholds, for a pose from anywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.planar_pnp import planar_pose
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import outline_mm
from padstudio.pad.spec import Pad
from padstudio.vision.cells.evidence import Evidence, judge
from padstudio.vision.cells.layer_read import LayerRead, read_layer
from padstudio.vision.frame.pyramid import Pyramid

# Corners are clicked to a pixel or so: a corner that is nearer to the line through its neighbours
# leaves the pose to chance.
_LEAST_CORNER_PX = 4.0


@dataclass(frozen=True)
class Fit:
    """How well a layer's cells agree with the pad as it could lie, too.

    Attributes
    ----------
    quarter_turns : int
        Counter-clockwise, of the pad.
    mirrored : bool
    share : float
        Of the cells.
    """

    quarter_turns: int
    mirrored: bool
    share: float


@dataclass(frozen=True, eq=False)
class Comparison:
    """A layer's cells as read with a pose.

    Attributes
    ----------
    read : LayerRead
    levels : (R, C) int8
        As the picture alone tells them, −1 where not seen.
    thresholds : (R, C, Y − 1) float32
        Grey values between levels.
    fits : tuple of Fit
        The pose's own turn first, then turned and mirrored ones.
    """

    read: LayerRead
    levels: NDArray[np.int8]
    thresholds: NDArray[np.float32]
    fits: tuple[Fit, ...]

    def to_dict(self) -> dict[str, Any]:
        """JSON-serialisable; columns of one entry a seen cell."""
        cells, (rows, cols) = self.read.cells, np.nonzero(self.read.cells.seen)
        seen = cells.seen
        return {
            "channel": self.read.layer.channel,
            "cell_px": round(cells.cell_px, 2),
            "read": self.read.evidence.read,
            "wrong": self.read.evidence.wrong,
            "log10_false_alarm": round(self.read.evidence.log10_false_alarm, 2),
            "row": (rows + cells.row0).tolist(),
            "column": (cols + cells.column0).tolist(),
            "x": np.round(cells.xy[seen][:, 0], 1).tolist(),
            "y": np.round(cells.xy[seen][:, 1], 1).tolist(),
            "expected": self.read.expected[seen].tolist(),
            "level": self.levels[seen].tolist(),
            "grey": [round(float(value), 1) for value in cells.values[seen]],
            "thresholds": [
                [round(float(value), 1) for value in row] for row in self.thresholds[seen]
            ],
            "fits": [
                {"quarter_turns": fit.quarter_turns, "mirrored": fit.mirrored,
                 "share": round(fit.share, 4)}
                for fit in self.fits
            ],
        }  # fmt: skip


def compare_cells(pyramid: Pyramid, camera: Camera, pad: Pad, pose: Pose) -> list[Comparison]:
    """Read every layer that a pose brings into view.

    Parameters
    ----------
    pyramid : Pyramid
        Of the prepared frame.
    camera : Camera
        At the frame's size.
    pad : Pad
    pose : Pose

    Returns
    -------
    list of Comparison
        In the order of the pad's layers, those in view.
    """
    found = []
    for layer in pad.layers:
        read = read_layer(pyramid, camera, pad, layer, MovingPose(pose), 1)
        if read is not None:
            levels = read.cells.levels(pad.levels)
            found.append(
                Comparison(
                    read, levels, read.cells.thresholds(pad.levels), tuple(_fits(read, levels))
                )
            )
    return found


def pose_of_corners(pyramid: Pyramid, camera: Camera, pad: Pad, corners_xy: Array) -> Pose | None:
    """The pose that puts a pad's corners where they were seen, in the turn that the cells tell.

    Parameters
    ----------
    pyramid, camera, pad
        As of `compare_cells`.
    corners_xy : (4, 2) float64
        The pad's corners one after the other, in either direction, frame pixels.

    Returns
    -------
    Pose or None
        None where they lie on a line, as nearly as anybody clicks, or no camera sees them so.
    """
    if _flatness_px(np.asarray(corners_xy, float)) < _LEAST_CORNER_PX:
        return None
    # A pad is seen from above, where its corners follow each other clockwise.
    x, y = np.asarray(corners_xy, float).T
    if float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) < 0:
        corners_xy = corners_xy[::-1]
    rays = camera.normalize(np.asarray(corners_xy, float))
    best: tuple[float, Pose] | None = None
    for turn in range(4):
        planar = planar_pose(np.roll(outline_mm(pad), turn, axis=0), rays)
        for pose in (planar.pose, planar.other) if planar else ():
            if pose is None or pose.position_mm[2] <= 0:
                continue
            score = _score(compare_cells(pyramid, camera, pad, pose))
            if best is None or score > best[0]:
                best = score, pose
    return None if best is None else best[1]


def _flatness_px(corners_xy: Array) -> float:
    """The least distance of a corner from the line through its two neighbours, pixels."""
    before, after = np.roll(corners_xy, 1, axis=0), np.roll(corners_xy, -1, axis=0)
    (along_x, along_y), (to_x, to_y) = (after - before).T, (corners_xy - before).T
    length = np.hypot(along_x, along_y)
    off = np.abs(along_x * to_y - along_y * to_x)
    return float(np.min(np.divide(off, length, out=np.zeros(4), where=length > 0)))


def _score(found: Sequence[Comparison]) -> float:
    return max((item.read.evidence.kappa for item in found), default=-1.0)


def _fits(read: LayerRead, levels: NDArray[np.int8]) -> list[Fit]:
    """The share of cells that agree, as the pose has the pad, turned, and mirrored."""
    field, cells = read.layer.field.astype(np.int8), read.cells
    whole = np.full(field.shape, -1, np.int8)
    rows, cols = levels.shape
    whole[cells.row0 : cells.row0 + rows, cells.column0 : cells.column0 + cols] = levels
    found = []
    for mirrored in (False, True):
        for turn in range(4):
            other = np.rot90(field[:, ::-1] if mirrored else field, turn)
            if other.shape == whole.shape:
                evidence: Evidence = judge(whole, np.ascontiguousarray(other), read.count, 1)
                share = 1 - evidence.wrong / max(evidence.read, 1)
                found.append(Fit(turn, mirrored, share))
    return found
