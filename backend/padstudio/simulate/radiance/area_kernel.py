"""Areas of a pixel's footprint for the simulator's inner loop."""

from __future__ import annotations

from typing import NamedTuple

from padstudio.compiled import inlined_jit


class Quad(NamedTuple):
    """A quadrangle's corners, one after the other along its outline."""

    x0: float
    y0: float
    x1: float
    y1: float
    x2: float
    y2: float
    x3: float
    y3: float


@inlined_jit
def _area_under(xa: float, ya: float, xb: float, yb: float, a: float, b: float) -> float:
    """Integral of min(y, b) dx along the part of a segment that lies left of a."""
    if xa > a and xb > a:
        return 0.0
    if xa > a:
        ya += (a - xa) / (xb - xa) * (yb - ya)
        xa = a
    elif xb > a:
        yb = ya + (a - xa) / (xb - xa) * (yb - ya)
        xb = a
    if ya <= b and yb <= b:
        return (xb - xa) * (ya + yb) * 0.5
    if ya >= b and yb >= b:
        return (xb - xa) * b
    c = xa + (b - ya) / (yb - ya) * (xb - xa)
    if ya < b:
        return (c - xa) * (ya + b) * 0.5 + (xb - c) * b
    return (c - xa) * b + (xb - c) * (b + yb) * 0.5


@inlined_jit
def quadrant_area(quad: Quad, a: float, b: float) -> float:
    """Signed area of the part of a quadrangle that lies left of a and above b (Green's theorem)."""
    return (
        _area_under(quad.x0, quad.y0, quad.x1, quad.y1, a, b)
        + _area_under(quad.x1, quad.y1, quad.x2, quad.y2, a, b)
        + _area_under(quad.x2, quad.y2, quad.x3, quad.y3, a, b)
        + _area_under(quad.x3, quad.y3, quad.x0, quad.y0, a, b)
    )
