"""How sure a fitted pose is, from its residuals as they are rather than as they should be.

Residuals near each other in the picture are alike: they share pixels, blocks of compression, what
the lens model leaves over. Taken for independent they promise too much. So the picture is divided
into tiles, and the scatter of the tiles' sums of scores stands for that of single residuals: the
cluster-robust ("sandwich") covariance. What is known beforehand, or left out of the model, enters
as consider parameters.

References
----------
Liang, K.-Y. and Zeger, S. L. (1986). Longitudinal data analysis using generalized linear models.
doi:10.1093/biomet/73.1.13. Schmidt, S. F. (1966). Application of state-space methods to navigation
problems: parameters that are not estimated, but considered.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array

#: Tiles a side over what was measured: 64 sums of scores for at most 12 parameters.
TILES = 8
# Scatter over what independent residuals would have; fewer tiles than needed may show less.
_LEAST_SCATTER = 0.5
# Robustly weighted residuals of a normal law scatter by 0.4; fewer show less by chance.
_LEAST_NOISE = 0.35
# Pixels scatter alike as they share light, mosaic and compression: by 0.6 … 3.5 in frames at rest.
_LEAST_PATTERN_NOISE, _MOST_PATTERN_NOISE = 0.6, 3.5
# A covariance grows by no more than the inverse of this, as of `newton_share`.
_LEAST_SHARE = 0.3
# Sensor mosaic, chroma of half resolution and calibration move the whole picture by so much.
_PICTURE_SHIFT_PX = 0.03


def newton_share(weight: Array, trust: Array | float = 1.0) -> float:
    """How much steeper the robust sum of squares looks to its weights than it is.

    With weights 1/(1 + x²)² of residuals x over their cut-off, least squares are solved as if the
    weights stood still; that they fall as residuals grow makes the answer less sure.

    Parameters
    ----------
    weight : (N,) float
        1/(1 + x²)².
    trust : (N,) float64 or float
        What each residual is weighted with besides.
    """
    share = np.sqrt(weight)
    steep = weight * (4 * share - 3)
    return least_share(float((trust * steep).sum() / max((trust * weight).sum(), 1e-12)))


def least_share(share: float) -> float:
    """A share as of `newton_share`, where few residuals may not make it absurdly small."""
    return max(share, _LEAST_SHARE)


def noise_share(
    normal: Array, squares: Array, scores: Array, count: int, most_alike: float
) -> float:
    """Scatter of scores over that of residuals as large and as independent as assumed.

    Parameters
    ----------
    normal, squares : (6, 6) float64
        Of the pose: normal matrix, and the sum of squared scores.
    scores : (T, 6) float64
        Sums of scores by tile.
    count : int
        Residuals.
    most_alike : float
        Residuals near each other raise the scatter of single ones by no more than this factor.
    """
    root = _inverse_root(normal)
    used = int(np.count_nonzero(scores.any(axis=1)))
    alone = np.einsum("ai,ab,bi->", root, squares, root) * count / max(count - 6, 1)
    near = ((scores @ root) ** 2).sum() * used / max(used - 6, 1)
    # Few tiles tell by chance a half more or less than there is.
    return max(_LEAST_NOISE, float(alone) / 6, min(float(near), most_alike * float(alone)) / 6)


def pattern_noise(normal: Array, scores: Array) -> float:
    """As `noise_share`, of pixels: normal matrix (6, 6) and scores (T, 6) over their variance."""
    white = scores @ _inverse_root(normal)
    used = int(np.count_nonzero(scores.any(axis=1)))
    near = float((white**2).sum()) * used / max(used - 6, 1) / 6
    return min(max(near, _LEAST_PATTERN_NOISE), _MOST_PATTERN_NOISE)


def tiles_of(xy: Array) -> NDArray[np.intp]:
    """The tile, 0 … TILES² − 1, in which each of some pixels (N, 2) lies."""
    low_x, low_y = xy[:, 0].min(), xy[:, 1].min()
    across = TILES / max(float(xy[:, 0].max() - low_x), 1e-9)
    down = TILES / max(float(xy[:, 1].max() - low_y), 1e-9)
    column = np.minimum(((xy[:, 0] - low_x) * across).astype(np.intp), TILES - 1)
    row = np.minimum(((xy[:, 1] - low_y) * down).astype(np.intp), TILES - 1)
    return np.asarray(row * TILES + column, np.intp)


def pose_covariance(normal: Array, scores: Array, pull: Array) -> Array:
    """Covariance of the solution of normal equations.

    Parameters
    ----------
    normal : (K, K) float64
        Inverse covariance if all residuals were independent and as large as assumed, with what is
        known beforehand.
    scores : (T, K) float64
        Sums over tiles of the gradients of single residuals at the solution.
    pull : (K, M) float64
        What one standard deviation of each of M things that are not measured adds to the right
        side: of what is known beforehand, and of what the model leaves out.

    Returns
    -------
    (K, K) float64
        Nowhere below half the inverse of ``normal``.
    """
    size, used = len(normal), int(np.count_nonzero(np.abs(scores).sum(axis=1)))
    root = _inverse_root(normal)
    white = root.T @ np.column_stack([scores.T, pull])
    seen, unseen = white[:, : len(scores)], white[:, len(scores) :]
    # The fit makes the sums smaller than they would be about the truth.
    scatter = seen @ seen.T * (used / max(used - size, 1)) + unseen @ unseen.T
    values, vectors = np.linalg.eigh(scatter)
    spread = root @ (vectors * np.sqrt(np.maximum(values, _LEAST_SCATTER)))
    return np.asarray(spread @ spread.T)


def _inverse_root(normal: Array) -> Array:
    """(K, K), which times its transpose is the inverse of a matrix; units may differ widely."""
    unit = 1 / np.sqrt(np.maximum(np.diag(normal), 1e-300))
    values, vectors = np.linalg.eigh(normal * np.outer(unit, unit))
    return np.asarray(unit[:, None] * vectors / np.sqrt(np.maximum(values, 1e-14)))


def with_picture_shift(covariance: Array, focal_px: float) -> Array:
    """A pose's covariance (6, 6) with what moves all of a picture alike: a turn of the camera."""
    out = covariance.copy()
    out[[3, 4], [3, 4]] += (_PICTURE_SHIFT_PX / focal_px) ** 2
    return out
