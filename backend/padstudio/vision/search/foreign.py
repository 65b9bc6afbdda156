"""Patterns that are read clearly and are no pad's: what they explain need not be searched again.

A foreign pad or a board shows its lattice at every scale and in every channel. Once its cells were
read without doubt and compared in vain, all that another try could find is the same lattice.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.vision.cells.correlation import Placement
from padstudio.vision.search.lattice import Lattice

# A pattern has so many of its edges on lines and so many cells.
_CLEAR_SHARE, _CELLS = 0.9, 100
# Cells are read clearly where their values scatter about their levels by no more than this share of
# what values without any levels would. Pads of the score and of the reality frames that were not
# read at a first try had more, fewer cells, or agreed.
_SCATTER = 0.4
# Neighbours of a code are unlike in half of all places or more; a lattice of half the spacing shows
# every cell four times.
_UNLIKE = 0.35
# Cells that agree with a pad more than this bound says are not foreign.
_LOG10_AGREES = -3.0
# An edge lies on a line within this part of a cell.
_NEAR = 0.14


def is_foreign(lattice: Lattice, placement: Placement, levels: int) -> bool:
    """True where cells are read without doubt, and do not agree even with the likeliest place.

    Parameters
    ----------
    lattice : Lattice
    placement : Placement
        The best one of a pad's layer.
    levels : int
        Y, the pad's number of levels.
    """
    if lattice.inlier_share < _CLEAR_SHARE:
        return False
    if placement.evidence.suffices(_LOG10_AGREES, least_kappa=0.0):
        return False
    cells = placement.cells
    if int(cells.seen.sum()) < _CELLS:
        return False
    level = cells.levels(levels)
    return _scatter(cells.relative, level, levels) < _SCATTER and _unlike(level) > _UNLIKE


def _scatter(relative: NDArray[np.float32], level: NDArray[np.int8], levels: int) -> float:
    """Variance of values within their levels, over that of as many even parts."""
    read = level >= 0
    values, level = relative[read], level[read]
    count = np.maximum(np.bincount(level, minlength=levels), 1)
    mean = np.bincount(level, values, levels) / count
    within = float(((values - mean[level]) ** 2).mean())
    return within * levels**2 / max(float(values.var()), 1e-9)


def _unlike(level: NDArray[np.int8]) -> float:
    """Share of neighbours whose levels differ."""
    unlike = pairs = 0
    for a, b in ((level[1:], level[:-1]), (level[:, 1:], level[:, :-1])):
        both = (a >= 0) & (b >= 0)
        pairs += int(both.sum())
        unlike += int((both & (a != b)).sum())
    return unlike / max(pairs, 1)


def within(lattice: Lattice, normalized: Array) -> NDArray[np.bool_]:
    """Which points (N, 2) of the plane z = 1 lie where a lattice has cells."""
    return _inside(lattice, lattice.coordinates(normalized))


def explained(lattice: Lattice, normalized: Array) -> NDArray[np.bool_]:
    """Of the points `within` those that lie on the lattice's lines."""
    places = lattice.coordinates(normalized)
    off = np.abs(places - np.round(places)).min(axis=1)
    return np.asarray(_inside(lattice, places) & (off < _NEAR))


def _inside(lattice: Lattice, places: Array) -> NDArray[np.bool_]:
    first = np.array([lattice.columns[0], lattice.rows[0]]) - 1
    last = np.array([lattice.columns[1], lattice.rows[1]]) + 1
    return np.asarray(((places > first) & (places < last)).all(axis=1))
