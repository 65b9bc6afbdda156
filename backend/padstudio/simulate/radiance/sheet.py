"""What is printed, as one page of patches: a pad with its margin, and the pads beside it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.errors import SpecError
from padstudio.pad.layout import Layout, layout
from padstudio.simulate.lay.relief import Relief
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.scene import Neighbour, Scene

# Edges nearer to each other than this are one, mm.
_SAME_MM = 1e-6


class Page(NamedTuple):
    """All that is printed in a scene, in one grid.

    Attributes
    ----------
    x_edges : (C + 1,) float64
    y_edges : (R + 1,) float64
        Of the patches, mm, downwards.
    patches : (R, C, 3) float32
        Linear colours.
    to_page : (4,) float64
        (ax, bx, ay, by): from the pad frame to the page.
    half_mm : (x, y)
        Half sides of the pad's own print, pad frame.
    patch_mm : float
        The smallest side of a patch.
    beside : (N, 8) float64
        The pads beside it, as of `padstudio.simulate.lay.tiles.Tiles.placed`.
    """

    x_edges: Array
    y_edges: Array
    patches: NDArray[np.float32]
    to_page: Array
    half_mm: tuple[float, float]
    patch_mm: float
    beside: Array


def half_sides_mm(scene: Scene) -> tuple[float, float]:
    """Half sides of what is printed, with its margin; raises `SpecError` on bare ground."""
    if scene.size_mm is None:
        raise SpecError("the scene has no print")
    return page_of(scene, scene.inks).half_mm


def check_lay(scene: Scene) -> None:
    """Refuse paper that is too steep; raises `SpecError` as `Relief.nodes`."""
    if isinstance(scene.lay, Relief) and scene.size_mm is not None:
        scene.lay.nodes(*half_sides_mm(scene))


def page_of(scene: Scene, inks: Inks) -> Page:
    """The page of a scene: its own print at the left, those beside it to the right."""
    pad = scene.pad
    plan = scene.sheet if pad is None else layout(pad)
    if plan is None:
        # A sheet of no breadth far away: the ground is bare.
        edges = np.array([0.0, 1e-3])
        bare = np.zeros((1, 1, 3), np.float32)
        nowhere = np.array([1.0, 1e9, -1.0, 1e9])
        return Page(edges, edges, bare, nowhere, (5e-4, 5e-4), 1e-3, np.zeros((0, 8)))
    x, y, patches = _sheet(plan, scene.quiet_mm, inks)
    sx, sy = (1.0, 1.0) if pad is None else pad.scale
    to_page = np.array([1 / sx, x[-1] / 2, -1 / sy, y[-1] / 2])
    half = (float(x[-1] / 2 / to_page[0]), float(y[-1] / 2 / -to_page[2]))
    smallest = float(np.concatenate([np.diff(x), np.diff(y)]).min())
    own = Page(x, y, patches, to_page, half, smallest, np.zeros((0, 8)))
    for neighbour in scene.neighbours:
        own = _beside(own, neighbour, scene.quiet_mm, inks)
    return own


def _sheet(
    plan: Layout, quiet_mm: float | None, inks: Inks
) -> tuple[Array, Array, NDArray[np.float32]]:
    """Edges and colours of a print with its margin."""
    own = float(plan.x_mm[0])
    quiet = own if quiet_mm is None else quiet_mm
    x, y = plan.x_mm - own + quiet, plan.y_mm - own + quiet
    colors = inks.reflectance(plan.colors)
    if quiet > 0:
        white = inks.reflectance(np.full(3, 255, np.uint8))
        framed = np.empty((colors.shape[0] + 2, colors.shape[1] + 2, 3), np.float32)
        framed[:] = white
        framed[1:-1, 1:-1] = colors
        colors = framed
        x = np.concatenate([[0.0], x, [x[-1] + quiet]])
        y = np.concatenate([[0.0], y, [y[-1] + quiet]])
    return np.ascontiguousarray(x), np.ascontiguousarray(y), colors


def _beside(page: Page, neighbour: Neighbour, quiet_mm: float | None, inks: Inks) -> Page:
    """A page with another print to the right of all that is on it."""
    x, y, patches = _sheet(layout(neighbour.pad), quiet_mm, inks)
    sx, sy = neighbour.pad.scale
    half_x, half_y = x[-1] / 2 * sx, y[-1] / 2 * sy
    # In the page's own millimetres, which its first pad's scale turns into true ones.
    x, y = x * sx * page.to_page[0], y * sy * -page.to_page[2]
    left = page.x_edges[-1]
    below = _merged(page.y_edges, y)
    middle = (below[:-1] + below[1:]) / 2
    columns = [_stretched(page.patches, page.y_edges, middle), _stretched(patches, y, middle)]
    turn = math.radians(-neighbour.turn_deg)
    centre_x = (left + x[-1] / 2 - page.to_page[1]) / page.to_page[0]
    centre_y = (y[-1] / 2 - page.to_page[3]) / page.to_page[2]
    place = [neighbour.x_mm, neighbour.y_mm, math.cos(turn), math.sin(turn)]
    tile = np.array([[*place, half_x, half_y, centre_x, centre_y]])
    smallest = float(np.concatenate([np.diff(x), np.diff(y)]).min())
    return page._replace(
        x_edges=np.concatenate([page.x_edges, left + x[1:]]),
        y_edges=below,
        patches=np.concatenate(columns, axis=1),
        patch_mm=min(page.patch_mm, smallest),
        beside=np.concatenate([page.beside, tile]),
    )


def _merged(first: Array, second: Array) -> Array:
    """The edges of two grids, those that are as good as equal once."""
    edges = np.sort(np.concatenate([first, second]))
    return np.asarray(edges[np.concatenate([[True], np.diff(edges) > _SAME_MM])], float)


def _stretched(patches: NDArray[np.float32], edges: Array, rows: Array) -> NDArray[np.float32]:
    """The patches at other rows' middles; beyond their own edge the last ones."""
    at = np.clip(np.searchsorted(edges, rows, side="right") - 1, 0, len(patches) - 1)
    return np.asarray(patches[at], np.float32)


def bins(edges: Array, bin_mm: float) -> NDArray[np.int32]:
    """The patch at the start of each step of ``bin_mm``."""
    starts = np.arange(0.0, edges[-1], bin_mm)
    index = np.searchsorted(edges, starts, side="right") - 1
    return np.clip(index, 0, len(edges) - 2).astype(np.int32)
