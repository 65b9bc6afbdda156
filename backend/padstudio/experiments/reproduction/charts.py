"""The figures of the series: charts, the course of a landing, cameras as cones."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from padstudio.experiments.figures.chart import Axis, Band, Marks, chart
from padstudio.experiments.figures.space import Cone, Path3, space
from padstudio.experiments.figures.svg import COLORS, INK
from padstudio.experiments.report import Figure
from padstudio.experiments.reproduction.plan import (
    COARSE_MM,
    FINE_MM,
    PLACES,
    SIDE_MM,
    ExperimentName,
    Place,
)
from padstudio.experiments.reproduction.reading import METHODS, FrameRead
from padstudio.experiments.reproduction.spans import least_height_cm
from padstudio.experiments.reproduction.tables import PoseFigure, at, errors_of, read, share_read

_COLOR = dict(zip(METHODS, COLORS, strict=False))
_CM_TICKS = (7.0, 10.0, 18.0, 31.0, 50.0, 90.0, 154.0)
_SHARE = Axis("frames with a pose, %", 0, 108, ticks=(0, 20, 40, 60, 80, 100))
_NAN = float("nan")
# How long a camera's cone is drawn, mm.
_CONE_MM = 170.0


def ranges_figure(frames: Sequence[FrameRead]) -> Figure:
    """Over the height, how many frames each layer alone gives a pose of."""
    marks = []
    for method in METHODS:
        for layer in ("fine", "coarse"):
            points = tuple(
                (place.height_mm / 10, share_read(at(frames, "vertical", k), f"{method} {layer}"))
                for k, place in enumerate(PLACES["vertical"])
            )
            dashed = layer == "coarse"
            marks.append(Marks(f"{method}, {layer} layer", points, _COLOR[method], dashed=dashed))
    bands = (
        Band(8, 18, "fine, as claimed", "#c3202c"),
        Band(18, least_height_cm(COARSE_MM), "no coarse window fits", "#8a9099"),
        Band(least_height_cm(COARSE_MM), 154, "coarse, as claimed", "#2350d0"),
    )
    return Figure(
        "ranges",
        ".svg",
        chart(_height_axis(), _SHARE, marks, bands),
        "Frames that each layer alone gives a pose of. The coarse layer is claimed from 18 cm on.",
        "A line for each layer and method over the height; the claimed ranges are shaded.",
    )


def _height_axis() -> Axis:
    heights = [place.height_mm / 10 for place in PLACES["vertical"]]
    return Axis("height, cm", min(heights), max(heights), log=True, ticks=_CM_TICKS)


def vertical_figure(frames: Sequence[FrameRead]) -> Figure:
    """Over the height, how far positions are off."""
    series = {
        method: tuple(
            (place.height_mm / 10, _median_off(at(frames, "vertical", k), method))
            for k, place in enumerate(PLACES["vertical"])
        )
        for method in METHODS
    }
    values = [y for points in series.values() for _, y in points if math.isfinite(y)] or [1.0]
    low, high = 10 ** math.floor(math.log10(min(values))), 10 ** math.ceil(math.log10(max(values)))
    y = Axis("position off, mm (median)", low, max(high, 10 * low), log=True)
    marks = [Marks(method, series[method], _COLOR[method]) for method in METHODS]
    return Figure(
        "vertical",
        ".svg",
        chart(_height_axis(), y, marks),
        "How far the measured position is from the true one, over the height.",
        "Two lines that rise with the height, one for each method.",
    )


def _median_off(frames: Sequence[FrameRead], method: str) -> float:
    errors = [reading.error_mm for _, reading in read(frames, method)]
    return float(np.median(errors)) if errors else _NAN


def error_figure(
    frames: Sequence[FrameRead],
    series: ExperimentName,
    nominal: tuple[str, Callable[[Place], float]],
    measured: tuple[str, PoseFigure],
) -> Figure:
    """Errors of a series with their spread.

    Parameters
    ----------
    frames : sequence of FrameRead
    series : ExperimentName
    nominal : (str, callable)
        Title of the x axis, and what stands on it.
    measured : (str, callable)
        Title of the y axis, and of what errors are shown.
    """
    marks, reach = [], 0.0
    for shift, method in zip((-1, 1), METHODS, strict=True):
        points, spread = [], []
        values = [nominal[1](place) for place in PLACES[series]]
        step = 0.006 * (max(values) - min(values))
        for k, value in enumerate(values):
            off = errors_of(at(frames, series, k), method, measured[1])
            mean = float(np.mean(off)) if len(off) else _NAN
            sigma = float(np.std(off)) if len(off) else _NAN
            points.append((value + shift * step, mean))
            spread.append(sigma)
            reach = max(reach, abs(mean) + sigma) if len(off) else reach
        marks.append(Marks(method, tuple(points), _COLOR[method], tuple(spread), joined=False))
    reach = 1.1 * reach or 1.0
    margin = 0.04 * (max(values) - min(values))
    x = Axis(nominal[0], min(values) - margin, max(values) + margin, ticks=tuple(values))
    return Figure(
        f"{series}-errors",
        ".svg",
        chart(x, Axis(measured[0], -reach, reach), marks),
        "Mean error at each place; bars are one standard deviation over the frames.",
        "Dots with bars about zero, for both methods.",
    )


def attitude_figure(frames: Sequence[FrameRead]) -> Figure:
    """Over the tilt, how many frames give a pose."""
    marks = [
        Marks(
            method,
            tuple(
                (place.tilt_deg, share_read(at(frames, "attitude", k), method))
                for k, place in enumerate(PLACES["attitude"])
            ),
            _COLOR[method],
        )
        for method in METHODS
    ]
    tilts = [place.tilt_deg for place in PLACES["attitude"]]
    return Figure(
        "attitude",
        ".svg",
        chart(
            Axis("tilt, °", min(tilts) - 2, max(tilts) + 2),
            _SHARE,
            marks,
            (Band(10, 40, "works, as claimed"),),
        ),
        "Frames with a pose over the tilt, from a height of 0.5 m.",
        "A line for each method.",
    )


def tilts_figure(frames: Sequence[FrameRead]) -> Figure:
    """Cameras at each tilt, as they were and as they were measured."""
    shown = [at(frames, "attitude", k)[:1] for k in range(len(PLACES["attitude"]))]
    return _cones_figure(
        [frame for here in shown for frame in here],
        "tilts",
        "One camera at each tilt: true (dark) and as measured by each method.",
    )


def landing_figures(frames: Sequence[FrameRead]) -> tuple[Figure, ...]:
    """The course of the first landing; its cameras near the ground as cones."""
    flight = first_flight(frames)
    near = [frame for frame in flight if frame.position_mm[2] < 600]
    return (
        Figure(
            "trajectory",
            ".svg",
            space(_paths(flight), square=SIDE_MM),
            "The course of one landing over the pad: true, and as measured by each method.",
            "Three paths that come down to the middle of a square and cover each other.",
        ),
        _cones_figure(
            near, "cones", "The cameras of that landing below 60 cm: true (dark) and as measured."
        ),
        _samples_figure(near),
    )


def first_flight(frames: Sequence[FrameRead]) -> list[FrameRead]:
    """The landing of the first seed, from above."""
    flight = [f for f in frames if f.shot.series == "landing" and f.shot.seed == 0]
    return sorted(flight, key=lambda frame: frame.shot.place)


def _paths(flight: Sequence[FrameRead]) -> list[Path3]:
    paths = [Path3("true", tuple(f.position_mm for f in flight), INK, dashed=True, dotted=False)]
    for method in METHODS:
        points = tuple(reading.position_mm for _, reading in read(flight, method))
        paths.append(Path3(method, points, _COLOR[method]))
    return paths


def _cones_figure(shown: Sequence[FrameRead], name: str, caption: str) -> Figure:
    cones = [Cone(f.position_mm, f.axis, _CONE_MM, INK) for f in shown]
    for method in METHODS:
        cones += [
            Cone(reading.position_mm, reading.axis, _CONE_MM, _COLOR[method])
            for _, reading in read(shown, method)
        ]
    paths = [Path3("true", (), INK), *(Path3(method, (), _COLOR[method]) for method in METHODS)]
    words = "Cones of cameras over a square; those measured cover the true ones."
    return Figure(name, ".svg", space(paths, cones, SIDE_MM), caption, words)


def _samples_figure(near: Sequence[FrameRead]) -> Figure:
    """Measured heights of the last samples; where a frame failed there is none."""
    true = tuple((float(k), frame.position_mm[2]) for k, frame in enumerate(near))
    marks = [Marks("true", true, INK, dotted=False, dashed=True)]
    for method in METHODS:
        readings = [frame.readings[method] for frame in near]
        points = tuple(
            (float(k), r.position_mm[2] if r.ok else _NAN) for k, r in enumerate(readings)
        )
        marks.append(Marks(method, points, _COLOR[method], joined=False))
    last = max(1, len(near) - 1)
    highest = max((z for _, z in true), default=1.0)
    x = Axis("sample", -0.2, last + 0.2, ticks=tuple(float(k) for k in range(len(near))))
    return Figure(
        "samples",
        ".svg",
        chart(x, Axis("Z, mm", 0, 1.1 * highest), marks),
        "Heights of that landing's samples from 55 to 21 cm; a failed frame has no dot.",
        "Dots on a falling line.",
    )


def continuity_figure(frames: Sequence[FrameRead]) -> Figure:
    """From cell to cell, how far the measured way is from the true one."""
    rails = [f for f in frames if f.shot.series == "continuity"]
    marks = []
    for method in METHODS:
        first = {f.shot.seed: f for f in rails if f.shot.place == 0 and f.readings[method].ok}
        points, spread = [], []
        for k in range(len(PLACES["continuity"])):
            ways = [
                reading.position_mm[0] - first[f.shot.seed].readings[method].position_mm[0]
                for f, reading in read(at(rails, "continuity", k), method)
                if f.shot.seed in first
            ]
            points.append((k * FINE_MM, float(np.mean(ways)) if ways else _NAN))
            spread.append(float(np.std(ways)) if ways else _NAN)
        marks.append(Marks(method, tuple(points), _COLOR[method], tuple(spread)))
    far = FINE_MM * (len(PLACES["continuity"]) - 1)
    true = Marks("true", ((0.0, 0.0), (far, far)), INK, dotted=False, dashed=True)
    return Figure(
        "continuity",
        ".svg",
        chart(Axis("moved by, mm", -2, far + 2), Axis("measured, mm", -5, far + 5), [true, *marks]),
        "Measured way along the rail, cell by cell; bars are one standard deviation.",
        "Three lines that cover each other.",
    )
