"""Ground textures: tiles without seams, grown from a seed, and their pyramid of averages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.color import linear_from_srgb
from padstudio.simulate.radiance.scene import GroundKind

Plane = NDArray[np.float32]
Tile = NDArray[np.float32]

# Texels of a tile's side (a power of two, for its levels), and their side: 2 m of ground.
SIZE = 1024
TEXEL_MM = 2.0


@dataclass(frozen=True, eq=False)
class Texture:
    """All levels of a square tile, finest first, in one array.

    Attributes
    ----------
    texels : (M, 3) float32
        Linear RGB reflectance.
    offsets : (L,) int64
        Where each level starts; level k has (SIZE >> k)² texels of TEXEL_MM · 2^k.
    """

    texels: NDArray[np.float32]
    offsets: NDArray[np.int64]


@lru_cache(maxsize=4)
def texture(kind: GroundKind, seed: int) -> Texture:
    """The pyramid of a ground; the same for the same kind and seed."""
    rng = np.random.default_rng([seed, *kind.encode()])
    srgb = np.clip(_PAINTERS[kind](rng).astype(float), 0, 255) / 255.0
    level: Tile = linear_from_srgb(srgb).astype(np.float32)
    levels = [level]
    while level.shape[0] > 1:
        quads = level[::2, ::2] + level[1::2, ::2] + level[::2, 1::2] + level[1::2, 1::2]
        level = np.asarray(quads / 4, np.float32)
        levels.append(level)
    counts = [item.shape[0] ** 2 for item in levels]
    offsets = np.concatenate([[0], np.cumsum(counts[:-1])]).astype(np.int64)
    return Texture(np.concatenate([item.reshape(-1, 3) for item in levels]), offsets)


def _noise(rng: np.random.Generator, cells: int) -> Plane:
    """Smooth periodic noise of unit variance with ``cells`` knots a side."""
    knots = rng.standard_normal((cells, cells), dtype=np.float32)
    wrapped = np.pad(knots, 4, mode="wrap")
    step = SIZE // cells
    plane = cv2.resize(wrapped, None, fx=step, fy=step, interpolation=cv2.INTER_CUBIC)
    plane = plane[4 * step : -4 * step, 4 * step : -4 * step]
    return np.asarray((plane - plane.mean()) / plane.std(), np.float32)


def _octaves(rng: np.random.Generator, first: int, last: int, fall: float = 0.7) -> Plane:
    """Sum of noises of ``first``, 2 · ``first`` … ``last`` knots, each ``fall`` the one before."""
    total = np.zeros((SIZE, SIZE), np.float32)
    weight, cells = 1.0, first
    while cells <= last:
        total += np.float32(weight) * _noise(rng, cells)
        weight, cells = weight * fall, cells * 2
    return np.asarray(total / total.std(), np.float32)


def _tint(plane: Plane, base: tuple[float, float, float], amount: float) -> Tile:
    """A colour whose brightness follows a plane."""
    factor = 1.0 + amount * plane[..., None]
    return np.asarray(np.array(base, np.float32) * factor, np.float32)


def _draw_wrapped(draw: Callable[[int, int], None], x: int, y: int, reach: int) -> None:
    """Draw at (x, y) and again across the seams that the figure may reach over."""
    for dx in (-SIZE, 0, SIZE):
        for dy in (-SIZE, 0, SIZE):
            if -reach < x + dx < SIZE + reach and -reach < y + dy < SIZE + reach:
                draw(x + dx, y + dy)


def _grass(rng: np.random.Generator) -> Tile:
    tile = np.ascontiguousarray(_tint(_octaves(rng, 8, 256), (48, 54, 36), 0.25))
    count = 16_000
    x, y = rng.integers(0, SIZE, (2, count))
    angle = rng.random(count) * 2 * np.pi
    length = 12 + rng.random(count) * 40
    shade = 0.35 + 0.75 * np.arange(count) / count + 0.15 * rng.standard_normal(count)
    hue = rng.standard_normal((count, 3)) * 5
    colors = np.array([112.0, 122.0, 82.0]) * shade[:, None] + hue
    dx, dy = np.round(length * np.cos(angle)), np.round(length * np.sin(angle))
    for k in range(count):
        tip = (int(dx[k]), int(dy[k]))
        color = tuple(float(v) for v in colors[k])

        def blade(
            px: int, py: int, tip: tuple[int, int] = tip, color: tuple[float, ...] = color
        ) -> None:
            cv2.line(tile, (px, py), (px + tip[0], py + tip[1]), color, 3, cv2.LINE_8)

        _draw_wrapped(blade, int(x[k]), int(y[k]), 56)
    soft = cv2.GaussianBlur(np.pad(tile, ((4, 4), (4, 4), (0, 0)), "wrap"), (0, 0), 0.6)
    return np.asarray(soft[4:-4, 4:-4], np.float32)


def _gravel(rng: np.random.Generator) -> Tile:
    tile = np.ascontiguousarray(_tint(_noise(rng, 256), (40, 40, 38), 0.2))
    count = 16_000
    x, y = rng.integers(0, SIZE, (2, count))
    axes = 3 + rng.integers(0, 7, (count, 2))
    angle = rng.random(count) * 180
    shade = 0.5 + 0.6 * np.arange(count) / count + 0.25 * rng.standard_normal(count)
    colors = np.array([118.0, 116.0, 110.0]) * shade[:, None]
    for k in range(count):
        size = (int(axes[k, 0]), int(axes[k, 1]))
        color = tuple(float(v) for v in colors[k])

        def stone(
            px: int,
            py: int,
            size: tuple[int, int] = size,
            turn: float = float(angle[k]),
            color: tuple[float, ...] = color,
        ) -> None:
            cv2.ellipse(tile, (px, py), size, turn, 0, 360, color, -1)

        _draw_wrapped(stone, int(x[k]), int(y[k]), 12)
    return tile


def _bricks(rng: np.random.Generator) -> Tile:
    tile = _tint(_octaves(rng, 32, 256), (126, 108, 94), 0.06)
    height, width, joint = SIZE // 32, SIZE // 8, 3
    for course in range(32):
        shift = (course % 2) * width // 2
        for number in range(8):
            shade = 1 + 0.14 * float(rng.standard_normal())
            color = np.array([96, 78, 68], np.float32) * np.float32(shade)
            rows = np.arange(course * height + joint, (course + 1) * height)
            cols = (np.arange(joint, width) + number * width + shift) % SIZE
            tile[np.ix_(rows, cols)] = color
    return np.asarray(tile * (1 + 0.06 * _octaves(rng, 16, 512)[..., None]), np.float32)


def _plain_noise(
    base: tuple[float, float, float], amount: float, first: int, fall: float
) -> Callable[[np.random.Generator], Tile]:
    def paint(rng: np.random.Generator) -> Tile:
        return _tint(_octaves(rng, first, 512, fall), base, amount)

    return paint


_PAINTERS: dict[GroundKind, Callable[[np.random.Generator], Tile]] = {
    "grass": _grass,
    "gravel": _gravel,
    "bricks": _bricks,
    "asphalt": _plain_noise((86, 86, 88), 0.18, 16, 1.2),
    "concrete": _plain_noise((152, 150, 144), 0.06, 4, 0.8),
    "sand": _plain_noise((176, 156, 122), 0.09, 8, 1.0),
    "snow": _plain_noise((214, 218, 226), 0.025, 4, 0.8),
    "plain": _plain_noise((128, 128, 128), 0.0, 512, 1.0),
}
