"""Where the points of a print lie, and the plane that fits them best."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.pose import Pose
from padstudio.simulate.lay.relief import NODES, Relief
from padstudio.simulate.lay.tiles import Tiles

# Points that make a fit.
_FEWEST = 12


def best_fit(
    lay: Relief | Tiles,
    half_mm: tuple[float, float],
    pose: Pose,
    seen: Callable[[Array], NDArray[np.bool_]] | None = None,
) -> Pose:
    """The pose relative to the plane that fits a print best, rather than to the nominal one.

    The rigid motion from the flat print to the print as it lies, by least squares over its area
    (Umeyama 1991, doi:10.1109/34.88573, without scale).

    Parameters
    ----------
    lay : Relief or Tiles
    half_mm : (x, y)
        Half sides of the print.
    pose : Pose
        Relative to the nominal plane.
    seen : callable, optional
        Tells which of the points (N, 3) as they lie count, (N,) bool; all, where it is not given
        or hardly any would.
    """
    flat, bent = _points(lay, half_mm)
    chosen = np.ones(len(bent), bool) if seen is None else seen(bent)
    if chosen.sum() >= _FEWEST:
        flat, bent = flat[chosen], bent[chosen]
    middle, there = flat.mean(axis=0), bent.mean(axis=0)
    u, _, vt = np.linalg.svd((bent - there).T @ (flat - middle))
    turn = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
    shift = there - turn @ middle
    return Pose(turn.T @ (pose.position_mm - shift), turn.T @ pose.rotation)


def laid(lay: Relief | Tiles, half_mm: tuple[float, float], points: Array) -> Array:
    """Where points of the flat print (N, 2) lie, (N, 3), mm, pad frame.

    Raises
    ------
    SpecError
        As `Relief.nodes`.
    """
    half = np.array(half_mm)
    if isinstance(lay, Relief):
        nodes = lay.nodes(*half_mm)
        at = np.clip((points / half + 1) / 2, 0, 1) * (NODES - 1)
        first = np.minimum(at.astype(int), NODES - 2)
        f, g = (at - first).T[:, :, None]
        c, r = first.T
        below = (1 - f) * nodes[r, c] + f * nodes[r, c + 1]
        above = (1 - f) * nodes[r + 1, c] + f * nodes[r + 1, c + 1]
        flat = np.column_stack([points, np.zeros(len(points))])
        return np.asarray(flat + (1 - g) * below + g * above, float)
    tiles = lay.placed(*half_mm)
    away = np.abs(points[:, None, :] - tiles[None, :, 6:8]) - tiles[None, :, 4:6]
    mine = tiles[np.argmin(away.max(axis=-1), axis=1)]
    u, v = (points - mine[:, 6:8]).T
    x = mine[:, 0] + mine[:, 2] * u - mine[:, 3] * v
    y = mine[:, 1] + mine[:, 3] * u + mine[:, 2] * v
    return np.stack([x, y, np.zeros(len(points))], axis=1)


def _points(lay: Relief | Tiles, half_mm: tuple[float, float]) -> tuple[Array, Array]:
    """(N, 3) points all over the flat print, and where they lie."""
    # Off the seams of any tiling.
    x, y = (half * (np.arange(161) - 80) / 80.37 for half in half_mm)
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return np.column_stack([points, np.zeros(len(points))]), laid(lay, half_mm, points)
