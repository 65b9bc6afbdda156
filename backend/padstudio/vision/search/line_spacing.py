"""Stage `lines`, dense, second half: which edges lie on grid lines, and the lines' spacing.

The spacing is one frequency common to both families' edge positions along the axes: the peak of
periodograms averaged over tiles of the picture.

References
----------
Bartlett, M. S. (1950). Periodogram analysis and continuous spectra. Biometrika 37.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.vision.search.edges import EdgeSet
from padstudio.vision.search.search_kernel import LEAST_COSINE

# An edge belongs to a family when its direction on the plane is within this slope of the axis, 10
# degrees; 5 and 20 find the same stills of the score.
LEAST_SLOPE = 0.18
# Spacings looked for, pixels of the plane: from where edges of neighbouring lines are still apart
# to one that a coarser scale shows as well. Tiles whose spectra are summed hold two of the widest
# or more (55 and 220 find the same stills of the score). Bins are of half a pixel, and many enough
# for a fine spectrum at the widest spacing.
SPACINGS = (3.6, 44.0)
TILE = 110
_BINS = 1024
_BINS_A_PIXEL = 2


@dataclass(frozen=True, eq=False)
class LineFamilies:
    """Directions and spacing of the grid lines.

    Attributes
    ----------
    axes : (3, 3) float64
        Rows: the lines' two directions and the plane's normal (away from the camera), unit
        vectors of the camera frame, right-handed.
    coherence : float
        0 … 1, how well the edges agree with the axes.
    pitch : float
        Spacing of the lines for a plane at distance 1 along the normal.
    contrast : float
        Spectral power of the spacing over that of unordered edges.
    u, v : (N,) float64
        Edge positions along the two axes over `pitch`, on the plane at distance 1.
    on_u, on_v : (N,) bool
        Edges on lines of constant u, and of constant v.
    phase : (2,) float64
        Where in a pitch the lines of constant u and v lie amid `seed`, 0 … 1.
    seed : (2,) float64
        u, v amid the part of the picture with the clearest spacing.
    edges : EdgeSet
    """

    axes: Array
    coherence: float
    pitch: float
    contrast: float
    u: Array
    v: Array
    on_u: NDArray[np.bool_]
    on_v: NDArray[np.bool_]
    phase: Array
    seed: Array
    edges: EdgeSet


def find_lines(edges: EdgeSet, coherence: float, axes: Array) -> LineFamilies | None:
    """Spacing of the grid lines for given axes.

    The edges' positions along each axis are periodic. The power spectra of the positions in
    tiles of the picture are summed over tiles and both axes, so that the spacing need only be
    steady within a tile; the strongest frequency is the spacing's, because a code's edges stand
    on every line and on nothing finer.

    Returns
    -------
    LineFamilies or None
        None where fewer than a handful of edges lie along the axes.
    """
    depth = edges.rays @ axes[2]
    u, v = (edges.rays @ axes[k] / np.maximum(depth, 1e-6) for k in (0, 1))
    across_u, across_v = np.abs(edges.lines @ axes[0]), np.abs(edges.lines @ axes[1])
    seen = depth > LEAST_COSINE
    on_u = seen & (across_v < LEAST_SLOPE * across_u)
    on_v = seen & (across_u < LEAST_SLOPE * across_v)
    if min(int(on_u.sum()), int(on_v.sum())) < 8:
        return None
    tile, count = tiles_of(edges)
    unit = 1 / pixels_per_unit(edges)
    spectra = [_spectrum(value[on], tile[on], count, unit) for value, on in ((u, on_u), (v, on_v))]
    power = spectra[0].power + spectra[1].power
    total = spectra[0].total + spectra[1].total
    frequency = np.arange(power.shape[1]) * _BINS_A_PIXEL / _BINS
    allowed = (frequency > 1 / SPACINGS[1]) & (frequency < 1 / SPACINGS[0])
    summed = np.where(allowed, power.sum(axis=0), -np.inf)
    best = int(np.argmax(summed))
    contrast = float(summed[best] / max(total, 1.0))
    pitch = unit / _peak(summed, best) * _BINS / _BINS_A_PIXEL
    clearest = int(np.argmax(np.minimum(spectra[0].power[:, best], spectra[1].power[:, best])))
    here = tile == clearest
    if not (here & on_u).any() or not (here & on_v).any():
        return None
    u, v = u / pitch, v / pitch
    seed = np.array([np.median(u[here & on_u]), np.median(v[here & on_v])])
    phase = np.array([_phase(u[here & on_u]), _phase(v[here & on_v])])
    return LineFamilies(axes, coherence, pitch, contrast, u, v, on_u, on_v, phase, seed, edges)


@dataclass(frozen=True, eq=False)
class _Spectrum:
    power: Array
    total: float


def _spectrum(values: Array, tile: NDArray[np.intp], count: int, unit: float) -> _Spectrum:
    """Power spectra (tiles, frequencies) of positions, less what unordered edges would give."""
    bin_number = np.floor(values / unit * _BINS_A_PIXEL).astype(np.int64) % _BINS
    histogram = np.bincount(tile * _BINS + bin_number, minlength=count * _BINS)
    table = histogram.reshape(count, _BINS).astype(np.float32)
    transform = np.fft.rfft(table, axis=1)
    power = transform.real**2 + transform.imag**2
    unordered = (table**2).sum(axis=1, keepdims=True)
    return _Spectrum(power - unordered, float(table.sum()))


def tiles_of(edges: EdgeSet) -> tuple[NDArray[np.intp], int]:
    plane = edges.plane
    local = plane.from_frame(edges.xy)
    h, w = plane.values.shape
    columns, rows = max(1, round(w / TILE)), max(1, round(h / TILE))
    x = (local[:, 0] * columns / w).astype(np.intp).clip(0, columns - 1)
    y = (local[:, 1] * rows / h).astype(np.intp).clip(0, rows - 1)
    return y * columns + x, columns * rows


def pixels_per_unit(edges: EdgeSet) -> float:
    """Plane pixels for a step of 1 on the plane z = 1, amid the picture."""
    spread = edges.rays[:, :2].std(axis=0).sum()
    return float(edges.xy.std(axis=0).sum() / max(spread, 1e-9)) / edges.plane.pixel


def _peak(power: Array, best: int) -> float:
    """Position of a maximum by the parabola through its neighbours."""
    if not 0 < best < len(power) - 1 or not np.isfinite(power[best - 1 : best + 2]).all():
        return float(best)
    before, here, after = (float(p) for p in power[best - 1 : best + 2])
    bend = before + after - 2 * here
    return best + (0.5 * (before - after) / bend if bend < 0 else 0.0)


def _phase(values: Array) -> float:
    """Where in a unit step the values gather, 0 … 1."""
    return float(np.angle(np.exp(2j * np.pi * values).mean()) / (2 * np.pi)) % 1.0
