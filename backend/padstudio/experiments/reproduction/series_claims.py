"""What the article claims of its series, and whether the frames bear it out, likewise."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from padstudio.arrays import Array
from padstudio.experiments.report import Claim
from padstudio.experiments.reproduction.plan import FINE_MM, PLACES, Place
from padstudio.experiments.reproduction.reading import METHODS, FrameRead
from padstudio.experiments.reproduction.spans import READ_SHARE, Span, verdict_of
from padstudio.experiments.reproduction.tables import PoseFigure, at, errors_of, share_read

#: A series counts as measured where the errors' root mean square is at most this share of the
#: height, or this angle, degrees.
GOOD_SHARE, GOOD_DEG = 0.01, 1.0

RULES = (
    f"The rules: a place counts as read where at least {READ_SHARE:g} % of its frames gave a pose "
    f"that is not false; a series as measured where the root mean square of the errors is at most "
    f"{100 * GOOD_SHARE:g} % of the height, or {GOOD_DEG:g}°. A claim is held where all of its "
    "places bear it out, and held within the places that do where only some do. It is judged by "
    "the method paper; what dense makes of the same frames stands beside it."
)


def measured_claim(
    frames: Sequence[FrameRead],
    text: str,
    span: Span,
    measured: tuple[PoseFigure, Callable[[Place], float], str],
) -> Claim:
    """That a series is read, and measured well.

    Parameters
    ----------
    frames : sequence of FrameRead
    text : str
        The claim.
    span : Span
        Its places.
    measured : (callable, callable, str)
        What is measured, of a position and a tilt; the most that the errors' root mean square may
        be at a place; the unit of both.
    """
    figure, limit, unit = measured
    words: list[str] = []
    judged: list[bool] = []
    for method in METHODS:
        is_read = span.good(frames, method)
        worst, good = float("nan"), []
        for (k, _), was_read in zip(span.places, is_read, strict=True):
            rms = _rms(at(frames, span.series, k), method, figure)
            worst = float(np.fmax(worst, rms))
            good.append(was_read and rms <= limit(PLACES[span.series][k]))
        off = f", with errors of {worst:.2g}{unit} at most (root mean square of a place)"
        words.append(span.in_words(frames, method) + (off if np.isfinite(worst) else ""))
        if method == "paper":
            judged = good
    because = "; ".join(reversed(words))
    sentence = because[0].upper() + because[1:] + "."
    return Claim(text, verdict_of(judged), sentence, span.within(judged))


def _rms(frames: Sequence[FrameRead], method: str, figure: PoseFigure) -> float:
    errors = errors_of(frames, method, figure)
    return float(np.sqrt(np.mean(np.square(errors)))) if len(errors) else float("nan")


def beyond_claim(frames: Sequence[FrameRead]) -> Claim:
    """That beyond 40 degrees recognition fails with a certain probability."""
    span = Span("attitude", 40.1, 90, lambda place: place.tilt_deg, "°")
    words, fails = [], False
    for method in reversed(METHODS):
        shares = [(v, share_read(at(frames, "attitude", k), method)) for k, v in span.places]
        if method == "paper":
            fails = any(share < 100 for _, share in shares)
        listed = ", ".join(f"{share:.0f} % at {value:g}°" for value, share in shares)
        words.append(f"{method} reads {listed}")
    return Claim(
        "Beyond 40° recognition fails with a certain probability.",
        "held" if fails else "does not hold",
        "; ".join(words).capitalize() + ".",
    )


def steps_claim(frames: Sequence[FrameRead]) -> Claim:
    """That positions go on evenly from cell to cell."""
    words: list[str] = []
    judged: list[bool] = []
    for method in reversed(METHODS):
        off = step_errors(frames, method)
        missing = sum(not f.readings[method].ok for f in frames if f.shot.series == "continuity")
        if len(off):
            words.append(
                f"{method}: {len(off)} steps of {FINE_MM:g} mm, off by {np.std(off):.2g} mm (one "
                f"sigma) and {np.abs(off).max():.2g} mm at most; {missing} frames without a pose"
            )
        if method == "paper":
            judged = [f.readings[method].ok for f in frames if f.shot.series == "continuity"]
            judged += (np.abs(off) < FINE_MM / 2).tolist()
    because = "; ".join(words) or "no step was measured"
    sentence = because[0].upper() + because[1:] + "."
    within = f"{sum(judged)} of {len(judged)} frames and steps"
    verdict = verdict_of(judged)
    text = "Positions are continuous from cell to cell."
    return Claim(text, verdict, sentence, within if verdict == "held within" else "")


def step_errors(frames: Sequence[FrameRead], method: str) -> Array:
    """Measured less true steps along X between neighbouring places of a rail, mm."""
    rails: dict[int, dict[int, FrameRead]] = {}
    for frame in frames:
        if frame.shot.series == "continuity" and frame.readings[method].ok:
            rails.setdefault(frame.shot.seed, {})[frame.shot.place] = frame
    off = []
    for rail in rails.values():
        for place, frame in rail.items():
            if place + 1 in rail:
                after = rail[place + 1]
                here, there = frame.readings[method], after.readings[method]
                step = there.position_mm[0] - here.position_mm[0]
                off.append(step - (after.position_mm[0] - frame.position_mm[0]))
    return np.array(off)
