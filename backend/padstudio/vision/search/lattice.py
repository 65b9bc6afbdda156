"""Stage `grid`, dense: the lattice of cell corners that the edges lie on.

From the clearest part outward: edges are put to the nearest grid line, a plane projective map
from the tilted plane to lattice coordinates is fitted by least squares, and the circle of edges
that count grows, so that the map is always good enough to number the next lines. The map is a
homography, found by the direct linear transform with Cauchy weights, iteratively reweighted.

References
----------
Hartley, R. and Zisserman, A. (2004). Multiple View Geometry in Computer Vision, chapter 4.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.vision.search import search_kernel
from padstudio.vision.search.line_spacing import LineFamilies
from padstudio.vision.search.search_kernel import OnPlane

# Radius about the seed from which the map grows, cells, and by what factor: so near the spacing
# alone numbers the lines, and a map that fits there still does a little further out. 3.5 and 8,
# 1.25 and 2 find the same stills of the score.
_FIRST_RADIUS = 5.0
_GROWTH = 1.5
# An edge is an inlier within this part of a cell of a line; chance gives twice this share, 0.28.
_NEAR = 0.14
# Edges count for the fit within this part of a cell: half way to the border between two.
_GATE = 0.25
# Crossings of one lattice are those of another within this part of a cell.
_SAME = 0.15
# With such a share of inliers so many edges are those of a lattice, and of no steeper one besides.
_DOUBTLESS = ((0.9, 200), (0.7, 1000))
# Steps with all edges, at the end.
_SETTLING = 4
# Fewer edges of a family than this do not tell its lines.
_LEAST_EDGES = 6
# Share of edges on every k-th line, and lines left empty between, that tell of a wider spacing:
# clutter leaves some edges beside, and a code leaves one line empty by chance, not three.
_ON_THESE_LINES, _LEAST_EMPTY = 0.93, 3


@dataclass(frozen=True, eq=False)
class Lattice:
    """Numbered grid lines in the picture.

    Attributes
    ----------
    ray_from_lattice : (3, 3) float64
        Takes homogeneous lattice coordinates (column, row, 1) to camera rays, up to scale.
    columns, rows : (first, last)
        Range of lattice coordinates that edges support; cells lie between whole numbers.
    inlier_share : float
        Share of edges that lie on lines, 0.28 by chance … 1.
    edge_count : int
        Edges that lie on lines.
    families : LineFamilies
    """

    ray_from_lattice: Array
    columns: tuple[int, int]
    rows: tuple[int, int]
    inlier_share: float
    edge_count: int
    families: LineFamilies

    def to_rays(self, coordinates: Array) -> Array:
        """Rays on the plane z = 1, (N, 2), of lattice coordinates (N, 2): column, row."""
        h = np.column_stack([coordinates, np.ones(len(coordinates))]) @ self.ray_from_lattice.T
        return np.asarray(h[:, :2] / h[:, 2:], float)

    def coordinates(self, rays: Array) -> Array:
        """Lattice coordinates (N, 2) of rays (N, 2) on the plane z = 1."""
        h = np.column_stack([rays, np.ones(len(rays))]) @ np.linalg.inv(self.ray_from_lattice).T
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(h[:, :2] / h[:, 2:], float)

    def depth(self, coordinates: Array) -> Array:
        """Depths (N,) of lattice coordinates (N, 2) along the camera's axis, up to one factor."""
        last = self.ray_from_lattice[2]
        return np.asarray(coordinates @ last[:2] + last[2], float)

    @property
    def is_beyond_doubt(self) -> bool:
        """True where edges show the lattice so well that no other plane need be tried."""
        share, count = self.inlier_share, self.edge_count
        return any(share > least and count > few for least, few in _DOUBTLESS)

    def holds(self, other: Lattice) -> bool:
        """True where the other's cells are some of this one's."""
        first = np.array([self.columns[0], self.rows[0]])
        last = np.array([self.columns[1], self.rows[1]])
        corners = np.array([[c, r] for c in other.columns for r in other.rows], float)
        beside = corners + np.where(corners < corners.mean(axis=0), 1.0, -1.0)
        there, next_there = (self.coordinates(other.to_rays(at)) for at in (corners, beside))
        on_crossings = (np.abs(there - np.round(there)) < _SAME).all()
        by_one = (np.abs(np.abs(next_there - there) - 1) < _SAME).all()
        inside = ((there > first - _SAME) & (there < last + _SAME)).all()
        return bool(on_crossings and by_one and inside)

    def widened(self) -> Lattice:
        """The lattice carried on by its own width and height on every side."""
        wide, high = self.columns[1] - self.columns[0], self.rows[1] - self.rows[0]
        return replace(
            self,
            columns=(self.columns[0] - wide, self.columns[1] + wide),
            rows=(self.rows[0] - high, self.rows[1] + high),
        )


def find_lattice(families: LineFamilies) -> Lattice | None:
    """Fit the lattice to line families.

    Returns
    -------
    Lattice or None
        None where the growth lost the lines.
    """
    seed, phase = families.seed, families.phase
    every = _edges_of(families)
    distance = np.hypot(every.u, every.v)
    # Row 0 to 2: numerators for column, row and the common denominator, on (u, v, 1).
    fit = np.eye(3)
    fit[0, 2], fit[1, 2] = (seed - phase) % 1.0
    radius, reach = _FIRST_RADIUS, float(np.max(distance[families.on_u | families.on_v]))
    while True:
        for _ in range(2):
            near = distance < radius
            inner = every._replace(on_u=every.on_u & near, on_v=every.on_v & near)
            refined = _fit(fit, inner, radius)
            if refined is None:
                return None
            fit = refined
        if radius > reach:
            break
        radius *= _GROWTH
    return _best(fit, _settled(fit, every, radius), families)


def _edges_of(families: LineFamilies) -> OnPlane:
    """The edges about the families' seed."""
    u, v = families.u - families.seed[0], families.v - families.seed[1]
    return OnPlane(u, v, families.on_u, families.on_v)


def _settled(fit: Array, edges: OnPlane, radius: float) -> Array:
    """The map fitted to all edges, hardly held any more, until it stands still."""
    for _ in range(_SETTLING):
        refined = _fit(fit, edges, radius, hold=0.01)
        if refined is None:
            break
        fit = refined
    return fit


def _best(grown: Array, settled: Array, families: LineFamilies) -> Lattice | None:
    """Of two maps the one with more inliers."""
    found = [item for item in (_lattice(fit, families) for fit in (settled, grown)) if item]
    return max(found, key=lambda item: item.inlier_share, default=None)


def _coordinates(fit: Array, u: Array, v: Array) -> tuple[Array, Array]:
    w = fit[2, 0] * u + fit[2, 1] * v + 1.0
    w = np.where(w > 0.05, w, 0.05)
    return (
        (fit[0, 0] * u + fit[0, 1] * v + fit[0, 2]) / w,
        (fit[1, 0] * u + fit[1, 1] * v + fit[1, 2]) / w,
    )


def _coarser(column: Array, row: Array) -> Array | None:
    """The map (3, 3) to a lattice of wider spacing, where edges stand on every k-th line alone.

    A part of the true spacing explains all edges as well, and few cells may show it more strongly.
    """
    if min(len(column), len(row)) < _LEAST_EDGES:
        return None
    numbers = np.round(column).astype(np.intp), np.round(row).astype(np.intp)
    for times in (2, 3, 5):
        counts = [np.bincount(number % times, minlength=times) for number in numbers]
        if min(count.max() / count.sum() for count in counts) < _ON_THESE_LINES:
            continue
        first = [float(count.argmax()) for count in counts]
        spans = [np.diff(_ends(number, 0.02))[0] for number in numbers]
        # A code leaves one line of a few cells empty by chance, not several on both axes.
        if sum(spans) * (1 - 1 / times) >= _LEAST_EMPTY:
            shift = np.array([[1.0, 0, -first[0]], [0, 1.0, -first[1]], [0, 0, times]])
            return shift / times
    return None


def _ends(values: NDArray[Any], share: float) -> NDArray[Any]:
    """The least and the largest value, (2,), but for a share of outliers on either side."""
    last = len(values) - 1
    ends = [round(share * last), round((1 - share) * last)]
    return np.asarray(np.partition(values, ends)[ends])


def _fit(fit: Array, edges: OnPlane, radius: float, hold: float = 1.0) -> Array | None:
    """One step of least squares for the eight numbers of the map, given the nearest lines."""
    normal, right, least = search_kernel.lattice_equations(fit, edges, _GATE)
    if least < _LEAST_EDGES:
        return None
    # What few cells cannot tell (shear, convergence) is held at its last value.
    stiff = np.full(8, 1e-6)
    stiff[[1, 3]] = 4.0 * radius**2
    stiff[[0, 4]] = 1.0 * radius**2
    stiff[6:] = 40.0 * radius**4 / max(1.0, (radius / 6) ** 2)
    stiff[:] *= hold
    current = np.concatenate([fit[0], fit[1], fit[2, :2]])
    # numpy.linalg.solve takes several times as long for so small a matrix.
    _, solution = cv2.solve(normal + np.diag(stiff), (right + stiff * current)[:, None])
    solved = solution.ravel()
    out = np.array([solved[:3], solved[3:6], [solved[6], solved[7], 1.0]])
    return out if np.linalg.det(out) > 0.2 else None


def _lattice(fit: Array, families: LineFamilies) -> Lattice | None:
    edges = _edges_of(families)
    column, row = _coordinates(fit, edges.u, edges.v)
    good_u = families.on_u & (np.abs(column - np.round(column)) < _NEAR)
    good_v = families.on_v & (np.abs(row - np.round(row)) < _NEAR)
    coarser = _coarser(column[good_u], row[good_v])
    if coarser is not None:
        return _lattice(coarser @ fit, families)
    on = int(families.on_u.sum() + families.on_v.sum())
    good = int(good_u.sum() + good_v.sum())
    support = good_u | good_v
    if good < 20:
        return None
    low, high = _ends(column[support], 0.005), _ends(row[support], 0.005)
    shift = np.array([[1.0, 0, -families.seed[0]], [0, 1.0, -families.seed[1]], [0, 0, 1.0]])
    scale = np.diag([1 / families.pitch, 1 / families.pitch, 1.0])
    lattice_from_ray = fit @ shift @ scale @ families.axes
    return Lattice(
        ray_from_lattice=np.linalg.inv(lattice_from_ray),
        columns=(int(np.floor(low[0] + 0.3)), int(np.ceil(low[1] - 0.3))),
        rows=(int(np.floor(high[0] + 0.3)), int(np.ceil(high[1] - 0.3))),
        inlier_share=good / max(on, 1),
        edge_count=good,
        families=families,
    )
