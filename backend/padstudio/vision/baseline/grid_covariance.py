"""How well a grid of lines holds a window's corners: every line has its part in each."""

from __future__ import annotations

import numpy as np

from padstudio.arrays import Array
from padstudio.vision.baseline.line_grid import LineGrid

# Lines are no better than this share of a plane's pixel, whatever their residuals say.
_LEAST_SIGMA = 0.1
# A projective map of the plane.
_FREE = 8


def corners_covariance(grid: LineGrid, corners: Array) -> Array:
    """Covariance of a lattice's points in the picture, propagated from its lines' scatter.

    The lattice is the weighted least squares fit to the ends of all its lines; ends are off their
    lines independently of each other.

    Parameters
    ----------
    grid : LineGrid
    corners : (N, 2) float64
        Lattice coordinates (column, row).

    Returns
    -------
    (2 N, 2 N) float64
        Of x and y of one corner after the other, undistorted plane pixels.
    """
    h, w = grid.found.edges.mask.shape
    # Coordinates near 1 keep the equations well conditioned.
    to_plane = np.array([[w / 2, 0, w / 2], [0, w / 2, h / 2], [0, 0, 1.0]])
    fit = grid.lattice_from_plane @ to_plane
    fit = fit / np.linalg.norm(fit)
    distances, weights = _derivatives(grid, fit, np.linalg.inv(to_plane))
    sigma = max(grid.rms_px * np.sqrt(len(weights) / max(len(weights) - _FREE, 1)), _LEAST_SIGMA)
    weighted = distances * weights[:, None]
    # The map's scale is free: the ninth direction says nothing.
    values, vectors = np.linalg.eigh(distances.T @ weighted)
    gain = vectors[:, 1:] / values[1:] @ vectors[:, 1:].T @ weighted.T
    moved = _corner_derivatives(fit, corners) @ gain
    return np.asarray(sigma**2 * (moved @ moved.T), float)


def _derivatives(grid: LineGrid, fit: Array, from_plane: Array) -> tuple[Array, Array]:
    """Of the ends' distances (2 M, 9) from their lines by the map, and their weights (2 M,)."""
    ends = grid.found.ends[grid.kept].reshape(-1, 2)
    points = np.column_stack([ends, np.ones(len(ends))]) @ from_plane.T
    at = points @ fit.T
    at = at[:, :2] / at[:, 2:]
    # Along a line one coordinate stays.
    apart = np.abs(np.diff(at.reshape(-1, 2, 2), axis=1))[:, 0]
    axis = np.repeat(apart.argmin(axis=1), 2)
    number = np.round(at[np.arange(len(at)), axis])
    lines = fit[axis] - number[:, None] * fit[2]
    along = points / np.linalg.norm(lines[:, :2], axis=1, keepdims=True)
    derivatives = np.zeros((len(points), 3, 3))
    derivatives[np.arange(len(points)), axis] = along
    derivatives[:, 2] = -number[:, None] * along
    return derivatives.reshape(-1, 9), np.repeat(grid.found.support[grid.kept], 2)


def _corner_derivatives(fit: Array, corners: Array) -> Array:
    """Of lattice points' places (2 N, 9) in the picture, by the map."""
    back = np.linalg.inv(fit)
    points = np.column_stack([corners, np.ones(len(corners))]) @ back.T
    moved = -np.einsum("ir,ns->nirs", back, points).reshape(len(points), 3, 9)
    at = points[:, :2] / points[:, 2:]
    moved = (moved[:, :2] - at[:, :, None] * moved[:, 2:]) / points[:, 2:, None]
    return np.asarray(moved.reshape(-1, 9), float)
