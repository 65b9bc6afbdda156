"""A scene as the flat arrays that the kernel reads."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.color import linear_from_srgb
from padstudio.simulate.lay.tiles import Tiles
from padstudio.simulate.radiance.ground import SIZE, TEXEL_MM, texture
from padstudio.simulate.radiance.litter import strewn
from padstudio.simulate.radiance.litter_kernel import LitterShapes
from padstudio.simulate.radiance.scene import Light, Scene
from padstudio.simulate.radiance.sheet import Page, bins, page_of

# A bright, slightly blue sky.
_SKY_SRGB = (140.0, 152.0, 176.0)
# Beyond 700 nm leaves reflect some times what they do in the red ("red edge").
_VEGETATION, _RED_EDGE = ("grass",), 4.0


#: How a print lies.
FLAT, RAISED, TILED = 0, 1, 2


class Surface(NamedTuple):
    """The ground and what lies on it.

    ``patches`` (R, C, 3) are linear colours between ``x_edges`` (C + 1,) and ``y_edges`` (R + 1,),
    page coordinates, mm; ``x_bins`` and ``y_bins`` give the patch at the start of each step of
    ``bin_mm``, ``patch_mm`` is the smallest side of one.
    ``to_page`` is (ax, bx, ay, by). ``discs`` (N, 6) are x, y, squared radius, colour.
    ``lay`` is `FLAT`, `RAISED` with ``relief`` (R, C, 3) as of `Relief.nodes`, or `TILED` with
    ``tiles`` (N, 8) as of `Tiles.placed`; ``half_mm`` (3,) are the print's half sides and how far
    a relief moves its points at most.
    ``texture`` (M, 3) holds all levels of a square tile of ``texture_size`` texels, finest first,
    at ``offsets`` (L,).
    """

    patches: NDArray[np.float32]
    x_edges: Array
    y_edges: Array
    x_bins: NDArray[np.int32]
    y_bins: NDArray[np.int32]
    bin_mm: float
    patch_mm: float
    to_page: Array
    discs: Array
    litter: LitterShapes
    lay: int
    half_mm: Array
    relief: Array
    tiles: Array
    texture: NDArray[np.float32]
    offsets: NDArray[np.int64]
    texture_size: int
    texel_mm: float
    sky: Array


class Illumination(NamedTuple):
    """``level``, ``gradient`` (2,) per mm, and ``shadows`` (N, 7).

    The columns of ``shadows`` are: whether it is a disc, x, y, a, b, softness, density.

    For a disc ``a`` is its radius; for a half plane (a, b) is the unit vector into the shadow.
    """

    level: float
    gradient: Array
    shadows: Array


def surface_of(scene: Scene, *, infrared: bool = False) -> Surface:
    """What lies on the ground of a scene, in visible light or in the near infrared."""
    tile = texture(scene.ground, scene.ground_seed)
    texels = tile.texels
    if infrared and scene.ground in _VEGETATION:
        texels = np.minimum(texels * np.float32(_RED_EDGE), np.float32(0.9))
    inks = scene.inks.infrared() if infrared else scene.inks
    page = page_of(scene, inks)
    x, y = page.x_edges, page.y_edges
    smallest = page.patch_mm
    # At least one bin a patch, so that a look-up takes a step or two; no more than a megabyte.
    bin_mm = max(smallest, max(x[-1], y[-1]) / 100_000)
    discs = [
        [o.x_mm, o.y_mm, o.radius_mm**2, *linear_from_srgb(np.array(o.color) / 255.0)]
        for o in scene.occluders
    ]
    return Surface(
        patches=page.patches,
        x_edges=x,
        y_edges=y,
        x_bins=bins(x, bin_mm),
        y_bins=bins(y, bin_mm),
        bin_mm=bin_mm,
        patch_mm=smallest,
        to_page=page.to_page,
        discs=np.array(discs, float).reshape(-1, 6),
        litter=strewn(scene.litter, scene.size_mm),
        **_lay(scene, page),
        texture=texels,
        offsets=tile.offsets,
        texture_size=SIZE,
        texel_mm=TEXEL_MM,
        sky=linear_from_srgb(np.array(_SKY_SRGB) / 255.0),
    )


def _lay(scene: Scene, page: Page) -> dict[str, Any]:
    """How the print lies: ``lay``, ``half_mm``, ``relief`` and ``tiles`` of the surface."""
    half_x, half_y = page.half_mm
    fields: dict[str, Any] = {
        "lay": FLAT,
        "half_mm": np.array([half_x, half_y, 0.0]),
        "relief": np.zeros((1, 1, 3)),
        "tiles": np.zeros((0, 8)),
    }
    if scene.size_mm is None:
        return fields
    if isinstance(scene.lay, Tiles) or len(page.beside):
        lay = scene.lay if isinstance(scene.lay, Tiles) else Tiles(columns=1, rows=1)
        tiles = np.concatenate([page.beside, lay.placed(half_x, half_y)])
        return fields | {"lay": TILED, "tiles": tiles}
    if scene.lay is None:
        return fields
    nodes = scene.lay.nodes(half_x, half_y)
    fields["half_mm"][2] = np.abs(nodes).max()
    return fields | {"lay": RAISED, "relief": nodes}


def illumination_of(light: Light) -> Illumination:
    """The light on the ground of a scene."""
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
