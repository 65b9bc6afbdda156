"""Light on the sensor before the lens blurs it: prepares the scene for the kernel and runs it."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.simulate.radiance.kernel import View, shade_rows
from padstudio.simulate.radiance.lens import beyond_lens, ray_map
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.radiance.surface import illumination_of, surface_of

# Generators of rank-1 lattices of 16, 64 and 256 points: of all odd ones, those with the largest
# least distance between points on the unit square, then in the three planes of the cube.
_LATTICES = ((16, 13, 11), (64, 45, 53), (256, 185, 229))

# Rows that a thread takes at a time: few enough that all threads end together.
_BAND = 32


def radiance(
    scene: Scene, camera: Camera, tracks: Array, pieces: int = 1, *, infrared: bool = False
) -> NDArray[np.float32]:
    """Average light on each pixel of an ideal lens.

    Parameters
    ----------
    scene : Scene
    camera : Camera
    tracks : (H or 1, T, 12) float64
        Poses of each row's exposure, as of `padstudio.simulate.motion.Course`.
    pieces : int
        Pieces of an exposure's path that are each as good as straight.
    infrared : bool
        The near infrared alone, in three equal channels as far as prints go.

    Returns
    -------
    (H, W, 3) float32
        Linear RGB; 1.0 is white paper's upper bound under light of level 1.
    """
    view = View(ray_map(camera), tracks, pieces, _lattices())
    surface, light = surface_of(scene, infrared=infrared), illumination_of(scene.light)
    out = np.empty((camera.height, camera.width, 3), np.float32)

    def shade(first: int) -> None:
        shade_rows(first, min(first + _BAND, camera.height), view, surface, light, out)

    with ThreadPoolExecutor(max_workers=min(8, os.cpu_count() or 1)) as pool:
        list(pool.map(shade, range(0, camera.height, _BAND)))
    if scene.fog is not None:
        middle = tracks[len(tracks) // 2, tracks.shape[1] // 2]
        scene.fog.veil(out, view.rays, middle, scene.light.level)
    for channel, cast in zip(np.moveaxis(out, -1, 0), scene.light.cast, strict=True):
        channel *= np.float32(cast)
    dark = beyond_lens(camera)
    if dark is not None:
        out[dark] = 0
    return out


def _lattices() -> Array:
    """(3, 256, 3) float64: positions in the pixel and the exposure, each within 0 … 1."""
    out = np.zeros((3, 256, 3))
    for k, (count, second, third) in enumerate(_LATTICES):
        i = np.arange(count)
        for axis, generator in enumerate((1, second, third)):
            out[k, :count, axis] = (i * generator % count + 0.5) / count
    return out
