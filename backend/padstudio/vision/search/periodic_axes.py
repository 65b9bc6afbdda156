"""Stage `lines`, dense, where noise hides directions: axes by the lines' spacing on both.

Edges of a veiled frame point anywhere, so that planes hardly differ in how well edges agree with
them (`plane_normals`); where they lie is told far better. For many planes and turns the positions
of the edges along both axes are looked at for a spacing that both share (Bartlett's periodograms,
as of `line_spacing`), and the clearest one wins.
"""

from __future__ import annotations

import math

import numpy as np

from padstudio.arrays import Array
from padstudio.vision.search import search_kernel as kernels
from padstudio.vision.search.edges import EdgeSet
from padstudio.vision.search.line_spacing import SPACINGS, TILE, pixels_per_unit, tiles_of
from padstudio.vision.search.periodic_kernel import most_periodic
from padstudio.vision.search.plane_normals import ring

# Planes up to 35 degrees, ten degrees apart, and turns about the one that edges agree with best;
# then planes about the best one, half as far apart.
_NORMALS = np.concatenate([[[0.0, 0.0, 1.0]], ring(((10, 6), (20, 12), (30, 16)))])
_NEAR = np.concatenate([[[0.0, 0.0, 1.0]], ring(((4, 6), (8, 8)))])
_TURNS, _NEAR_TURNS = np.radians(np.arange(-12, 13, 3)), np.radians([-1.5, 0.0, 1.5])
# So many edges tell.
_EDGES = 1000
# Frequencies, in parts of what a tile resolves.
_STEP = 0.4


def find_periodic_axes(edges: EdgeSet) -> tuple[float, Array]:
    """The axes along both of which edges lie most evenly spaced.

    Returns
    -------
    contrast : float
        Spectral power of the spacing over that of unordered edges.
    axes : (3, 3) float64
        As in `LineFamilies`.
    """
    every = max(1, -(-len(edges.xy) // _EDGES))
    tile, count = tiles_of(edges)
    rays = edges.rays / np.linalg.norm(edges.rays, axis=1, keepdims=True)
    some = kernels.Edges(rays[::every], edges.lines[::every])
    unit = pixels_per_unit(edges)
    step = _STEP / TILE
    first, last = math.ceil(1 / SPACINGS[1] / step), math.floor(1 / SPACINGS[0] / step)
    band = (first, last, unit * step)
    tiles = (tile[::every], count)
    angles = np.angle(kernels.coherence(_NORMALS, some)) / 4
    found = most_periodic(_NORMALS, angles, _TURNS, some, tiles, band)
    normal = found[1][2]
    flat = kernels.axes_at(normal, 0.0)
    about = _NEAR @ flat
    turn = math.atan2(float(found[1][0] @ flat[1]), float(found[1][0] @ flat[0]))
    near = most_periodic(about, np.full(len(about), turn), _NEAR_TURNS, some, tiles, band)
    return max(found, near, key=lambda item: item[0])
