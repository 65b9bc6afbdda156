"""What the article claims of its ranges, and whether the frames bear it out.

A claim of the article's own method is judged by the method `paper`; what `dense` does beside it is
told. Every verdict follows from the figures by `RULES`.
"""

from __future__ import annotations

from collections.abc import Sequence

from padstudio.experiments.report import Claim
from padstudio.experiments.reproduction.plan import (
    COARSE_MM,
    FINE_MM,
    SIDE_MM,
    WINDOW,
    paper_camera,
)
from padstudio.experiments.reproduction.reading import METHODS, FrameRead
from padstudio.experiments.reproduction.spans import (
    Span,
    cells_across,
    height_cm,
    least_height_cm,
    verdict_of,
)

# A claimed height is met within this share.
_SAME_SHARE = 0.01


def range_claims(frames: Sequence[FrameRead]) -> tuple[Claim, ...]:
    """Of the ranges of the layers, and of the whole."""
    vertical = [frame for frame in frames if "paper fine" in frame.readings]
    coarse = Span("vertical", 18, 154, height_cm, " cm")
    fine = Span("vertical", 8, 18, height_cm, " cm")
    band = Span("vertical", 18, least_height_cm(COARSE_MM), height_cm, " cm")
    return (
        _whole_sign(),
        _layer(vertical, "coarse", coarse, COARSE_MM),
        _layer(vertical, "fine", fine, FINE_MM),
        _between(vertical, band),
    )


def _whole_sign() -> Claim:
    camera = paper_camera()
    found = SIDE_MM * camera.focal_px / min(camera.width, camera.height) / 10
    held = abs(found - 154) <= _SAME_SHARE * 154
    return Claim(
        "The whole sign is in view from 154 cm.",
        "held" if held else "does not hold",
        f"By the pinhole it fills the picture's shorter side at {found:.1f} cm.",
    )


def _layer(frames: Sequence[FrameRead], layer: str, span: Span, cell_mm: float) -> Claim:
    good = span.good(frames, f"paper {layer}")
    words = "; ".join(span.in_words(frames, method, layer) for method in reversed(METHODS))
    because = f"Read alone: {words}."
    low = span.low
    across = cells_across(10 * low, cell_mm)
    if across < WINDOW and not all(good):
        because += (
            f" At {low:g} cm the picture's shorter side sees {across:.1f} cells of {cell_mm:g} mm: "
            f"a window of {WINDOW} fits from {least_height_cm(cell_mm):.1f} cm on, so that from "
            f"{low:g} cm to there the claim cannot hold by its own geometry."
        )
    text = f"The {layer} layer works from {low:g} to {span.high:g} cm."
    return Claim(text, verdict_of(good), because, span.within(good))


def _between(frames: Sequence[FrameRead], band: Span) -> Claim:
    good = band.good(frames, "paper")
    wide = Span("vertical", 0, 1000, height_cm, " cm")
    whole = "; ".join(wide.in_words(frames, method) for method in reversed(METHODS))
    fine = wide.longest(wide.good(frames, "paper fine"))
    reach = f"The fine layer alone reads up to {fine[1]:g} cm" if fine else "It reads nowhere"
    return Claim(
        f"One layer takes over from the other without a gap (below {band.high:.0f} cm only the "
        "fine one can).",
        verdict_of(good),
        f"{reach} by paper. Of all heights, {whole}.",
        band.within(good),
    )
