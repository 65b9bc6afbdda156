"""Heights between those that read, at which a pad gives no pose."""

from __future__ import annotations

import math
from dataclasses import dataclass

from padstudio.pad.coverage.pinhole import View
from padstudio.pad.coverage.spans import ReadLimits, Span, cells_needed, coverage
from padstudio.pad.spec import Pad


@dataclass(frozen=True)
class DeadBand:
    """Heights between those that read, at which nothing does.

    Attributes
    ----------
    low_mm, high_mm : float
    message : str
        A sentence with the figures and a way out.
    """

    low_mm: float
    high_mm: float
    message: str


def dead_bands(
    pad: Pad,
    view: View,
    limits: ReadLimits,
    tilt_deg: float = 0.0,
    *,
    switch_mm: float | None = None,
) -> tuple[DeadBand, ...]:
    """Heights between the lowest and the highest reading at which nothing reads.

    Parameters
    ----------
    pad : Pad
    view : View
    limits : ReadLimits
    tilt_deg : float
    switch_mm : float, optional
        The height above which a method no longer looks at the finest layer, whatever could be read.
    """
    spans = list(coverage(pad, view, limits, (tilt_deg,)))
    if switch_mm is not None:
        finest = spans[0]
        spans[0] = Span(
            layer=finest.layer,
            tilt_deg=tilt_deg,
            low_mm=finest.low_mm,
            high_mm=min(finest.high_mm, switch_mm),
        )
    bands, reached = [], math.inf
    for span in sorted((span for span in spans if span.reads), key=lambda span: span.low_mm):
        if span.low_mm > reached:
            message = _message(pad, view, limits, reached, span)
            bands.append(DeadBand(reached, span.low_mm, message))
        reached = max(reached, span.high_mm) if reached < math.inf else span.high_mm
    return tuple(bands)


def _message(pad: Pad, view: View, limits: ReadLimits, low_mm: float, above: Span) -> str:
    """Why nothing reads from a height up to where a span begins."""
    head = f"from {low_mm:.0f} to {above.low_mm:.0f} mm no layer reads: at {low_mm:.0f} mm "
    if above.layer == "outline":
        return (
            f"{head}its cells are too small or its lean too faint, and the sign as a whole is in "
            f"the picture only from {above.low_mm:.0f} mm; use larger cells, or a method that "
            "reads smaller ones"
        )
    layer = pad.layer(above.layer)
    assert layer is not None
    need = cells_needed(pad.window, pad.levels, (layer.rows, layer.cols), view, limits)
    seen = need * low_mm / above.low_mm
    return (
        f"{head}the picture holds {seen:.1f} {above.layer} cells across, not {need:.1f}; use a "
        "smaller ratio of the layers, or a method that reads the finer layer higher up"
    )
