"""A bent sheet: where each point of the flat pad lies.

Paper bends and does not stretch. Heights h draw it in: its plane displacement (u, v) keeps lengths
where u_x = −h_x²/2, v_y = −h_y²/2 and u_y + v_x = −h_x h_y, to second order in the slopes (von
Kármán's strains, all zero). They are met by least squares.

References
----------
Landau, L. D. and Lifshitz, E. M. (1986). Theory of Elasticity, section 14. Kabsch, W. (1976). A
solution for the best rotation to relate two sets of vectors. doi:10.1107/S0567739476001873.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from padstudio.arrays import Array
from padstudio.geometry.pose import Pose
from padstudio.vision.bend.smooth_field import Cosines, solve

# Order of the polynomials of the plane displacement, and places a side that tell them.
_ORDER, _PLACES = 6, 15
_POWERS = np.array([(i, j) for i in range(_ORDER + 1) for j in range(_ORDER + 1 - i)])
# Chebyshev coefficients of the slopes of Chebyshev polynomials, one a column.
_SLOPES = np.vstack([chebyshev.chebder(np.eye(_ORDER + 1)), np.zeros(_ORDER + 1)])
_SIDE = np.linspace(-1, 1, _PLACES)
_WITHIN = np.stack(np.meshgrid(_SIDE, _SIDE), axis=-1).reshape(-1, 2)
# Rigid motions change no length; this little weight keeps them small.
_RIGID_WEIGHT = 1e-6


@dataclass(frozen=True, eq=False)
class Sheet:
    """A sheet's heights and the displacement in its plane that goes with them.

    Attributes
    ----------
    cosines : Cosines
    coefficients : (K,) float64
    box : (2, 2) float64
        Least and largest x and y of what is measured, mm.
    """

    cosines: Cosines
    coefficients: Array
    box: Array

    @classmethod
    def flat(cls, cosines: Cosines, box: Array) -> Sheet:
        """A sheet without heights."""
        return cls(cosines, np.zeros(len(cosines.modes)), box)

    def displacement(self, points_mm: Array) -> Array:
        """How far points (N, 3) of the flat pad lie from their places, (N, 3), mm."""
        xy = points_mm[:, :2]
        height = self.cosines.at(xy) @ self.coefficients
        within = (xy - self._middle) / self._half
        return np.column_stack([_polynomials(within) @ self._in_plane, height])

    def laid(self, points_mm: Array) -> Array:
        """Where points (N, 3) of the flat pad lie, (N, 3), mm."""
        return np.asarray(points_mm + self.displacement(points_mm))

    def flatness_mm(self, points_mm: Array) -> float:
        """Peak to valley of heights at points (N, 3) over the plane that fits them best."""
        return float(np.ptp(self.flattened(points_mm)[0][:, 2]))

    def flattened(self, points_mm: Array) -> tuple[Array, Array, Array]:
        """The rigid motion that brings the sheet nearest to the flat pad, over points (N, 3).

        Returns
        -------
        laid : (N, 3) float64
            The points as they lie, after the motion.
        turn : (3, 3) float64
        shift : (3,) float64
            A point p of the sheet goes to ``turn @ p + shift``.
        """
        laid = self.laid(points_mm)
        middle, laid_middle = points_mm.mean(axis=0), laid.mean(axis=0)
        left, _, right = np.linalg.svd((points_mm - middle).T @ (laid - laid_middle))
        turn = left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right
        shift = middle - turn @ laid_middle
        return np.asarray(laid @ turn.T + shift), turn, shift

    def relative(self, pose: Pose, points_mm: Array) -> Pose:
        """A pose relative to the plane that fits the sheet best at points (N, 3)."""
        _, turn, shift = self.flattened(points_mm)
        return Pose(turn @ pose.position_mm + shift, turn @ pose.rotation)

    @property
    def _middle(self) -> Array:
        return np.asarray(self.box.mean(axis=0))

    @property
    def _half(self) -> Array:
        return np.asarray(np.maximum((self.box[1] - self.box[0]) / 2, 1e-9))

    def changes(self, cosines: Cosines, points_mm: Array) -> tuple[Array, Array, Array]:
        """How points (N, 3) move, along x, y and z, (N, K) each, as coefficients are added.

        Parameters
        ----------
        cosines : Cosines
            Whose coefficients; the sheet's own or others over the same box.
        points_mm : (N, 3) float64
        """
        slopes, grid = self._slopes, self._grid
        more = [cosines.at(grid.at, axis) for axis in (0, 1)]
        crossed = slopes[0][:, None] * more[1] + slopes[1][:, None] * more[0]
        along = [slopes[axis][:, None] * more[axis] for axis in (0, 1)]
        xy = points_mm[:, :2]
        within = _polynomials((xy - self._middle) / self._half)
        found = grid.without_strain(np.vstack([*along, crossed]))
        return within @ found[0], within @ found[1], cosines.at(xy)

    @cached_property
    def _grid(self) -> Grid:
        return Grid(self._middle, self._half)

    @cached_property
    def _slopes(self) -> tuple[Array, Array]:
        x, y = (self.cosines.at(self._grid.at, axis) @ self.coefficients for axis in (0, 1))
        return np.asarray(x), np.asarray(y)

    @cached_property
    def _in_plane(self) -> Array:
        """Coefficients (P, 2) of the displacement in the plane, without its rigid part."""
        x, y = self._slopes
        strain = np.concatenate([x**2 / 2, y**2 / 2, x * y])
        return np.asarray(self._grid.without_strain(strain[:, None])[:, :, 0].T)


class Grid:
    """Places of a box at which lengths are kept.

    Parameters
    ----------
    middle, half : (2,) float64
        Of the box, mm.
    """

    def __init__(self, middle: Array, half: Array) -> None:
        self._within = _WITHIN
        self._half = half
        #: (G, 2) float64: the places, mm.
        self.at = middle + self._within * half

    def without_strain(self, strain: Array) -> Array:
        """Displacements in the plane that take strains away, without their rigid part.

        Parameters
        ----------
        strain : (3 G, M) float64
            Along x, along y, and twice the shear, of M sheets.

        Returns
        -------
        (2, P, M) float64
            Coefficients of polynomials, of the displacements along x and y.
        """
        keeping = _keeping(float(self._half[0]), float(self._half[1]))
        found = (keeping @ strain).reshape(2, len(_POWERS), -1)
        x, y = (self._within * self._half).T
        u, v = _polynomials(self._within) @ found
        turn = (x @ v - y @ u) / (x @ x + y @ y)
        found[:, _row(0, 0)] -= [u.mean(axis=0), v.mean(axis=0)]
        found[0, _row(0, 1)] += turn * self._half[1]
        found[1, _row(1, 0)] -= turn * self._half[0]
        return found


@lru_cache(maxsize=8)
def _keeping(half_x: float, half_y: float) -> Array:
    """What makes coefficients (2 P,) of strains (3 G,) at the places of a box, by least squares."""
    along_x, along_y = _polynomials(_WITHIN, 0) / half_x, _polynomials(_WITHIN, 1) / half_y
    nothing = np.zeros_like(along_x)
    design = np.block([[along_x, nothing], [nothing, along_y], [along_y, along_x]])
    normal = design.T @ design
    normal[np.diag_indices_from(normal)] += _RIGID_WEIGHT / max(half_x, half_y) ** 2
    return -solve(normal, design.T)


def _row(power_x: int, power_y: int) -> int:
    """Where a product of two polynomials stands among the coefficients."""
    return int(np.flatnonzero((_POWERS[:, 0] == power_x) & (_POWERS[:, 1] == power_y))[0])


def _polynomials(within: Array, slope: int | None = None) -> Array:
    """Products of Chebyshev polynomials, or their slopes along an axis, at points (N, 2)."""
    parts = []
    for axis in range(2):
        one = chebyshev.chebvander(within[:, axis], _ORDER)
        if slope == axis:
            one = one @ _SLOPES
        parts.append(np.ascontiguousarray(one.T)[_POWERS[:, axis]])
    return np.asarray((parts[0] * parts[1]).T)
