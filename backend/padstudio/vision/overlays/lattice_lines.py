"""Grid lines of the dense method as data: which edges bear out, which lie between, which not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.vision.overlays.marks import Line, LineKind
from padstudio.vision.search.lattice import Lattice
from padstudio.vision.search.line_spacing import LineFamilies

# An edge lies on a line within this part of a step, as in `padstudio.vision.search.lattice`.
_NEAR = 0.14
# A line is found where so many edges lie on it.
_LEAST_EDGES = 3
# Edges that gather beside the lines are a line that was dropped where they are so many, and this
# part of what a line of the grid has; places are told apart by this part of a step.
_LEAST_GATHERED, _SHARE, _BIN = 8, 0.4, 0.1
# Lines of a lens are bent, so they are drawn through so many points.
_POINTS = 24
_MOST_LINES = 200


@dataclass(frozen=True, eq=False)
class _Numbered:
    """Edges in lattice coordinates, and the way back into the frame."""

    ray_from_lattice: Array
    coordinates: Array
    on: tuple[NDArray[np.bool_], NDArray[np.bool_]]
    spans: tuple[tuple[int, int], tuple[int, int]]
    camera: Camera

    def stroke(self, axis: int, place: float) -> Array:
        """Frame pixels (N, 2) of a line of constant column (axis 0) or row (axis 1)."""
        along = np.linspace(*self.spans[1 - axis], _POINTS)
        fixed = np.full_like(along, place)
        at = np.stack((fixed, along) if axis == 0 else (along, fixed), axis=1)
        rays = np.column_stack([at, np.ones(len(at))]) @ self.ray_from_lattice.T
        ahead = rays[:, 2] * np.sign(np.median(rays[:, 2])) > 1e-9
        return self.camera.denormalize(rays[ahead, :2] / rays[ahead, 2:])


def lattice_lines(found: Lattice, camera: Camera) -> list[Line]:
    """The lines of a lattice.

    Parameters
    ----------
    found : Lattice
    camera : Camera
        At the frame's size.

    Returns
    -------
    list of Line
        A line of the grid on which no edges lie is inserted; edges that gather between its lines
        are one that was dropped.
    """
    lattice_from_ray = np.asarray(np.linalg.inv(found.ray_from_lattice), float)
    spans = found.columns, found.rows
    return list(_lines(_numbered(found.families, lattice_from_ray, spans, camera)))


def family_lines(families: LineFamilies, camera: Camera) -> list[Line]:
    """The same of line families of which no lattice was made: evenly spaced about their seed."""
    first = families.seed - families.phase
    shift = np.array([[1.0, 0, -first[0]], [0, 1.0, -first[1]], [0, 0, 1.0]])
    scale = np.diag([1 / families.pitch, 1 / families.pitch, 1.0])
    at = families.u - first[0], families.v - first[1]
    on = families.on_u, families.on_v
    ends = [np.quantile(value[which], [0.02, 0.98]) for value, which in zip(at, on, strict=True)]
    spans = tuple((int(np.floor(low)), int(np.ceil(high))) for low, high in ends)
    numbered = _numbered(families, shift @ scale @ families.axes, spans, camera)  # type: ignore[arg-type]
    return list(_lines(numbered))


def _numbered(
    families: LineFamilies,
    lattice_from_ray: Array,
    spans: tuple[tuple[int, int], tuple[int, int]],
    camera: Camera,
) -> _Numbered:
    h = families.edges.rays @ lattice_from_ray.T
    with np.errstate(divide="ignore", invalid="ignore"):
        coordinates = h[:, :2] / h[:, 2:]
    on, back = (families.on_u, families.on_v), np.asarray(np.linalg.inv(lattice_from_ray), float)
    return _Numbered(back, coordinates, on, spans, camera)


def _lines(numbered: _Numbered) -> Iterator[Line]:
    for axis in (0, 1):
        first, last = numbered.spans[axis]
        place = numbered.coordinates[:, axis]
        place = place[numbered.on[axis] & np.isfinite(place)]
        place = place[(place > first - 0.5) & (place < last + 0.5)]
        number = np.rint(place)
        near = np.abs(place - number) < _NEAR
        counts = np.bincount((number[near] - first).astype(np.intp), minlength=last - first + 1)
        step = max(1, (last - first) // _MOST_LINES)
        for k in range(first, last + 1, step):
            kind: LineKind = "found" if counts[k - first] >= _LEAST_EDGES else "inserted"
            text = f"{counts[k - first]} edge points lie on it"
            yield Line(numbered.stroke(axis, k), axis, kind, k, text)
        found = counts[counts >= _LEAST_EDGES]
        least = max(_LEAST_GATHERED, _SHARE * float(np.median(found)) if len(found) else 0)
        for middle, count in _gathered(place[~near], least):
            off = abs(middle - round(middle))
            reason = f"{count} edge points {off:.2f} of a step beside the nearest line of the grid"
            yield Line(numbered.stroke(axis, middle), axis, "dropped", None, reason)


def _gathered(place: Array, least: float) -> Iterator[tuple[float, int]]:
    """Where places gather, and how many do."""
    bins = np.floor(place / _BIN).astype(np.intp)
    for value, count in zip(*np.unique(bins, return_counts=True), strict=True):
        if count >= least:
            yield float(np.median(place[bins == value])), int(count)
