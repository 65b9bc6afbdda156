"""Areas of a pixel's footprint for the simulator's inner loop."""

from __future__ import annotations

from padstudio.compiled import inlined_jit


@inlined_jit
def _area_under(xa, ya, xb, yb, a, b):  # type: ignore[no-untyped-def]
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
def quadrant_area(x0, y0, x1, y1, x2, y2, x3, y3, a, b):  # type: ignore[no-untyped-def]
    """Signed area of the part of a quadrangle that lies left of a and above b (Green's theorem)."""
    return (
        _area_under(x0, y0, x1, y1, a, b)
        + _area_under(x1, y1, x2, y2, a, b)
        + _area_under(x2, y2, x3, y3, a, b)
        + _area_under(x3, y3, x0, y0, a, b)
    )
