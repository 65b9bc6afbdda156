"""Compiled sums of `padstudio.vision.pose.row_motion`: one pass over measured borders."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit

#: Parameters of a frame that stands still: centre, attitude, and how far steps of upright and of
#: level borders seem to lie toward the dark.
STATIC = 8


class RowSums(NamedTuple):
    """Normal equations by intervals of rows, within which f goes from 0 to 1.

    Attributes
    ----------
    normal : (3, I, 8, 8) float64
        Sums of Jᵀ J, of f Jᵀ J and of f² Jᵀ J.
    pull : (2, I, 8) float64
        Sums of Jᵀ r and of f Jᵀ r.
    """

    normal: Array
    pull: Array

    def about_rest(self, sway: Array) -> RowSums:
        """Sums about a shaking, as if they were about none.

        Parameters
        ----------
        sway : (I + 1, 3) float64
            Rotation vectors at the intervals' ends.
        """
        turns = self.normal[:, :, :, 3:6]
        begin, change = sway[:-1, :, None], np.diff(sway, axis=0)[:, :, None]
        moved = [(turns[k] @ begin + turns[k + 1] @ change)[:, :, 0] for k in range(2)]
        return RowSums(self.normal, self.pull + np.stack(moved))


@fast_jit
def row_sums(
    rows: Array, sides: Array, row_time: Array, trust: Array, first: float, width: float, count: int
) -> RowSums:
    """Sums over ``count`` intervals of row time from ``first`` on, each ``width`` long.

    Parameters
    ----------
    rows : (N, 7) float64
        Residuals, and their change with centre and attitude.
    sides : (N, 2) float64
        Their change with the two biases toward the dark.
    row_time, trust : (N,) float64
    first, width : float
    count : int
    """
    normal, pull = np.zeros((3, count, STATIC, STATIC)), np.zeros((2, count, STATIC))
    j = np.empty(STATIC)
    for i in range(len(rows)):
        at = (row_time[i] - first) / width
        k = min(max(int(at), 0), count - 1)
        f = at - k
        for a in range(6):
            j[a] = rows[i, 1 + a]
        j[6], j[7] = sides[i, 0], sides[i, 1]
        for a in range(STATIC):
            t = trust[i] * j[a]
            pull[0, k, a] += t * rows[i, 0]
            pull[1, k, a] += f * t * rows[i, 0]
            for b in range(a + 1):
                product = t * j[b]
                normal[0, k, a, b] += product
                normal[1, k, a, b] += f * product
                normal[2, k, a, b] += f * f * product
    for m in range(3):
        for k in range(count):
            for a in range(STATIC):
                for b in range(a):
                    normal[m, k, b, a] = normal[m, k, a, b]
    return RowSums(normal, pull)


@fast_jit
def noise_sums(
    rows: Array, trust: Array, tile: NDArray[np.intp], tiles: int
) -> tuple[Array, Array, Array]:
    """Of the pose's six parameters: normal matrix, sum of squared scores, and scores by tile."""
    normal, squares, scores = np.zeros((6, 6)), np.zeros((6, 6)), np.zeros((tiles, 6))
    for i in range(len(rows)):
        psi = trust[i] * rows[i, 0]
        for a in range(6):
            ja = rows[i, 1 + a]
            scores[tile[i], a] += psi * ja
            for b in range(a + 1):
                product = ja * rows[i, 1 + b]
                normal[a, b] += trust[i] * product
                squares[a, b] += psi * psi * product
    for a in range(6):
        for b in range(a):
            normal[b, a], squares[b, a] = normal[a, b], squares[a, b]
    return normal, squares, scores
