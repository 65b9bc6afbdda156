"""Are the cells readable, if the true pose is known? An upper bound for any detector.

The cells of a layer are sampled where the truth puts them. Within blocks of cells, colours are
explained as linear in the cell's own level and in the other layers' mean level there, on a part of
the cells; the others are classified by the nearest prediction (Fisher's linear discriminant, 1936).
The detector's own test of chance (a-contrario) says whether so many could agree by chance.
It knows the pose, the bend of the paper, each row's moment and the other layers, which a detector
does not; it does not know the levels that it reads.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.lay.fit import laid
from padstudio.simulate.motion import poses_at
from padstudio.simulate.radiance.lens import in_picture, pixels_of_points
from padstudio.simulate.radiance.sheet import half_sides_mm
from padstudio.simulate.render import Truth
from padstudio.vision.cells.evidence import Evidence, judge

Array = NDArray[np.float64]
# Pixels (N, 2) of points of the flat pad (N, 2), mm.
Project = Callable[[Array], Array]

#: Chance below which the cells count as readable, log10.
READABLE = -6.0
# Cells a side of a block in which light and colours count as even.
_BLOCK = 9
# Points a side of a cell that are averaged, over its middle half; and the least side, pixels.
_POINTS, _SPAN, _LEAST_PX = 3, 0.5, 1.2


@dataclass(frozen=True)
class Reading:
    """What the oracle reads of a pad's layers, which stand or fall together.

    Attributes
    ----------
    read, wrong : int
        Cells of all layers, and those that differ.
    log10_chance : float
        Of so many agreeing at any of the pad's places.
    """

    read: int
    wrong: int
    log10_chance: float

    @property
    def readable(self) -> bool:
        """Whether so many agree that it cannot be chance."""
        return self.log10_chance <= READABLE


def best_reading(image: NDArray[np.uint8], pad: Pad, truth: Truth) -> Reading:
    """What can be read of a simulated frame."""

    def project(points: Array) -> Array:
        return _seen(truth, points)

    return _together(image, pad, project)


def _seen(truth: Truth, points: Array) -> Array:
    """Pixels (N, 2) of flat pad points (N, 2) as the print lies, each row at its moment."""
    scene, camera = truth.scene, truth.camera
    if scene.lay is None:
        there = np.column_stack([points, np.zeros(len(points))])
    else:
        there = laid(scene.lay, half_sides_mm(scene), points)
    pixels = _visible(camera, truth.pose.to_camera(there))
    readout_s = truth.imaging.readout_ms / 1000.0
    if truth.motion.still or not readout_s:
        return pixels
    for _ in range(4):
        rows = np.nan_to_num(pixels[:, 1], nan=0.0)
        times = np.clip((rows - (camera.height - 1) / 2) / camera.height, -0.5, 0.5) * readout_s
        rotations, positions = poses_at(truth.pose, truth.motion, times)
        turned = np.einsum("nij,ni->nj", rotations, there - positions)
        pixels = _visible(camera, turned)
    return pixels


def _visible(camera: Camera, points: Array) -> Array:
    """Pixels (N, 2) of points of the camera frame; NaN out of the picture."""
    shown = in_picture(camera, points)
    return np.where(shown[:, None], pixels_of_points(camera, points), np.nan)


def reading_at(image: NDArray[np.uint8], pad: Pad, camera: Camera, poses: list[Pose]) -> Reading:
    """As `best_reading`, of a frame of which only poses are known, each as true as the others."""
    found = []
    for pose in poses:

        def project(points: Array, pose: Pose = pose) -> Array:
            there = np.column_stack([points, np.zeros(len(points))])
            return _visible(camera, pose.to_camera(there))

        found.append(_together(image, pad, project))
    return min(found, key=lambda reading: reading.log10_chance)


def _together(image: NDArray[np.uint8], pad: Pad, project: Project) -> Reading:
    """All layers at one place: their chances multiply, and the places count once."""
    read = [_read(image, pad, layer, project) for layer in pad.layers]
    seen = [evidence for evidence in read if evidence is not None]
    chance = sum(evidence.log10_false_alarm for evidence in seen)
    return Reading(
        read=sum(evidence.read for evidence in seen),
        wrong=sum(evidence.wrong for evidence in seen),
        log10_chance=min(chance + np.log10(_places(pad)), 0.0),
    )


def _read(image: NDArray[np.uint8], pad: Pad, layer: Layer, project: Project) -> Evidence | None:
    """The cells of one layer that are in view; None where there are hardly any."""
    rows, cols = layer.field.shape
    pixels = project(_points(pad, layer)).reshape(rows, cols, _POINTS, _POINTS, 2)
    inside = (pixels > 0).all(-1) & (pixels < np.array(image.shape[1::-1]) - 1).all(-1)
    spread = np.linalg.norm(pixels[:, :, -1, -1] - pixels[:, :, 0, 0], axis=-1)
    side = spread / np.sqrt(2) / (_SPAN * (_POINTS - 1) / _POINTS)
    seen = inside.all(axis=(2, 3)) & (side > _LEAST_PX)
    if seen.sum() < 4:
        return None
    at = np.nan_to_num(pixels, nan=-1.0).astype(np.float32).reshape(rows, -1, 2)
    values = cv2.remap(image.astype(np.float32), at[..., 0], at[..., 1], cv2.INTER_LINEAR)
    values = values.reshape(rows, cols, _POINTS * _POINTS, 3).mean(axis=2)
    beside = [_mean_level(other, layer) for other in pad.layers if other is not layer]
    others = np.stack(beside or [np.zeros((rows, cols))], axis=-1)
    levels = _classified(values, layer.field, others, seen, pad.levels)
    expected = np.where(levels >= 0, layer.field, -1).astype(np.int8)
    return judge(levels, expected, pad.levels, 1)


def _points(pad: Pad, layer: Layer) -> Array:
    """Points of the flat pad within each cell's middle half, (N, 2), mm; cell by cell."""
    rows, cols = layer.field.shape
    width, height = pad.size_mm
    steps = ((np.arange(_POINTS) + 0.5) / _POINTS - 0.5) * _SPAN + 0.5
    r, c, i, j = np.meshgrid(
        np.arange(rows), np.arange(cols), np.arange(_POINTS), np.arange(_POINTS), indexing="ij"
    )
    x = (c + steps[j]) * layer.cell_mm * pad.scale[0] - width / 2
    y = height / 2 - (r + steps[i]) * layer.cell_mm * pad.scale[1]
    return np.stack([x, y], axis=-1).reshape(-1, 2)


def _places(pad: Pad) -> int:
    """All places and quarter turns of all layers."""
    return 4 * sum(layer.field.size for layer in pad.layers)


def _mean_level(other: Layer, own: Layer) -> Array:
    """Mean level of another layer over each cell's middle half; off that layer its last cells'."""
    parts = (np.arange(_POINTS) + 0.5) / _POINTS * _SPAN + (1 - _SPAN) / 2
    last = np.array(other.field.shape) - 1
    total = np.zeros(own.field.shape)
    for dy in parts:
        for dx in parts:
            r, c = (
                np.minimum((np.arange(n) + d) * own.cell_mm / other.cell_mm, end).astype(int)
                for n, d, end in zip(own.field.shape, (dy, dx), last, strict=True)
            )
            total += other.field[np.ix_(r, c)]
    return total / _POINTS**2


def _classified(
    values: Array, field: NDArray[np.uint8], others: Array, seen: NDArray[np.bool_], count: int
) -> NDArray[np.int8]:
    """Levels (R, C) of each part of the cells by what the others teach; −1 unread."""
    out = np.full(field.shape, -1, np.int8)
    row, col = np.indices(field.shape)
    # Few cells in view: all of them are one block, and each few are told by all others.
    many = seen.sum() > 2 * _BLOCK**2
    size, folds = (_BLOCK, 2) if many else (max(field.shape), 8)
    fold = (row + col) % 2 if many else (3 * row + col) % folds
    kind = (row // size) * (field.shape[1] // size + 1) + col // size
    for block in np.unique(kind[seen]):
        cells = seen & (kind == block)
        for part in range(folds):
            test, learn = cells & (fold == part), cells & (fold != part)
            if test.any() and learn.sum() >= 3:
                out[test] = _predicted(
                    (values[learn], field[learn], others[learn]), values[test], others[test], count
                )
    return out


def _predicted(
    known: tuple[Array, NDArray[np.uint8], Array], values: Array, others: Array, count: int
) -> NDArray[np.int8]:
    """The level of each cell whose predicted colour is nearest."""
    colours, own, beside = known
    one = np.ones((len(own), 1))
    # A ridge keeps the fit sane where a block holds but one level of a layer.
    terms = np.column_stack([one, own, beside]).astype(float)
    ridge = np.diag([1e-6, *[0.05] * (terms.shape[1] - 1)])
    weights = np.linalg.solve(terms.T @ terms + ridge, terms.T @ colours)
    rest = colours - terms @ weights
    covariance = rest.T @ rest / max(len(rest), 1) + np.eye(3)
    whiten = np.linalg.cholesky(np.linalg.inv(covariance))
    errors = []
    for level in range(count):
        guess = np.column_stack([np.ones(len(values)), np.full(len(values), level), others])
        errors.append((((values - guess @ weights) @ whiten) ** 2).sum(axis=1))
    return np.argmin(np.array(errors), axis=0).astype(np.int8)
