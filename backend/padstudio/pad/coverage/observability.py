"""How surely a picture of a flat sign tells the camera's attitude and place.

Seen from straight above, a lean changes the picture of a small sign hardly at all: its sides
converge a little, and it is foreshortened in the second order only. So far away the lean is lost in
the noise long before the cells are, and with it the camera's place, which moves round the sign
with the lean.

With t the part of the sign's normal that lies in the picture (its length is sin θ), the
picture of a sign u pixels across its centre is stretched by −½ t tᵀ u and keystoned by
u (t · u) / f, while place, scale and heading are free. What noise there is in the measured places
turns both into χ², by which two leans can be told apart.

References
----------
Collins, T. and Bartoli, A. (2014). Infinitesimal plane-based pose estimation.
doi:10.1007/s11263-014-0725-5 (the two answers of a small plane).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

# Directions of an error that are looked at; none of them is a principal one.
_DIRECTIONS = 16


@dataclass(frozen=True)
class Hold:
    """What a picture's measured places tell of a lean.

    Attributes
    ----------
    stretch : float
        χ² of a unit stretch: of (a, b) with displacements (a u + b v, b u − a v) it is
        ``stretch`` (a² + b²).
    keystone : float
        χ² of a unit change of the normal by its keystone alone.
    """

    stretch: float
    keystone: float

    def apart(self, normal: tuple[float, float], other: tuple[float, float]) -> float:
        """χ² between two leans, given as the normal's parts (x, y) in the picture."""
        (x, y), (u, v) = normal, other
        a = (x * x - y * y - u * u + v * v) / 4
        b = (x * y - u * v) / 2
        far = (x - u) ** 2 + (y - v) ** 2
        return self.stretch * (a * a + b * b) + self.keystone * far


def hold_of_borders(
    side_px: float, cells_px: Sequence[float], focal_px: float, *, noise_px: float, blur_px: float
) -> Hold:
    """Hold on all borders between the cells of a square sign.

    Parameters
    ----------
    side_px : float
        Side of the part of the sign that the picture shows.
    cells_px : sequence of float
        Width of a cell of each layer.
    focal_px : float
    noise_px : float
        Noise of the place of one pixel's length of border, were it sharp and alone; that only some
        neighbouring cells differ is part of it.
    blur_px : float
        Standard deviation of the picture's blur, which wipes out borders near each other.
    """
    length_px = sum(side_px**2 / cell * _contrast(cell, blur_px) for cell in cells_px)
    # Half of the borders tell x, half y; the mean squares of u² less its mean, uv, u over a square.
    per_border = length_px / 2 / noise_px**2
    keystone = per_border * side_px**4 * (1 / 180 + 1 / 144) / focal_px**2
    return Hold(per_border * side_px**2 / 6, keystone)


def hold_of_corners(side_px: float, focal_px: float, *, noise_px: float) -> Hold:
    """Hold on the four corners of a square, each known to ``noise_px`` in x and in y."""
    return Hold(2 * (side_px / noise_px) ** 2, side_px**4 / (2 * noise_px * focal_px) ** 2)


def share_known(hold: Hold, tilt_rad: float, within_rad: float) -> float:
    """Share of pictures whose lean is found to within an angle.

    Errors in both directions follow χ²; of the two answers that a small sign allows, mirrored
    about the line of sight, the likelier one is taken.

    Parameters
    ----------
    hold : Hold
    tilt_rad : float
        0 … π/2.
    within_rad : float
        Above 0.
    """
    sine, cosine = math.sin(tilt_rad), math.cos(tilt_rad)
    missed = weights = 0.0
    for k in range(_DIRECTIONS):
        angle = 2 * math.pi * (k + 0.5) / _DIRECTIONS
        # A lean changes the normal's part along the tilt less than the one across it.
        along, across = within_rad * cosine * math.cos(angle), within_rad * math.sin(angle)
        chi2 = max(hold.apart((sine, 0.0), (sine + along, across)), 1e-12)
        # Of a Gaussian in the plane the part beyond a circle, direction by direction.
        missed += math.exp(-chi2 / 2) / chi2
        weights += 1 / chi2
    found = 1 - missed / weights
    if 2 * tilt_rad <= within_rad:
        return found
    mirrored = hold.apart((sine, 0.0), (-sine, 0.0))
    return found * (1 + math.erf(math.sqrt(mirrored / 8))) / 2


def _contrast(cell_px: float, blur_px: float) -> float:
    """What blur leaves of the slopes at the borders of random cells, 0 … 1, in squares.

    Of cells in a row that are light or dark at random the light's autocorrelation is a triangle;
    blurred, its curvature at 0 is the mean square of slopes across borders, its height what the
    neighbours along a border leave of them.
    """
    near = math.exp(-((cell_px / blur_px) ** 2) / 4)
    along = math.erf(cell_px / blur_px / 2) - 2 * blur_px / cell_px / math.sqrt(math.pi) * (
        1 - near
    )
    return (1 - near) * max(along, 0.0)
