"""Heights and tilts at which a pad's layers can be read, from geometry alone.

A layer reads where enough of its cells lie across the picture, and each is enough pixels wide. Both
grow in proportion to height, so that every limit is a height in closed form. The camera is a
pinhole whose axis meets the pad; cameras come as plain numbers, as this package knows no lenses.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from padstudio.errors import SpecError
from padstudio.pad.spec import Channel, Layer, Pad

Method = Literal["dense", "paper"]


@dataclass(frozen=True, kw_only=True)
class View:
    """A pinhole camera as plain numbers.

    Attributes
    ----------
    width_px, height_px : int
    focal_px : float
    """

    width_px: int
    height_px: int
    focal_px: float

    def __post_init__(self) -> None:
        if min(self.width_px, self.height_px) < 1 or not 0 < self.focal_px < math.inf:
            raise SpecError("a view has a width, a height and a focal length above 0 pixels")

    def extent_per_height(self, tilt_deg: float) -> float:
        """Length of ground across the picture's middle, over the camera's height.

        The shorter of the picture's two middle lines counts; infinite where it meets the horizon.
        """
        tilt = _radians(tilt_deg)
        extents = []
        # The axis leans along the one side or the other: the worse of the two must do.
        for along, across in ((self.width_px, self.height_px), (self.height_px, self.width_px)):
            half = math.atan(along / 2 / self.focal_px)
            if tilt + half < math.pi / 2:
                extents.append(math.tan(tilt + half) - math.tan(tilt - half))
            extents.append(across / self.focal_px / math.cos(tilt))
        return min(extents)

    def cells_across(self, cell_mm: float, height_mm: float, tilt_deg: float = 0.0) -> float:
        """Cells across the picture's shorter middle line."""
        return self.extent_per_height(tilt_deg) * height_mm / cell_mm

    def cell_px(self, cell_mm: float, height_mm: float, tilt_deg: float = 0.0) -> float:
        """Width in pixels of a cell on the optical axis: the geometric mean of its two sides.

        Tilt shrinks one side by cos θ, as it lies farther away, and the other by cos² θ.
        """
        return self.focal_px * cell_mm * math.pow(math.cos(_radians(tilt_deg)), 1.5) / height_mm


@dataclass(frozen=True, kw_only=True)
class ReadLimits:
    """What a method needs to read a layer.

    Attributes
    ----------
    cells_across : float or None
        Least cells across the picture; None is the pad's window.
    cell_px : float
        Least width of a cell, pixels, as of `View.cell_px`.
    """

    cells_across: float | None = None
    cell_px: float = 3.0

    def __post_init__(self) -> None:
        if not 0 < self.cell_px < math.inf or (
            self.cells_across is not None and not 0 < self.cells_across < math.inf
        ):
            raise SpecError("the limits of reading are numbers above 0")


#: What the detector's methods need, as tests/benchmarks/bench_limits.py finds it in daylight.
METHOD_LIMITS: dict[Method, ReadLimits] = {
    "dense": ReadLimits(cells_across=4.1, cell_px=4.2),
    "paper": ReadLimits(cells_across=5.0, cell_px=28.0),
}


@dataclass(frozen=True, kw_only=True)
class Span:
    """Heights at which a layer reads at one tilt.

    Attributes
    ----------
    channel : {"red", "green", "blue"}
    tilt_deg : float
    low_mm, high_mm : float
        ``low_mm`` ≥ ``high_mm`` where it reads nowhere.
    """

    channel: Channel
    tilt_deg: float
    low_mm: float
    high_mm: float

    @property
    def reads(self) -> bool:
        """True if there is a height at which the layer reads."""
        return self.low_mm < self.high_mm


@dataclass(frozen=True)
class DeadBand:
    """Heights between those that read, at which no layer does.

    Attributes
    ----------
    low_mm, high_mm : float
    message : str
        A sentence with the figures and a way out.
    """

    low_mm: float
    high_mm: float
    message: str


def layer_span(
    pad: Pad, layer: Layer, view: View, limits: ReadLimits, tilt_deg: float = 0.0
) -> Span:
    """Heights at which a layer reads.

    Raises
    ------
    SpecError
        If the tilt is not within 0 … 89 degrees.
    """
    need = limits.cells_across or float(pad.window)
    if need > min(layer.rows, layer.cols):
        return Span(channel=layer.channel, tilt_deg=tilt_deg, low_mm=math.inf, high_mm=0.0)
    return Span(
        channel=layer.channel,
        tilt_deg=tilt_deg,
        low_mm=need * layer.cell_mm / view.extent_per_height(tilt_deg),
        high_mm=view.cell_px(layer.cell_mm, 1.0, tilt_deg) / limits.cell_px,
    )


def coverage(
    pad: Pad, view: View, limits: ReadLimits, tilts_deg: Iterable[float] = (0.0,)
) -> tuple[Span, ...]:
    """Spans of all layers at all tilts, finest layer first within a tilt."""
    layers = sorted(pad.layers, key=lambda layer: layer.cell_mm)
    return tuple(
        layer_span(pad, layer, view, limits, tilt) for tilt in tilts_deg for layer in layers
    )


def dead_bands(
    pad: Pad,
    view: View,
    limits: ReadLimits,
    tilt_deg: float = 0.0,
    *,
    switch_mm: float | None = None,
) -> tuple[DeadBand, ...]:
    """Heights between the lowest and the highest reading at which no layer reads.

    Parameters
    ----------
    pad : Pad
    view : View
    limits : ReadLimits
    tilt_deg : float
    switch_mm : float, optional
        The height above which a method no longer looks at the finest layer, whatever could be read.
    """
    spans = [span for span in coverage(pad, view, limits, (tilt_deg,)) if span.reads]
    ranges = [(span.low_mm, span.high_mm, span.channel) for span in spans]
    if switch_mm is not None and ranges:
        low, high, channel = ranges[0]
        ranges[0] = (low, min(high, switch_mm), channel)
    ranges = sorted(item for item in ranges if item[0] < item[1])
    bands, reached = [], None
    for low, high, channel in ranges:
        if reached is not None and low > reached:
            bands.append(_band(pad, view, limits, tilt_deg, (reached, low), channel))
        reached = high if reached is None else max(reached, high)
    return tuple(bands)


def _band(
    pad: Pad,
    view: View,
    limits: ReadLimits,
    tilt_deg: float,
    heights_mm: tuple[float, float],
    channel: Channel,
) -> DeadBand:
    layer = pad.layer(channel)
    assert layer is not None
    low, high = heights_mm
    seen = view.cells_across(layer.cell_mm, low, tilt_deg)
    need = limits.cells_across or float(pad.window)
    message = (
        f"from {low:.0f} to {high:.0f} mm no layer reads: at {low:.0f} mm the picture holds "
        f"{seen:.1f} {channel} cells across, not {need:g}; use a smaller ratio of the layers, or a "
        "method that reads the finer layer higher up"
    )
    return DeadBand(low, high, message)


def covered_share(spans: Sequence[Span], low_mm: float, high_mm: float) -> float:
    """Share of a height range, in ratios of height, at which some span reads."""
    if not 0 < low_mm < high_mm:
        raise SpecError(f"heights {low_mm:g} … {high_mm:g} mm are no range above 0")
    edges = {low_mm, high_mm}
    for span in spans:
        edges |= {min(max(edge, low_mm), high_mm) for edge in (span.low_mm, span.high_mm)}
    total = 0.0
    for a, b in pairwise(sorted(edges)):
        if any(span.low_mm <= a and b <= span.high_mm for span in spans):
            total += math.log(b / a)
    return total / math.log(high_mm / low_mm)


def _radians(tilt_deg: float) -> float:
    if not 0 <= tilt_deg <= 89:
        raise SpecError(f"the tilt is {tilt_deg} degrees; it must lie within 0 … 89")
    return math.radians(tilt_deg)
