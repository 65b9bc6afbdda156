"""Whether a pose explains what every channel of the frame shows.

A channel shows a mixture of all layers under a smooth light: its own through its ink, the others
by crosstalk. Where a pose puts the layers, their levels are known, so the mixture is a linear
model, ``value = light(x, y) + Σ gain_l(x, y) · level_l``, fitted at points all over the pad in view
by least squares with Geman–McClure weights (IRLS; Geman, S. and McClure, D. E. (1987), Statistical
methods for tomographic image reconstruction). A layer *shows* in a channel by its partial R²: the
share of what all other terms leave over that it explains.

A pose that rests on one channel alone can be wrong by a whole scale: where layers share a code,
the fine pattern seen in the coarse layer's channel reads as the coarse one, nearer by. The other
channel then shows what such a pose does not predict.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import lattice_mm
from padstudio.pad.spec import Channel, Layer, Pad
from padstudio.vision.cells import cells_kernel, mixture_kernel
from padstudio.vision.cells.visible import visible_range
from padstudio.vision.frame.pyramid import Pyramid

# So many points tell a mixture to a hundredth; below the least the pad is hardly in view.
_POINTS, _LEAST_POINTS = 500, 100
# Within this of a cell's side, pixels, a point sees both cells; in small cells, within this share.
_RIM_PX, _RIM_SHARE = 1.5, 0.3
# Smaller cells are blurred so much that nothing within them is left out.
_RIMMED_PX = 5.0
# Points are looked at where the finest cells are about so wide, at most at half the frame's scale:
# what a wrong pose does not predict is finer than that.
_LOOK_PX, _COARSEST_LEVEL = 6.0, 1
# A layer with so many cells in view, of this width, must be seen.
_TELLING_CELLS, _TELLING_PX = 30, 2.5
# True poses show such layers by 0.4 and more, wrong ones by 0.03 at most (190 frames of the
# footage and of what happens to prints and cameras, also grey and with exchanged channels).
_SHOWS = 0.1
# Structure below this share of the pad's own contrast may be ground, dirt or noise.
_STRUCTURE = 0.15
# A layer whose gain elsewhere is this many times that in its own channel is at home there.
_AT_HOME = 2.0


@dataclass(frozen=True)
class ChannelMixture:
    """What one channel shows of the layers.

    Attributes
    ----------
    channel : {"red", "green", "blue"}
    explained : float
        Share of its structure, light apart, that the layers explain, 0 … 1.
    residual : float
        Root mean square of what they leave over, grey values.
    shows : mapping
        Partial R² of each layer, by the layer's channel.
    gain : mapping
        Grey values from dark to full of each layer, amid the frame.
    """

    channel: Channel
    explained: float
    residual: float
    shows: Mapping[Channel, float]
    gain: Mapping[Channel, float]


@dataclass(frozen=True)
class Mixture:
    """What the channels show of the layers where a pose puts them.

    Attributes
    ----------
    channels : tuple of ChannelMixture
        Of the channels that hold a layer.
    telling : frozenset
        Layers, by channel, with cells enough in view that they must be seen.
    """

    channels: tuple[ChannelMixture, ...]
    telling: frozenset[Channel]

    @property
    def unexplained(self) -> Channel | None:
        """A channel with structure that the pose does not predict, where there is one."""
        contrast = max((abs(c.gain[c.channel]) for c in self.channels if self._shown(c)), default=0)
        for item in self.channels:
            if item.explained < _SHOWS and item.residual > _STRUCTURE * max(contrast, 1.0):
                return item.channel
        return None

    @property
    def hidden(self) -> Channel | None:
        """A layer that ought to be seen in its own channel and is not, where there is one."""
        missing = (c.channel for c in self.channels if not self._shown(c))
        return next((channel for channel in missing if channel in self.telling), None)

    @property
    def exchanged(self) -> bool:
        """True where every layer is seen, but in another one's channel."""
        return len(self.channels) > 1 and all(self._elsewhere(c) for c in self.channels)

    def _shown(self, item: ChannelMixture) -> bool:
        return item.shows[item.channel] >= _SHOWS

    def _elsewhere(self, own: ChannelMixture) -> bool:
        layer = own.channel
        gains = [
            abs(c.gain[layer]) for c in self.channels if c is not own and c.shows[layer] >= _SHOWS
        ]
        return max(gains, default=0.0) > _AT_HOME * abs(own.gain[layer])


class _Points(NamedTuple):
    """Where a mixture is looked at.

    Attributes
    ----------
    xy : (N, 2) float64
        Frame pixels.
    levels : (L, N) float64
        Levels of the pad's layers there, −0.5 … 0.5.
    telling : frozenset
        As of `Mixture`.
    """

    xy: Array
    levels: Array
    telling: frozenset[Channel]


def find_mixture(pyramid: Pyramid, camera: Camera, pad: Pad, pose: MovingPose) -> Mixture | None:
    """The mixture of every channel under a pose.

    Parameters
    ----------
    pyramid : Pyramid
    camera : Camera
        At the frame's size.
    pad : Pad
    pose : MovingPose

    Returns
    -------
    Mixture or None
        None where too little of the pad lies in view.
    """
    points = _points_in_view(camera, pad, pose)
    if points is None:
        return None
    light = _light(points.xy, camera)
    gains = [level[:, None] * light[:, : mixture_kernel.GAIN] for level in points.levels]
    terms = np.concatenate([light, *gains], axis=1)
    finest_px = min(layer.cell_mm for layer in pad.layers) * _px_per_mm(camera, pose)
    level = int(np.clip(np.log2(max(finest_px / _LOOK_PX, 1.0)), 0, _COARSEST_LEVEL))
    seen = np.ones((1, len(points.xy)), bool)
    names = [layer.channel for layer in pad.layers]
    channels = []
    for layer in pad.layers:
        values = cells_kernel.sample(pyramid.window(layer.channel, level), points.xy[None], seen)
        found = mixture_kernel.fit_channel(values[0].astype(float), terms)
        explained, residual, shows, gain = found
        named = [dict(zip(names, figures.tolist(), strict=True)) for figures in (shows, gain)]
        channels.append(ChannelMixture(layer.channel, explained, residual, *named))
    return Mixture(tuple(channels), points.telling)


def _points_in_view(camera: Camera, pad: Pad, pose: MovingPose) -> _Points | None:
    finest = min(pad.layers, key=lambda layer: layer.cell_mm)
    rows, cols = visible_range(pad, finest, camera, pose.pose)
    first, size = np.array([cols[0], rows[0]]), np.array([cols[1] - cols[0], rows[1] - rows[0]])
    if size.min() <= 0:
        return None
    places = first + _spread() * size
    xy = pose.project(camera, lattice_mm(pad, finest, places))
    inside = ((xy >= 0) & (xy <= (camera.width - 1, camera.height - 1))).all(axis=1)
    px_per_mm = _px_per_mm(camera, pose)
    levels, telling = [], set()
    for layer in pad.layers:
        here = places * (finest.cell_mm / layer.cell_mm)
        # A coarse layer need not reach the pad's right and lower sides.
        inside &= (here < (layer.cols, layer.rows)).all(axis=1)
        cell = np.minimum(here.astype(np.intp), (layer.cols - 1, layer.rows - 1))
        cell_px = layer.cell_mm * px_per_mm
        if cell_px > _RIMMED_PX:
            rim = min(_RIM_PX / cell_px, _RIM_SHARE)
            inside &= (np.abs(here - cell - 0.5) < 0.5 - rim).all(axis=1)
        levels.append(layer.field[cell[:, 1], cell[:, 0]] / (pad.levels - 1) - 0.5)
        if cell_px >= _TELLING_PX and _count(layer, cell[inside]) >= _TELLING_CELLS:
            telling.add(layer.channel)
    kept = np.flatnonzero(inside)[:_POINTS]
    if len(kept) < _LEAST_POINTS:
        return None
    return _Points(xy[kept], np.array(levels)[:, kept], frozenset(telling))


def _count(layer: Layer, cells: NDArray[np.intp]) -> int:
    """How many different cells (N, 2) there are."""
    return len(np.unique(cells[:, 1] * layer.cols + cells[:, 0]))


def _px_per_mm(camera: Camera, pose: MovingPose) -> float:
    return camera.focal_px / max(abs(float(pose.pose.position_mm[2])), 1e-9)


def _light(xy: Array, camera: Camera) -> Array:
    """Terms of a light that falls off over the frame, (N, 6)."""
    x, y = ((xy - (camera.width / 2, camera.height / 2)) / camera.width).T
    return np.column_stack([np.ones(len(x)), x, y, x * x, x * y, y * y])


@lru_cache(maxsize=1)
def _spread() -> Array:
    """Points (N, 2) of the unit square, spread evenly in any part of it (Halton's sequence)."""
    return np.column_stack([_radical_inverse(base) for base in (2, 3)])


def _radical_inverse(base: int) -> Array:
    number, out, share = np.arange(1, 3 * _POINTS + 1), np.zeros(3 * _POINTS), 1.0
    while number.any():
        share /= base
        out += share * (number % base)
        number //= base
    return out
