"""Where small parts of the pad lie in a picture: what a calibration is measured on.

All borders of cells in a patch tell one point of it, so that a point errs by less than any corner
would, and a patch whose borders do not agree with each other is none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.pose.edge_points import find_edge_points
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.stage.params import DetectorParams, RefineParams

# Sides of a patch: so many pixels, and no fewer cells.
_PATCH_PX, _LEAST_CELLS = 48.0, 2.0
# A patch needs so many borders, and as many as this of the rarer direction.
_LEAST_BORDERS, _LEAST_EITHER = 6, 2.0
# Borders of a patch agree to this share of a cell, and to so many pixels; wrong ones scatter over
# 0.42 of a cell on either side, by 0.24 in the mean.
_AGREED_CELLS, _AGREED_PX = 0.1, 0.15
# Borders further from their patch's mean than this share of a cell hardly count.
_SOFT_CELLS = 0.06
_ROUNDS = 4
_PARAMS = DetectorParams(refine=RefineParams(most_borders=20_000))


@dataclass(frozen=True, eq=False)
class Patches:
    """Points of the pad and where a picture shows them.

    Attributes
    ----------
    points_mm : (N, 3) float64
        Pad frame; Z is 0.
    pixels : (N, 2) float64
    sigma_px : (N,) float64
        One standard deviation of the pixels, by how far the borders of each patch scatter.
    layer : Layer
        Whose borders they are.
    """

    points_mm: Array
    pixels: Array
    sigma_px: Array
    layer: Layer

    def __len__(self) -> int:
        return len(self.pixels)

    def take(self, which: NDArray[np.bool_]) -> Patches:
        """Some of the patches."""
        parts = (self.points_mm[which], self.pixels[which], self.sigma_px[which])
        return Patches(*parts, self.layer)


class _Offsets(NamedTuple):
    """How far each border lies from its prediction along its normal, pixels, and in which patch."""

    off: Array
    normals: Array
    weight: Array
    patch: NDArray[np.intp]


def measure(
    pyramid: Pyramid, pad: Pad, layer: Layer, camera: Camera, pose: Pose, *, settled: bool
) -> Patches | None:
    """Find the patches of a layer that lie about where a camera and a pose put them.

    Patches that lie further off than 0.42 of a cell are left out, so that from a pose that is right
    at one place of the picture only, the part about it is found.

    Parameters
    ----------
    pyramid : Pyramid
    pad : Pad
    layer : Layer
    camera : Camera
    pose : Pose
    settled : bool
        Camera and pose are right to a pixel or two, so that short profiles will do, which are more
        exact.

    Returns
    -------
    Patches or None
        None where too little of the layer can be read.
    """
    refiner = Refiner(pyramid, camera, pad, _PARAMS, attempts=1)
    seen = MovingPose(pose)
    readable = refiner.readable(layer, seen)
    if readable is None:
        return None
    cell_px = readable.cell_px
    window = refiner.window(layer, cell_px, sharper=0)
    reach_px = cell_px / window.pixel
    if settled:
        window, reach_px = pyramid.window(layer.channel, 0), _PARAMS.refine.reach_px
    found = find_edge_points(readable.borders, window, camera, seen, reach_px)
    borders = found.borders
    side = max(_LEAST_CELLS, _PATCH_PX / cell_px) * layer.cell_mm
    cells = np.floor(borders.points_mm[:, :2] / side).astype(np.int64)
    _, patch = np.unique(cells, axis=0, return_inverse=True)
    middle = seen.project(camera, borders.points_mm)
    along = seen.project(camera, borders.points_mm + 0.2 * borders.along_mm) - middle
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1)
    off = np.einsum("ij,ij->i", found.xy - middle, normals)
    offsets = _Offsets(off, normals, found.weight, np.asarray(patch, np.intp).ravel())
    shift, sigma, weight, good = _shifts(offsets, cell_px)
    mass = np.maximum(_sums(offsets.patch, weight), 1e-12)
    centre = np.stack([_sums(offsets.patch, weight * x) for x in borders.points_mm.T], axis=1)
    points = centre / mass[:, None]
    pixels = seen.project(camera, np.ascontiguousarray(points)) + shift
    good &= np.isfinite(pixels).all(axis=1)
    return Patches(points, pixels, sigma, layer).take(good) if good.any() else None


def _shifts(borders: _Offsets, cell_px: float) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
    """By how much each patch is shifted (P, 2), its sigma (P,), the weights of borders (N,) and
    which patches hold together (P,): least squares over the borders' normals (IRLS, Cauchy)."""
    off, (nx, ny), patch = borders.off, borders.normals.T, borders.patch
    weight, soft = borders.weight, _SOFT_CELLS * cell_px
    for _ in range(_ROUNDS):
        xx, xy, yy = (_sums(patch, weight * a * b) for a, b in ((nx, nx), (nx, ny), (ny, ny)))
        bx, by = _sums(patch, weight * nx * off), _sums(patch, weight * ny * off)
        det = np.maximum(xx * yy - xy * xy, 1e-12)
        shift = np.stack([(yy * bx - xy * by) / det, (xx * by - xy * bx) / det], axis=1)
        rest = off - nx * shift[patch, 0] - ny * shift[patch, 1]
        weight = borders.weight / (1 + (rest / soft) ** 2)
    count, mass = _sums(patch, np.ones(len(off))), _sums(patch, borders.weight)
    spread = np.sqrt(_sums(patch, borders.weight * rest**2) / np.maximum(mass, 1e-12))
    trace = xx + yy
    rarer = (trace - np.sqrt(np.maximum(trace**2 - 4 * det, 0))) / 2
    sigma = spread / np.sqrt(np.maximum(rarer, 1e-12))
    agreed = max(_AGREED_CELLS * cell_px, _AGREED_PX)
    good = (count >= _LEAST_BORDERS) & (rarer >= _LEAST_EITHER) & (spread < agreed)
    return shift, sigma, weight, good


def _sums(patch: NDArray[np.intp], values: Array) -> Array:
    return np.asarray(np.bincount(patch, values, minlength=int(patch.max(initial=-1)) + 1), float)
