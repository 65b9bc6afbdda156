"""Tables of frames that were read: truth, what was measured, the error and its spread."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from padstudio.arrays import Array
from padstudio.experiments.report import Cell, Column, Table
from padstudio.experiments.reproduction.plan import PLACES, ExperimentName, Place
from padstudio.experiments.reproduction.reading import LAYERS, METHODS, FrameRead, Reading

#: What a table shows of a pose and of its truth.
PoseFigure = Callable[[Sequence[float], float], float]


def at(frames: Sequence[FrameRead], series: ExperimentName, place: int) -> list[FrameRead]:
    """The frames of one place."""
    return [f for f in frames if f.shot.series == series and f.shot.place == place]


def read(frames: Sequence[FrameRead], method: str) -> list[tuple[FrameRead, Reading]]:
    """Frames with a pose of a method that is not false, each with it."""
    pairs = [(frame, frame.readings[method]) for frame in frames]
    return [(frame, reading) for frame, reading in pairs if reading.ok]


def share_read(frames: Sequence[FrameRead], method: str) -> float:
    """Share of frames with a pose that is not false, percent."""
    return 100 * len(read(frames, method)) / len(frames) if frames else float("nan")


def errors_of(frames: Sequence[FrameRead], method: str, figure: PoseFigure) -> Array:
    """Measured less true, of frames with a pose."""
    pairs = read(frames, method)
    return np.array(
        [figure(r.position_mm, r.tilt_deg) - figure(f.position_mm, f.tilt_deg) for f, r in pairs]
    )


def ranges_table(frames: Sequence[FrameRead]) -> Table:
    """Of each height, the share of frames that each layer alone gives a pose of."""
    kinds = [f"{method} {layer}" for method in METHODS for layer in LAYERS] + list(METHODS)
    rows: list[tuple[Cell, ...]] = []
    for number, place in enumerate(PLACES["vertical"]):
        here = at(frames, "vertical", number)
        shares = [share_read(here, kind) for kind in kinds]
        rows.append((place.height_mm / 10, *shares, _false(here, METHODS)))
    titles = [*kinds, "false poses"]
    return Table(
        "ranges",
        "Frames with a pose, percent: of each layer read alone, and of the pad as a whole.",
        (
            Column("height, cm", 0),
            *(Column(f"{t}, %" if t in kinds else t, 0) for t in titles),
        ),
        tuple(rows),
    )


def _false(frames: Sequence[FrameRead], methods: Sequence[str]) -> int:
    return sum(frame.readings[method].false for frame in frames for method in methods)


def series_table(
    frames: Sequence[FrameRead],
    series: ExperimentName,
    what: str,
    nominal: tuple[Column, Callable[[Place], float]],
    figure: PoseFigure,
) -> Table:
    """Of each place of a series, a figure of the truth and of both methods' poses.

    Parameters
    ----------
    frames : sequence of FrameRead
    series : ExperimentName
    what : str
        What the figure is, with its unit.
    nominal : (Column, callable)
        What tells places apart.
    figure : callable
        Takes a position (mm) and a tilt (degrees).
    """
    column, of_place = nominal
    columns = (
        column,
        Column(f"true {what}", 2),
        Column("method"),
        Column("read, %", 0),
        Column("measured", 2),
        Column("error", 3),
        Column("± one sigma", 3),
        Column("position off, mm", 3),
        Column("attitude off, °", 4),
    )
    rows: list[tuple[Cell, ...]] = []
    for number, place in enumerate(PLACES[series]):
        here = at(frames, series, number)
        truth = float(np.mean([figure(frame.position_mm, frame.tilt_deg) for frame in here]))
        for method in METHODS:
            cells = _method_cells(here, method, figure)
            rows.append((of_place(place), truth, method, *cells))
    return Table(series, _CAPTION, columns, tuple(rows))


_CAPTION = (
    "Means over the frames of a place that gave a pose; the error is measured against each frame's "
    "own truth, ± is its standard deviation, and what is off is the median length of the error."
)


def _method_cells(here: Sequence[FrameRead], method: str, figure: PoseFigure) -> list[Cell]:
    pairs = read(here, method)
    share = share_read(here, method)
    if not pairs:
        return [share, None, None, None, None, None]
    measured = np.array([figure(r.position_mm, r.tilt_deg) for _, r in pairs])
    errors = errors_of(here, method, figure)
    spread = float(errors.std(ddof=1)) if len(pairs) > 1 else None
    return [
        share,
        float(measured.mean()),
        float(errors.mean()),
        spread,
        float(np.median([r.error_mm for _, r in pairs])),
        float(np.median([r.error_deg for _, r in pairs])),
    ]


def samples_table(flight: Sequence[FrameRead]) -> Table:
    """Positions of a flight's frames, true and as measured; a failed frame has none."""
    columns = [Column("sample"), *(Column(f"true {axis}, mm", 1) for axis in "XYZ")]
    for method in METHODS:
        columns += [Column(f"{method} {axis}, mm", 1) for axis in "XYZ"]
        columns.append(Column(f"{method}: from"))
    rows: list[tuple[Cell, ...]] = []
    for number, frame in enumerate(flight, 1):
        row: list[Cell] = [number, *frame.position_mm]
        for method in METHODS:
            reading = frame.readings[method]
            if reading.ok:
                row += [*reading.position_mm, reading.layer]
            else:
                row += [None, None, None, "a false pose" if reading.false else reading.reason]
        rows.append(tuple(row))
    caption = (
        "The samples of one landing from 55 to 21 cm; where a frame failed, the stage and reason."
    )
    return Table("samples", caption, tuple(columns), tuple(rows))
