"""Heights and tilts at which a pad can be read, from geometry alone.

Upwards, a layer's cells become too small to be read, or the lean too weak to be seen; downwards,
too few cells lie across the picture. Where the sign as a whole is in view its four sides tell
where the cells lie, so that smaller ones will do.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from padstudio.errors import SpecError
from padstudio.pad.coverage.observability import (
    Hold,
    hold_of_borders,
    hold_of_corners,
    share_known,
)
from padstudio.pad.coverage.pinhole import View, radians
from padstudio.pad.spec import Channel, Layer, Pad

Method = Literal["dense", "paper"]
#: What a pose rests on, as in the detector's results: a layer's cells, or the sign as a whole.
Source = Channel | Literal["outline"]

# A pose counts as read within this share of the height and 1 mm, and this angle.
_PLACE_SHARE, _PLACE_MM, _ATTITUDE_DEG = 0.02, 1.0, 2.0


@dataclass(frozen=True, kw_only=True)
class ReadLimits:
    """What a method needs to read a pad.

    Attributes
    ----------
    cells_across : float or None
        Least cells across the picture; None is the pad's window, where ``spare_bits`` is None too.
    spare_bits : float or None
        For a method that counts all cells in the picture: what they must tell beyond a layer's
        places and turns, log2 of the odds.
    cell_px : float
        Least width of a layer's cell, pixels, as of `View.cell_px`.
    sign_cell_px : float or None
        Least width of the coarsest cell where the whole sign is in view; None where a method takes
        no notice of it.
    sign_side_px : float
        Least shorter side of the whole sign.
    border_px : float or None
        Noise of a pixel's length of border, for a method that takes its pose from all borders.
    corner_px, sign_corner_px : float or None
        Noise of a corner, for one that takes it from four: of a window between fitted lines, and of
        the sign between its own sides.
    """

    cells_across: float | None = None
    spare_bits: float | None = None
    cell_px: float = 3.0
    sign_cell_px: float | None = None
    sign_side_px: float = 30.0
    border_px: float | None = None
    corner_px: float | None = None
    sign_corner_px: float | None = None

    def __post_init__(self) -> None:
        given = (
            self.cells_across, self.spare_bits, self.cell_px, self.sign_cell_px,
            self.sign_side_px, self.border_px, self.corner_px, self.sign_corner_px,
        )  # fmt: skip
        if not all(value is None or 0 < value < math.inf for value in given):
            raise SpecError("the limits of reading are numbers above 0")


#: What the detector's methods need, as tests/benchmarks/bench_limits.py finds it in daylight.
METHOD_LIMITS: dict[Method, ReadLimits] = {
    "dense": ReadLimits(spare_bits=18.7, cell_px=4.3, sign_cell_px=1.08, border_px=0.51),
    "paper": ReadLimits(
        cells_across=5.0, cell_px=13.0, sign_cell_px=1.7, corner_px=0.22, sign_corner_px=0.8
    ),
}
# Blur of lens, sensor and demosaicing in pixels; the detector's own whole-sign matching assumes it.
_BLUR_PX = 0.8
_MOST_GAIN_DEG = 60.0


@dataclass(frozen=True, kw_only=True)
class Span:
    """Heights at which a layer, or the whole sign, gives a pose at one tilt.

    Attributes
    ----------
    layer : {"red", "green", "blue", "outline"}
    tilt_deg : float
    low_mm, high_mm : float
        ``low_mm`` ≥ ``high_mm`` where it does nowhere.
    """

    layer: Source
    tilt_deg: float
    low_mm: float
    high_mm: float

    @property
    def reads(self) -> bool:
        """True if there is a height at which it gives a pose."""
        return self.low_mm < self.high_mm


def cells_needed(
    window: int, levels: int, size: tuple[int, int], view: View, limits: ReadLimits
) -> float:
    """Cells across the picture's shorter side that a layer needs.

    Parameters
    ----------
    window, levels : int
        Of the pad's code.
    size : (rows, columns) of int
        Of the layer: the more places there are, the more cells tell them apart.
    view : View
    limits : ReadLimits
    """
    if limits.cells_across is not None or limits.spare_bits is None:
        return limits.cells_across or float(window)
    cells = (math.log2(4 * size[0] * size[1]) + limits.spare_bits) / math.log2(levels)
    return math.sqrt(cells * view.side_px / max(view.width_px, view.height_px))


def layer_span(
    pad: Pad, layer: Layer, view: View, limits: ReadLimits, tilt_deg: float = 0.0
) -> Span:
    """Heights at which a layer's cells are read and tell the pose.

    Raises
    ------
    SpecError
        If the tilt is not within 0 … 89 degrees.
    """
    need = cells_needed(pad.window, pad.levels, (layer.rows, layer.cols), view, limits)
    if need > min(layer.rows, layer.cols):
        return Span(layer=layer.channel, tilt_deg=tilt_deg, low_mm=math.inf, high_mm=0.0)
    return Span(
        layer=layer.channel,
        tilt_deg=tilt_deg,
        low_mm=need * layer.cell_mm / _side_per_height(view, limits, tilt_deg),
        high_mm=min(
            view.cell_px(layer.cell_mm, 1.0, tilt_deg) / limits.cell_px,
            window_known_to_mm(pad.window * layer.cell_mm, view, limits, tilt_deg),
            sign_known_to_mm(_side_mm(pad), _cells_mm(pad), view, limits, tilt_deg),
        ),
    )


def _side_per_height(view: View, limits: ReadLimits, tilt_deg: float) -> float:
    """Length of ground along the picture's shorter side that counts, over the camera's height."""
    if limits.cells_across is not None or limits.spare_bits is None:
        return view.extent_per_height(tilt_deg)
    # Where all cells count, it is their number: the ground in view grows as their pictures shrink.
    # Beyond some tilt what is gained lies too near the horizon to be read.
    return view.side_px / view.cell_px(1.0, 1.0, min(tilt_deg, _MOST_GAIN_DEG))


def sign_span(pad: Pad, view: View, limits: ReadLimits, tilt_deg: float = 0.0) -> Span:
    """Heights at which the whole sign is in view and tells the pose.

    Raises
    ------
    SpecError
        If the tilt is not within 0 … 89 degrees.
    """
    if limits.sign_cell_px is None:
        return Span(layer="outline", tilt_deg=tilt_deg, low_mm=math.inf, high_mm=0.0)
    cells_mm, side_mm = _cells_mm(pad), _side_mm(pad)
    return Span(
        layer="outline",
        tilt_deg=tilt_deg,
        low_mm=view.holds_from_mm(max(pad.size_mm), tilt_deg),
        high_mm=min(
            view.cell_px(max(cells_mm), 1.0, tilt_deg) / limits.sign_cell_px,
            view.shorter_px(min(pad.size_mm), 1.0, tilt_deg) / limits.sign_side_px,
            _corners_known_to_mm(side_mm, limits.sign_corner_px, view, tilt_deg),
            sign_known_to_mm(side_mm, cells_mm, view, limits, tilt_deg),
        ),
    )


def coverage(
    pad: Pad, view: View, limits: ReadLimits, tilts_deg: Iterable[float] = (0.0,)
) -> tuple[Span, ...]:
    """Spans at all tilts: layers, the finest first, then the whole sign where a method uses it."""
    layers = sorted(pad.layers, key=lambda layer: layer.cell_mm)
    spans = []
    for tilt in tilts_deg:
        spans += [layer_span(pad, layer, view, limits, tilt) for layer in layers]
        if limits.sign_cell_px is not None:
            spans.append(sign_span(pad, view, limits, tilt))
    return tuple(spans)


def sign_known_to_mm(
    side_mm: float, cells_mm: Sequence[float], view: View, limits: ReadLimits, tilt_deg: float
) -> float:
    """Height up to which the borders of a square sign tell the pose; infinite without their noise.

    Parameters
    ----------
    side_mm : float
    cells_mm : sequence of float
        Side of a cell of each layer.
    view : View
    limits : ReadLimits
    tilt_deg : float
    """
    noise_px = limits.border_px
    if noise_px is None:
        return math.inf

    def hold(height_mm: float) -> Hold:
        return hold_of_borders(
            min(view.cell_px(side_mm, height_mm, tilt_deg), float(view.side_px)),
            [view.cell_px(cell, height_mm, tilt_deg) for cell in cells_mm],
            view.focal_px,
            noise_px=noise_px,
            blur_px=_BLUR_PX,
        )

    return _known_to_mm(hold, tilt_deg, view.cell_px(side_mm, 1.0, tilt_deg))


def window_known_to_mm(side_mm: float, view: View, limits: ReadLimits, tilt_deg: float) -> float:
    """Height up to which the four corners of a window tell the pose; infinite without noise."""
    return _corners_known_to_mm(side_mm, limits.corner_px, view, tilt_deg)


def _corners_known_to_mm(
    side_mm: float, noise_px: float | None, view: View, tilt_deg: float
) -> float:
    if noise_px is None:
        return math.inf

    def hold(height_mm: float) -> Hold:
        side_px = min(view.cell_px(side_mm, height_mm, tilt_deg), float(view.side_px))
        return hold_of_corners(side_px, view.focal_px, noise_px=noise_px)

    return _known_to_mm(hold, tilt_deg, view.cell_px(side_mm, 1.0, tilt_deg))


def _known_to_mm(hold: Callable[[float], Hold], tilt_deg: float, most_mm: float) -> float:
    """Largest height up to ``most_mm`` at which half of the pictures tell the pose; to 0.1 %."""
    tilt = radians(tilt_deg)

    def known(height_mm: float) -> bool:
        # The camera is off its place by its lean times its distance from the sign.
        sideways = (_PLACE_SHARE + _PLACE_MM / height_mm) * math.cos(tilt)
        within = min(sideways, math.radians(_ATTITUDE_DEG))
        return share_known(hold(height_mm), tilt, within) >= 0.5

    low, high = most_mm * 1e-6, most_mm
    while high / low > 1.001:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if known(middle) else (low, middle)
    return low


def _side_mm(pad: Pad) -> float:
    return math.sqrt(pad.size_mm[0] * pad.size_mm[1])


def _cells_mm(pad: Pad) -> list[float]:
    return [layer.cell_mm for layer in pad.layers]
