"""How far residuals are from being independent and as large as assumed: compiled.

Residuals near each other in the picture are alike: they share pixels, blocks of compression, what
the lens model leaves over. Taken for independent they promise too much. So the picture is divided
into tiles, and the scatter of the tiles' sums of scores stands for that of single residuals, as in
the cluster-robust ("sandwich") covariance.

References
----------
Liang, K.-Y. and Zeger, S. L. (1986). Longitudinal data analysis using generalized linear models.
doi:10.1093/biomet/73.1.13.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.geometry.small_matrices import inverse_trace

#: Tiles a side over what was measured: 64 sums of scores for at most 12 parameters.
TILES = 8
# Robustly weighted residuals of a normal law scatter by 0.4; fewer show less by chance.
_LEAST_NOISE = 0.35
# Pixels scatter alike as they share light, mosaic and compression: by 0.6 … 3.5 in frames at rest.
_LEAST_PATTERN_NOISE, _MOST_PATTERN_NOISE = 0.6, 3.5
# A covariance grows by no more than the inverse of this, as of `newton_share`.
_LEAST_SHARE = 0.3


@fast_jit
def newton_share(weight: Array, trust: Array) -> float:
    """How much steeper the robust sum of squares looks to its weights than it is.

    With weights 1/(1 + x²)² of residuals x over their cut-off, least squares are solved as if the
    weights stood still; that they fall as residuals grow makes the answer less sure.

    Parameters
    ----------
    weight : (N,) float64
        1/(1 + x²)².
    trust : (N,) float64
        What each residual is weighted with besides.
    """
    steep = total = 0.0
    for i in range(len(weight)):
        part = trust[i] * weight[i]
        steep += part * (4 * np.sqrt(weight[i]) - 3)
        total += part
    return least_share(steep / max(total, 1e-12))


@fast_jit
def least_share(share: float) -> float:
    """A share as of `newton_share`, where few residuals may not make it absurdly small."""
    return max(share, _LEAST_SHARE)


@fast_jit
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
    alone = inverse_trace(normal, squares) * count / max(count - 6, 1)
    # Few tiles tell by chance a half more or less than there is.
    near = min(scatter_of_tiles(normal, scores), most_alike * alone)
    return max(_LEAST_NOISE, alone / 6, near / 6)


@fast_jit
def pattern_noise(normal: Array, scores: Array) -> float:
    """As `noise_share`, of pixels: normal matrix (6, 6) and scores (T, 6) over their variance."""
    near = scatter_of_tiles(normal, scores) / 6
    return min(max(near, _LEAST_PATTERN_NOISE), _MOST_PATTERN_NOISE)


@fast_jit
def scatter_of_tiles(normal: Array, scores: Array) -> float:
    """Squared sums of scores (T, 6), in the metric of the normal matrix's inverse."""
    used, squares = 0, np.zeros((6, 6))
    for tile in range(len(scores)):
        some = False
        for a in range(6):
            some |= scores[tile, a] != 0.0
            for b in range(6):
                squares[a, b] += scores[tile, a] * scores[tile, b]
        used += some
    return inverse_trace(normal, squares) * used / max(used - 6, 1)


@fast_jit
def tiles_of(xy: Array) -> NDArray[np.intp]:
    """The tile, 0 … TILES² − 1, in which each of some pixels (N, 2) lies."""
    low_x = high_x = xy[0, 0]
    low_y = high_y = xy[0, 1]
    for i in range(len(xy)):
        low_x, high_x = min(low_x, xy[i, 0]), max(high_x, xy[i, 0])
        low_y, high_y = min(low_y, xy[i, 1]), max(high_y, xy[i, 1])
    across, down = TILES / max(high_x - low_x, 1e-9), TILES / max(high_y - low_y, 1e-9)
    tile = np.empty(len(xy), np.intp)
    for i in range(len(xy)):
        column = min(int((xy[i, 0] - low_x) * across), TILES - 1)
        row = min(int((xy[i, 1] - low_y) * down), TILES - 1)
        tile[i] = row * TILES + column
    return tile
