"""Light on the sensor before the lens blurs it: prepares the scene for the kernel and runs it."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from padstudio.geometry.camera import Camera
from padstudio.pad.layout import layout
from padstudio.simulate.ground import SIZE, TEXEL_MM, texture
from padstudio.simulate.inks import linear_from_srgb
from padstudio.simulate.lens import ray_map
from padstudio.simulate.scene import Light, Scene

if TYPE_CHECKING:
    from padstudio.simulate.kernel import Illumination, Surface

Array = NDArray[np.float64]

_SKY_SRGB = (140.0, 152.0, 176.0)
# Generators of rank-1 lattices of 16, 64 and 256 points: of all odd ones, those with the largest
# least distance between points on the unit square, then in the three planes of the cube.
_LATTICES = ((16, 13, 11), (64, 45, 53), (256, 185, 229))


def radiance(scene: Scene, camera: Camera, tracks: Array) -> NDArray[np.float32]:
    """Average light on each pixel of an ideal lens.

    Parameters
    ----------
    scene : Scene
    camera : Camera
    tracks : (H or 1, T, 12) float64
        As of `padstudio.simulate.motion.tracks`.

    Returns
    -------
    (H, W, 3) float32
        Linear RGB; 1.0 is white paper's upper bound under light of level 1.
    """
    # Numba takes half a second to load: only those who render pay for it.
    from padstudio.simulate.kernel import shade_rows

    rays = ray_map(camera)
    surface, patch_mm = _surface(scene)
    light = _illumination(scene.light)
    out = np.empty((camera.height, camera.width, 3), np.float32)
    lattices = _lattices()

    def shade(first: int) -> None:
        last = min(first + band, camera.height)
        shade_rows(first, last, rays, tracks, lattices, surface, light, patch_mm, out)

    band = 32
    with ThreadPoolExecutor(max_workers=min(8, os.cpu_count() or 1)) as pool:
        list(pool.map(shade, range(0, camera.height, band)))
    out *= np.asarray(scene.light.cast, np.float32)
    return out


def _lattices() -> Array:
    """(3, 256, 3) float64: positions in the pixel and the exposure, each within 0 … 1."""
    out = np.zeros((3, 256, 3))
    for k, (count, second, third) in enumerate(_LATTICES):
        i = np.arange(count)
        for axis, generator in enumerate((1, second, third)):
            out[k, :count, axis] = (i * generator % count + 0.5) / count
    return out


def _surface(scene: Scene) -> tuple[Surface, float]:
    from padstudio.simulate.kernel import Surface

    tile = texture(scene.ground, scene.ground_seed)
    x, y, patches, to_page = _sheet(scene)
    gaps = np.concatenate([np.diff(x), np.diff(y)])
    smallest = float(gaps.min())
    # At least one bin a patch, so that a look-up takes a step or two; no more than a megabyte.
    bin_mm = max(smallest, max(x[-1], y[-1]) / 100_000)
    discs = [
        [o.x_mm, o.y_mm, o.radius_mm**2, *linear_from_srgb(np.array(o.color) / 255.0)]
        for o in scene.occluders
    ]
    surface = Surface(
        patches=patches,
        x_edges=x,
        y_edges=y,
        x_bins=_bins(x, bin_mm),
        y_bins=_bins(y, bin_mm),
        bin_mm=bin_mm,
        to_page=to_page,
        discs=np.array(discs, float).reshape(-1, 6),
        texture=tile.texels,
        offsets=tile.offsets,
        texture_size=SIZE,
        texel_mm=TEXEL_MM,
        sky=linear_from_srgb(np.array(_SKY_SRGB) / 255.0),
    )
    return surface, smallest


def _sheet(scene: Scene) -> tuple[Array, Array, NDArray[np.float32], Array]:
    """Edges and colours of the printed sheet, its margin included, and the way from the pad frame."""
    pad = scene.pad
    if pad is None:
        # A sheet of no breadth far away: the ground is bare.
        edges = np.array([0.0, 1e-3])
        return edges, edges, np.zeros((1, 1, 3), np.float32), np.array([1.0, 1e9, -1.0, 1e9])
    plan = layout(pad)
    quiet = pad.quiet_mm if scene.quiet_mm is None else scene.quiet_mm
    x, y = plan.x_mm - pad.quiet_mm + quiet, plan.y_mm - pad.quiet_mm + quiet
    colors = scene.inks.reflectance(plan.colors)
    if quiet > 0:
        white = scene.inks.reflectance(np.full(3, 255, np.uint8))
        framed = np.empty((colors.shape[0] + 2, colors.shape[1] + 2, 3), np.float32)
        framed[:] = white
        framed[1:-1, 1:-1] = colors
        colors = framed
        x = np.concatenate([[0.0], x, [x[-1] + quiet]])
        y = np.concatenate([[0.0], y, [y[-1] + quiet]])
    sx, sy = pad.scale
    to_page = np.array([1 / sx, pad.width_mm / 2 + quiet, -1 / sy, pad.height_mm / 2 + quiet])
    return np.ascontiguousarray(x), np.ascontiguousarray(y), colors, to_page


def _bins(edges: Array, bin_mm: float) -> NDArray[np.int32]:
    starts = np.arange(0.0, edges[-1], bin_mm)
    index = np.searchsorted(edges, starts, side="right") - 1
    return np.clip(index, 0, len(edges) - 2).astype(np.int32)


def _illumination(light: Light) -> Illumination:
    from padstudio.simulate.kernel import Illumination

    rows = []
    for s in light.shadows:
        toward = math.radians(s.toward_deg)
        a, b = (s.radius_mm, 0.0) if s.radius_mm else (math.sin(toward), math.cos(toward))
        rows.append([float(bool(s.radius_mm)), s.x_mm, s.y_mm, a, b, s.softness_mm, s.density])
    return Illumination(
        level=light.level,
        gradient=np.array(light.gradient_per_m, float) / 1000.0,
        shadows=np.array(rows, float).reshape(-1, 7),
    )
