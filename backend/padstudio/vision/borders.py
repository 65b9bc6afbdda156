"""The borders between cells of unlike level: what the pose is measured on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.motion import MovingPose
from padstudio.vision.planes import Plane
from padstudio.vision.types import Array

# Profiles are averaged over lines to this share of half a cell on either side.
_BESIDE = 0.5
# A step of so many grey values is fully trusted.
_CLEAR_STEP = 6.0
# So many borders of a kind tell how far its steps lean toward the dark.
_LEAST_TO_LEAN = 12


@dataclass(frozen=True, eq=False)
class Borders:
    """Middles of cell borders of one layer.

    Attributes
    ----------
    points_mm : (N, 3) float64
        Pad frame.
    across_mm : (N, 3) float64
        From the middle one cell further across the border, pad frame.
    along_mm : (N, 3) float64
        Half a cell along the border, pad frame.
    step : (N,) float64
        Level behind the border less level before it, over Y−1.
    """

    points_mm: Array
    across_mm: Array
    along_mm: Array
    step: Array

    def take(self, which: NDArray[np.intp]) -> Borders:
        """Some of the borders."""
        return Borders(
            self.points_mm[which], self.across_mm[which], self.along_mm[which], self.step[which]
        )

    def thinned(self, most: int) -> Borders:
        """At most ``most`` of the borders, evenly spread."""
        stride = -(-len(self.step) // most)
        return self if stride <= 1 else self.take(np.arange(0, len(self.step), stride))


@dataclass(frozen=True, eq=False)
class Measured:
    """Borders found in a picture.

    Attributes
    ----------
    borders : Borders
    xy : (N, 2) float64
        Where the steps lie, frame pixels.
    weight : (N,) float64
        Relative trust, 0 … 1.
    """

    borders: Borders
    xy: Array
    weight: Array

    def thinned(self, most: int) -> Measured:
        """At most ``most`` of them, evenly spread."""
        stride = -(-len(self.xy) // most)
        if stride <= 1:
            return self
        which = np.arange(0, len(self.xy), stride)
        return Measured(self.borders.take(which), self.xy[which], self.weight[which])


def concatenate(parts: list[Measured]) -> Measured:
    """Several layers' measured borders as one."""
    if len(parts) == 1:
        return parts[0]
    borders = Borders(
        np.concatenate([part.borders.points_mm for part in parts]),
        np.concatenate([part.borders.across_mm for part in parts]),
        np.concatenate([part.borders.along_mm for part in parts]),
        np.concatenate([part.borders.step for part in parts]),
    )
    return Measured(
        borders,
        np.concatenate([part.xy for part in parts]),
        np.concatenate([part.weight for part in parts]),
    )


def layer_borders(pad: Pad, layer: Layer, rows: tuple[int, int], cols: tuple[int, int]) -> Borders:
    """All borders of unlike cells within a range of rows and columns of a layer."""
    field = layer.field[rows[0] : rows[1], cols[0] : cols[1]].astype(np.int16)
    right, down = np.diff(field, axis=1), np.diff(field, axis=0)
    r1, c1 = np.nonzero(right)
    r2, c2 = np.nonzero(down)
    sx, sy = layer.cell_mm * pad.scale[0], layer.cell_mm * pad.scale[1]
    w, h = pad.size_mm
    column = np.concatenate([c1 + 1.0, c2 + 0.5]) + cols[0]
    row = np.concatenate([r1 + 0.5, r2 + 1.0]) + rows[0]
    zero = np.zeros(len(column))
    points = np.stack([column * sx - w / 2, h / 2 - row * sy, zero], axis=1)
    upright = np.arange(len(column)) < len(r1)
    across = np.where(upright[:, None], [sx, 0.0, 0.0], [0.0, -sy, 0.0])
    along = np.where(upright[:, None], [0.0, -sy / 2, 0.0], [sx / 2, 0.0, 0.0])
    step = np.concatenate([right[r1, c1], down[r2, c2]]) / (pad.levels - 1.0)
    return Borders(points, across, along, step)


def measure(
    borders: Borders, plane: Plane, camera: Camera, pose: MovingPose, reach_px: float
) -> Measured:
    """Find each border's step near where a pose predicts it.

    Along the normal of each predicted border a short profile is taken, averaged over three lines
    side by side; the step lies at the centroid of the squared slope of the right sign.

    Parameters
    ----------
    borders : Borders
    plane : Plane
    camera : Camera
    pose : MovingPose
    reach_px : float
        Half length of a profile, plane pixels; never more than 0.42 of a cell.
    """
    from padstudio.vision import kernels

    middle, side, cell = pose.project_borders(
        camera, borders.points_mm, 0.2 * borders.along_mm, 0.05 * borders.across_mm
    )
    cell *= 20
    size = np.hypot(cell[:, 0], cell[:, 1])
    tangent = side / np.maximum(np.hypot(side[:, 0], side[:, 1]), 1e-9)[:, None]
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    depth = normal[:, 0] * cell[:, 0] + normal[:, 1] * cell[:, 1]
    normal *= np.sign(depth)[:, None]
    reach = np.minimum(reach_px * plane.pixel, 0.42 * np.abs(depth))
    inside = _inside(plane, middle, reach, size)
    which = np.flatnonzero(inside)
    middle, normal, reach = middle[which], normal[which], reach[which]
    found = kernels.find_steps(
        plane.values,
        plane.from_frame(middle),
        normal * (reach / plane.pixel)[:, None],
        side[which] * (_BESIDE * 5 / plane.pixel),
        np.sign(borders.step[which]),
    )
    shift, rise, spent = found.T
    clean = np.clip(2 * rise / np.maximum(spent, 1e-9) - 1, 0, 1)
    weight = clean * clean * np.clip(rise / _CLEAR_STEP, 0, 1)
    keep = weight > 0.05
    kept = borders.take(which[keep])
    off = (shift * reach)[keep]
    off -= _lean(off, kept)
    return Measured(kept, middle[keep] + normal[keep] * off[:, None], weight[keep])


def _lean(off: Array, borders: Borders) -> Array:
    """By how much steps seem to lie toward the dark, pixels, (N,).

    A tone curve steepens the dark half of a blurred step, so that its middle seems to lie there:
    by a third of a pixel in a sharp picture, more where it is blurred, and then not alike for
    upright and level borders. Borders that rise and those that fall are off by opposite amounts,
    while a pose that is not yet right moves both alike.
    """
    upright, rising = borders.across_mm[:, 0] != 0, borders.step > 0
    out = np.zeros(len(off))
    for group in (upright, ~upright):
        up, down = group & rising, group & ~rising
        if min(int(up.sum()), int(down.sum())) >= _LEAST_TO_LEAN:
            out[group] = (np.median(off[up]) - np.median(off[down])) / 2
    return np.asarray(np.where(rising, out, -out))


def _inside(plane: Plane, middle: Array, reach: Array, size: Array) -> NDArray[np.bool_]:
    local = plane.from_frame(middle)
    h, w = plane.values.shape
    border = np.maximum(reach, 0.25 * size) / plane.pixel + 1
    return np.asarray(
        (local[:, 0] > border)
        & (local[:, 1] > border)
        & (local[:, 0] < w - 1 - border)
        & (local[:, 1] < h - 1 - border)
    )
