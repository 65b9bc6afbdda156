"""Stage `lines`, paper, second half: two families, misfits dropped, missing lines inserted.

Lines of a family meet in a vanishing point. Across the horizon through both vanishing points the
lines of a regular grid stand evenly, so that slope and spacing, which change steadily along a
family under perspective, are tested by one fit instead of a fixed step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.rolling_shutter import cross
from padstudio.vision.baseline import families_kernel, lines_kernel
from padstudio.vision.baseline.hough import Lines, homogeneous
from padstudio.vision.baseline.vanishing_points import aligned, two_vanishing_points
from padstudio.vision.stage.trace import Reason, StageFailure

Flags = NDArray[np.bool_]

# A line fits the spacing within this part of a step.
_NEAR = 0.12
# The step that explains this share of what the best one explains, and is the widest, is the cell.
_AS_GOOD = 0.88
_LEAST_LINES = 3
# Vanishing points, of length 1, that span less than this are one.
_LEAST_APART = 1e-6
# So often misfits are dropped and the rest is weighed anew.
_ROUNDS = 5
# Of the lines from a family's first to its last, this share must have been found.
_LEAST_FOUND = 0.4


@dataclass(frozen=True, eq=False)
class Family:
    """Lines of one direction, one for each number.

    Attributes
    ----------
    first : int
        Lattice coordinate of the first line; the others follow one by one.
    lines : (K, 3) float64
        Unit normal and offset, plane pixels of a lens without distortion: all where the fit has
        them, which by far is better than where a line with few edges was found.
    inserted : (K,) bool
        True where no line was found.
    """

    first: int
    lines: Array
    inserted: Flags

    @property
    def last(self) -> int:
        """Lattice coordinate of the last line."""
        return self.first + len(self.lines) - 1


@dataclass(frozen=True, eq=False)
class LineGrid:
    """Two numbered families of lines.

    Attributes
    ----------
    columns, rows : Family
        Lines of constant column, and of constant row; right-handed as the picture is.
    lattice_from_plane : (3, 3) float64
        Takes homogeneous plane pixels, undistorted, to lattice coordinates (column, row, 1), up
        to scale.
    rms_px : float
        Root mean square distance of the lines' ends from the fit, plane pixels.
    found : Lines
        All merged lines.
    kept : (M,) bool
        Which of them belong to the grid.
    dropped : tuple of str
        Why each of them was dropped, empty where it was kept; none where nobody asked.
    """

    columns: Family
    rows: Family
    lattice_from_plane: Array
    rms_px: float
    found: Lines
    kept: Flags
    dropped: tuple[str, ...] = ()


# Why a line is dropped, at each step that it may fail, from the first one on.
_REASONS = (
    "its direction fits neither family",
    "it crosses a better supported line of its family",
    "its place is off the even spacing of its family",
    "it lies off the fitted grid",
)


def find_line_grid(found: Lines) -> LineGrid | StageFailure:
    """Group lines into two families, drop those that do not fit, insert those that are missing."""
    h, w = found.edges.mask.shape
    # Coordinates near 1 keep the homogeneous equations well conditioned.
    scale = 2.0 / max(h, w)
    to_unit = np.array([[scale, 0, -scale * w / 2], [0, scale, -scale * h / 2], [0, 0, 1.0]])
    ends = found.ends * scale + to_unit[:2, 2]
    points = two_vanishing_points(ends, found.support)
    if points is None:
        return _too_few(found, "they do not fall into two families of directions")
    horizon = cross(points[0], points[1])
    if not np.linalg.norm(horizon) > _LEAST_APART:
        return _too_few(found, "their two families of directions are one")
    lines = homogeneous(ends)
    numbers = np.full((2, len(ends)), np.nan)
    steps = np.zeros(len(ends), np.intp)
    for axis in (0, 1):
        pointing = aligned(points[axis], ends)
        ordered = pointing & lines_kernel.uncrossed(ends, pointing, found.support)
        steps = np.maximum(steps, pointing.astype(np.intp) + ordered)
        which = np.flatnonzero(ordered)
        if len(which) >= _LEAST_LINES:
            place = _places(lines[which], points[axis], horizon)
            numbers[axis, which] = _number(place, found.support[which])
    steps += np.isfinite(numbers).any(axis=0)
    fit = _fit_lattice(ends, numbers, found.support)
    if fit is None:
        return _too_few(found, "no even spacing fits two families of them")
    return _grid(fit, to_unit, numbers, found, steps)


def _places(lines: Array, point: Array, horizon: Array) -> Array:
    """Where lines of a family stand: even steps for a regular grid, whatever the perspective."""
    # Of the lines through the point the one farthest from the horizon, at right angles to it.
    foot = cross(point, horizon)
    along, across = lines @ (foot / np.linalg.norm(foot)), lines @ horizon
    return np.asarray(across / np.linalg.norm(horizon) / np.where(along == 0, 1e-12, along), float)


def _number(place: Array, support: Array) -> Array:
    """Lattice numbers (N,) of lines by the widest even step that fits; NaN for misfits."""
    top = np.argsort(-support, kind="stable")[:30]
    sorted_places = np.sort(place[top])
    gaps = np.concatenate([sorted_places[k:] - sorted_places[:-k] for k in (1, 2) if k < len(top)])
    gaps = gaps[gaps > 1e-4]
    steps = np.unique(np.concatenate([gaps / k for k in (1, 2, 3)])) if len(gaps) else gaps
    if not len(steps):
        return np.full(len(place), np.nan)
    anchors = place[top[:8]]
    scores, best = families_kernel.weigh_steps(place, support, steps, anchors, _NEAR)
    good = np.flatnonzero(scores >= _AS_GOOD * scores.max())
    step = int(good[-1])
    # The widest step has neighbours that fit almost as well: the best of them is taken.
    close = np.flatnonzero(np.abs(steps / steps[step] - 1) < 0.15)
    step = int(close[np.argmax(scores[close])])
    chosen = (place - anchors[best[step]]) / steps[step]
    number = np.round(chosen)
    return np.where(np.abs(chosen - number) < 2 * _NEAR, number, np.nan)


def _fit_lattice(ends: Array, numbers: Array, support: Array) -> Array | None:
    """The projective map (3, 3) to lattice coordinates under which ends lie on their lines.

    ``numbers`` loses the misfits.
    """
    limits = 1.5 * _NEAR, _LEAST_LINES, _ROUNDS
    found, fit = families_kernel.fit_lattice(ends, numbers, support, *limits)
    return fit if found and all(_dense_enough(family) for family in numbers) else None


def _dense_enough(numbers: Array) -> bool:
    """Whether enough of a family's lines were found: else any lines at all would be a grid."""
    known = np.unique(numbers[np.isfinite(numbers)])
    return len(known) >= _LEAST_LINES and len(known) >= _LEAST_FOUND * (known[-1] - known[0])


def _coordinates(fit: Array, xy: Array) -> Array:
    """Lattice coordinates (..., 2) of points (..., 2)."""
    h = np.concatenate([xy, np.ones((*xy.shape[:-1], 1))], axis=-1) @ fit.T
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(h[..., :2] / h[..., 2:], float)


def _grid(
    fit: Array, to_unit: Array, numbers: Array, found: Lines, steps: NDArray[np.intp]
) -> LineGrid | StageFailure:
    """The grid of a fit; of each line `steps` says how many it passed before the fit."""
    kept = np.asarray(np.isfinite(numbers).any(axis=0))
    fit = fit @ to_unit
    upright, numbers = _oriented(fit, found.ends[kept].reshape(-1, 2).mean(axis=0), numbers)
    if upright is None:
        return _too_few(found, "their two families lie on one another")
    distances = []
    for axis in (0, 1):
        which = np.isfinite(numbers[axis])
        lines = _lines(upright, axis, numbers[axis, which])
        along = (found.ends[which] * lines[:, None, :2]).sum(axis=2)
        distances.append(along + lines[:, 2:])
    families = [_family(upright, axis, numbers[axis]) for axis in (0, 1)]
    rms = float(np.sqrt(np.mean(np.square(np.concatenate(distances)))))
    dropped = tuple(
        "" if is_kept else _REASONS[step] for is_kept, step in zip(kept, steps, strict=True)
    )
    return LineGrid(families[0], families[1], upright, rms, found, kept, dropped)


def _oriented(fit: Array, middle: Array, numbers: Array) -> tuple[Array | None, Array]:
    """The map with columns to the right and rows down, as far as its turn allows."""
    at = _coordinates(fit, middle + np.array([[0, 0], [1, 0], [0, 1]]))
    jacobian = np.stack([at[1] - at[0], at[2] - at[0]], axis=1)
    if not np.isfinite(jacobian).all() or abs(np.linalg.det(jacobian)) < 1e-12:
        return None, numbers
    fit = fit.copy()
    if abs(jacobian[0, 1]) > abs(jacobian[0, 0]):
        fit[[0, 1]], numbers, jacobian = fit[[1, 0]], numbers[::-1].copy(), jacobian[::-1]
    signs = np.sign([jacobian[0, 0], 1.0])
    signs[1] = np.sign(np.linalg.det(jacobian)) * signs[0]
    fit[:2] *= signs[:, None]
    return fit, numbers * signs[:, None]


def _lines(fit: Array, axis: int, numbers: Array) -> Array:
    """Lines (K, 3) of a family by their numbers (K,), with unit normals."""
    lines = fit[axis] - numbers[:, None] * fit[2]
    return np.asarray(lines / np.hypot(lines[:, :1], lines[:, 1:2]), float)


def _family(fit: Array, axis: int, numbers: Array) -> Family:
    """All lines from a family's first to its last, where the fit has them."""
    known = np.unique(numbers[np.isfinite(numbers)])
    every = np.arange(known[0], known[-1] + 1)
    inserted = np.ones(len(every), bool)
    inserted[(known - known[0]).astype(np.intp)] = False
    return Family(int(known[0]), _lines(fit, axis, every), inserted)


def _too_few(found: Lines, why: str) -> StageFailure:
    return StageFailure(
        "lines",
        Reason.TOO_FEW_LINES,
        f"{len(found.ends)} lines in {found.edges.plane.channel}; {why}",
    )
