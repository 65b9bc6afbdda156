"""Stage `lines`, dense: the two directions of the grid lines and their spacing.

The camera is calibrated and the lines are at right angles on the pad, so both families follow
from one rotation: every edge that lies on a grid line is parallel, on the pad, to one of two
axes at 90°. For a candidate plane normal each edge has an angle on the plane; four times that
angle agrees for both families, so the length of the mean of exp(4i·angle) tells how well the
normal fits. The spacing is then one frequency common to both families' edge positions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.vision.edges import EdgeSet
from padstudio.vision.types import Array

# Rings of candidate normals: (tilt in degrees, how many); denser where foreshortening is strong.
_LOW_RINGS = ((12, 6), (23, 11), (33, 15), (42, 20))
_HIGH_RINGS = ((50, 24), (57, 30), (63, 36), (68, 42), (72, 48), (76, 54))
_COARSE_EDGES, _FINE_EDGES = 800, 2000
_STARTS = 3
# A coherence from which no other start need be tried, unless planes are steep.
_CLEAR = 0.5
# Below this cosine of tilt a plane is seen too flat to be read.
_LEAST_COSINE = 0.17
_MOST_WEIGHT = 6.0
# Edges seen along the plane by less than this sine lie beyond the horizon for all we know.
_LEAST_DEPTH = 0.05
# A climb ends where steps this small lead nowhere.
_LEAST_STEP_DEG = 0.15
# An edge belongs to a family when its direction on the plane is within this slope of the axis.
_LEAST_SLOPE = 0.18
# Spacings looked for, and the size of the tiles whose spectra are summed, pixels of the plane.
_SPACINGS = (3.6, 44.0)
_TILE = 110
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


def _ring(rings: tuple[tuple[int, int], ...]) -> Array:
    normals = []
    for tilt, count in rings:
        azimuth = 2 * math.pi * (np.arange(count) + (count % 2) / 2) / count
        t = math.radians(tilt)
        normals.append(
            np.stack(
                [
                    math.sin(t) * np.cos(azimuth),
                    math.sin(t) * np.sin(azimuth),
                    np.full(count, math.cos(t)),
                ],
                axis=1,
            )
        )
    return np.concatenate(normals)


_LOW = np.concatenate([[[0.0, 0.0, 1.0]], _ring(_LOW_RINGS)])
_HIGH = _ring(_HIGH_RINGS)


def find_axes(edges: EdgeSet, *, steep: bool) -> list[tuple[float, Array]]:
    """Candidate axes of the grid, the most coherent first.

    Parameters
    ----------
    edges : EdgeSet
    steep : bool
        Start from planes tilted by more than 45° rather than less; it takes four times as long.

    Returns
    -------
    list of (coherence, axes)
        At most three; axes as in `LineFamilies`.
    """
    rays = edges.rays / np.linalg.norm(edges.rays, axis=1, keepdims=True)
    coarse = np.arange(0, len(rays), max(1, len(rays) // _COARSE_EDGES))
    fine = np.arange(0, len(rays), max(1, len(rays) // _FINE_EDGES))
    found: list[tuple[float, Array]] = []
    normals = _HIGH if steep else _LOW
    score = np.abs(_coherence(normals, edges.lines[coarse], rays[coarse])[0])
    for start in _distinct(normals, score):
        found.append(_climb(start, edges.lines[fine], rays[fine]))
        if found[-1][0] > _CLEAR and not steep:
            break
    found.sort(key=lambda item: -item[0])
    kept: list[tuple[float, Array]] = []
    for item in found:
        if all(item[1][2] @ other[1][2] < math.cos(math.radians(3)) for other in kept):
            kept.append(item)
    return kept[:_STARTS]


def _coherence(normals: Array, lines: Array, rays: Array) -> tuple[NDArray[np.complex128], Array]:
    """Mean of exp(4i·angle on the plane) for each normal, and the planes' first axes.

    Each edge is weighted by how much the plane's angle turns for a turn in the picture, so that
    edges of no order give zero for every normal; the norm is that of Cauchy and Schwarz, so that
    a few heavy edges cannot win. Near edges count for more, as cells shrink with distance, and a
    plane that most edges cannot lie on, being behind the camera there, loses their share.
    """
    from padstudio.vision import kernels_search as kernels

    first = np.array([1.0, 0.0, 0.0]) - normals * normals[:, :1]
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return kernels.coherence(normals, lines, rays, first, _MOST_WEIGHT, _LEAST_DEPTH), first


def _distinct(normals: Array, score: Array) -> list[Array]:
    starts: list[Array] = []
    for k in np.argsort(-score):
        if all(normals[k] @ other < math.cos(math.radians(12)) for other in starts):
            starts.append(normals[k])
        if len(starts) == _STARTS:
            break
    return starts


def _climb(normal: Array, lines: Array, rays: Array) -> tuple[float, Array]:
    """Walk a normal to the nearest maximum of coherence by shrinking steps."""
    from padstudio.vision import kernels_search as kernels

    normal = kernels.climb(
        normal, lines, rays, _MOST_WEIGHT, _LEAST_DEPTH, _LEAST_COSINE, _LEAST_STEP_DEG
    )
    mean, first = _coherence(normal[None], lines, rays)
    angle = float(np.angle(mean[0])) / 4
    second = np.cross(normal, first[0])
    axis = math.cos(angle) * first[0] + math.sin(angle) * second
    return float(abs(mean[0])), np.stack([axis, np.cross(normal, axis), normal])


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
    seen = depth > _LEAST_COSINE
    on_u = seen & (across_v < _LEAST_SLOPE * across_u)
    on_v = seen & (across_u < _LEAST_SLOPE * across_v)
    if min(int(on_u.sum()), int(on_v.sum())) < 8:
        return None
    tile, count = _tiles(edges)
    unit = 1 / _pixels_per_unit(edges)
    spectra = [_spectrum(value[on], tile[on], count, unit) for value, on in ((u, on_u), (v, on_v))]
    power = spectra[0].power + spectra[1].power
    total = spectra[0].total + spectra[1].total
    frequency = np.arange(power.shape[1]) * _BINS_A_PIXEL / _BINS
    allowed = (frequency > 1 / _SPACINGS[1]) & (frequency < 1 / _SPACINGS[0])
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


def _tiles(edges: EdgeSet) -> tuple[NDArray[np.intp], int]:
    plane = edges.plane
    local = plane.from_frame(edges.xy)
    h, w = plane.values.shape
    columns, rows = max(1, round(w / _TILE)), max(1, round(h / _TILE))
    x = (local[:, 0] * columns / w).astype(np.intp).clip(0, columns - 1)
    y = (local[:, 1] * rows / h).astype(np.intp).clip(0, rows - 1)
    return y * columns + x, columns * rows


def _pixels_per_unit(edges: EdgeSet) -> float:
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
