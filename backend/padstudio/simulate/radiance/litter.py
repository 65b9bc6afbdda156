"""What lies on a pad and hides it: leaves, snow, mud, by the share that they cover."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, get_args

import numpy as np

from padstudio.arrays import Array
from padstudio.color import linear_from_srgb
from padstudio.errors import SpecError, shown
from padstudio.simulate.radiance.litter_kernel import LitterShapes

LitterKind = Literal["leaves", "snow", "mud"]
LITTER_KINDS: tuple[LitterKind, ...] = get_args(LitterKind)
#: Share of the pad that litter may cover.
MOST_SHARE = 0.95

# Of leaves and of patches of snow and mud, mm.
_SIZE_MM = {"leaves": 60.0, "snow": 260.0, "mud": 220.0}
# sRGB of a correctly exposed picture.
_COLORS = {
    "leaves": ((142, 84, 42), (176, 128, 48), (98, 112, 50), (120, 58, 40), (164, 148, 66)),
    "snow": ((228, 231, 236), (236, 238, 240), (218, 223, 232)),
    "mud": ((96, 78, 58), (112, 92, 68), (82, 68, 52)),
}
# Points along the pad's longer side at which its cover is counted, and shapes tried at most.
_COUNTED, _MOST_SHAPES = 400, 20_000
# Ellipses that make up a patch.
_A_PATCH = 24


@dataclass(frozen=True, kw_only=True)
class Litter:
    """Opaque things strewn evenly over the pad until they cover a share of it.

    Leaves lie singly, each between two parabolas; snow and mud lie in patches of many ellipses.

    Attributes
    ----------
    kind : {"leaves", "snow", "mud"}
    share : float
        Of the pad that is covered, 0 … 0.95.
    size_mm : float or None
        Mean length of a leaf or breadth of a patch; None for what is usual of the kind.
    seed : int
    """

    kind: LitterKind = "leaves"
    share: float = 0.2
    size_mm: float | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        if self.kind not in LITTER_KINDS:
            raise SpecError(
                f"no litter {shown(self.kind)}; choose one of {', '.join(LITTER_KINDS)}"
            )
        if not 0 <= self.share <= MOST_SHARE:
            raise SpecError(f"share is {self.share}; it must lie within 0 … {MOST_SHARE}")
        if self.size_mm is not None and not 1 <= self.size_mm <= 10_000:
            raise SpecError(f"size_mm is {self.size_mm}; it must lie within 1 … 10000")


@lru_cache(maxsize=8)
def strewn(litter: Litter | None, size_mm: tuple[float, float] | None) -> LitterShapes:
    """The outlines of litter on a print of a size; the same seed strews the same."""
    if litter is None or size_mm is None or not litter.share:
        return _binned(np.zeros((0, 10)), (1.0, 1.0))
    width, height = size_mm
    rng = np.random.default_rng([litter.seed, *litter.kind.encode()])
    usual = min(litter.size_mm or _SIZE_MM[litter.kind], min(width, height) / 2)
    step = max(width, height) / _COUNTED
    x = np.arange(step / 2, width, step)[None, :] - width / 2
    y = np.arange(step / 2, height, step)[:, None] - height / 2
    covered = np.zeros((y.shape[0], x.shape[1]), bool)
    shapes: list[Array] = []
    while covered.mean() < litter.share and len(shapes) < _MOST_SHAPES:
        place = (rng.random(2) - 0.5) * np.array([width, height])
        more = _leaf(rng, place, usual) if litter.kind == "leaves" else _patch(rng, place, usual)
        tint = np.array(_COLORS[litter.kind][rng.integers(len(_COLORS[litter.kind]))], float)
        for shape in more:
            shade = float(np.clip(1 + 0.1 * rng.standard_normal(), 0.7, 1.3))
            if litter.kind == "snow":
                shade = 1 - 0.1 * abs(1 - shade)
            shape[7:] = linear_from_srgb(np.clip(tint * shade, 0, 255) / 255.0)
            covered |= _inside(x, y, shape)
            shapes.append(shape)
            if covered.mean() >= litter.share:
                break
    return _binned(np.array(shapes), (width, height))


def _leaf(rng: np.random.Generator, place: Array, size_mm: float) -> list[Array]:
    """One leaf of 0.6 … 1.4 of a size, 0.4 … 0.7 as broad as long."""
    half = size_mm / 2 * float(rng.uniform(0.6, 1.4))
    turn = float(rng.uniform(0, 2 * math.pi))
    return [_shape(1.0, place, turn, (half, half * float(rng.uniform(0.4, 0.7))))]


def _patch(rng: np.random.Generator, place: Array, size_mm: float) -> list[Array]:
    """A patch: ellipses about a place, the smaller the farther out."""
    half = size_mm / 2 * float(rng.uniform(0.5, 1.3))
    out = []
    for _ in range(_A_PATCH):
        away, toward = half * math.sqrt(rng.random()), float(rng.uniform(0, 2 * math.pi))
        long = half * float(rng.uniform(0.25, 0.5)) * (1.3 - away / half)
        at = place + away * np.array([math.cos(toward), math.sin(toward)])
        out.append(_shape(0.0, at, float(rng.uniform(0, math.pi)), (long, 0.7 * long)))
    return out


def _shape(kind: float, place: Array, turn: float, half: tuple[float, float]) -> Array:
    row = [kind, *place, math.cos(turn), math.sin(turn), *half, 0.0, 0.0, 0.0]
    return np.array(row, float)


def _inside(x: Array, y: Array, shape: Array) -> Array:
    """Which points of a grid (1, W), (H, 1) lie within an outline, (H, W) bool."""
    dx, dy = x - shape[1], y - shape[2]
    along = (shape[3] * dx + shape[4] * dy) / shape[5]
    across = (shape[3] * dy - shape[4] * dx) / shape[6]
    if shape[0] > 0:
        return np.asarray(np.abs(across) < 1 - along**2)
    return np.asarray(along**2 + across**2 < 1)


def _binned(shapes: Array, size_mm: tuple[float, float]) -> LitterShapes:
    """Shapes with the bins of a square that holds all of them."""
    if not len(shapes):
        empty = np.zeros(1, np.int32)
        return LitterShapes(shapes, empty, empty, np.array([0.0, 0.0, 1.0]), 0)
    reach = float(shapes[:, 5].max())
    half = max(size_mm) / 2 + 2 * reach
    bins = int(min(max(2 * half / reach, 1), 256))
    step = 2 * half / bins
    lists: list[list[int]] = [[] for _ in range(bins * bins)]
    low = np.clip(np.floor((shapes[:, 1:3] - shapes[:, 5:6] + half) / step), 0, bins - 1)
    high = np.clip(np.floor((shapes[:, 1:3] + shapes[:, 5:6] + half) / step), 0, bins - 1)
    for k, (first, last) in enumerate(zip(low.astype(int), high.astype(int), strict=True)):
        for row in range(first[1], last[1] + 1):
            for column in range(first[0], last[0] + 1):
                lists[row * bins + column].append(k)
    starts = np.concatenate([[0], np.cumsum([len(item) for item in lists])]).astype(np.int32)
    items = np.array([k for item in lists for k in item], np.int32)
    return LitterShapes(shapes, starts, items, np.array([-half, -half, step]), bins)
