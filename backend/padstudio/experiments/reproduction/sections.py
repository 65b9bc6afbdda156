"""The report's sections: one for each experiment."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from padstudio.experiments.report import Column, Section
from padstudio.experiments.reproduction import charts
from padstudio.experiments.reproduction.plan import (
    CELLS_MM,
    COARSE_MM,
    FINE_MM,
    SERIES_MM,
    SIDE_MM,
    WINDOW,
    ExperimentName,
    Place,
    paper_camera,
)
from padstudio.experiments.reproduction.range_claims import range_claims
from padstudio.experiments.reproduction.reading import FrameRead
from padstudio.experiments.reproduction.series_claims import (
    GOOD_DEG,
    GOOD_SHARE,
    RULES,
    beyond_claim,
    measured_claim,
    steps_claim,
)
from padstudio.experiments.reproduction.spans import Span, height_cm
from padstudio.experiments.reproduction.stage_pictures import sampling, stages_figure
from padstudio.experiments.reproduction.tables import ranges_table, samples_table, series_table

TITLE = "The paper's experiments on the simulator"
# Below, the article samples poses of a landing, mm.
_SAMPLED_FROM_MM = 600.0


def conditions(seeds: int, frames: int) -> tuple[str, ...]:
    """How the frames were made, in words."""
    camera = paper_camera()
    return (
        "Source: the article on a landing sign based on double-layer unique coding (2024), "
        "doi:10.1177/17298806241279046. Its sizes and the course of its experiments are made "
        "again here, on simulated frames whose truth is known, and read by both methods of the "
        "detector: dense, the default, and paper, which follows the article. The article's own "
        "figures are measured on a real drone and are not repeated here.",
        f"The pad is {SIDE_MM:g} mm wide, with cells of {FINE_MM:g} mm (red, the fine layer) and "
        f"{COARSE_MM:g} mm (blue, the coarse one), windows of {WINDOW} × {WINDOW}, two levels, and "
        f"fields that are independent of each other. The camera has {camera.width} × "
        f"{camera.height} pixels and a focal length of {camera.focal_px:g} pixels (24 mm "
        "equivalent).",
        f"{frames} frames: {seeds} of each place, each with a place, heading and lean of its own "
        "(within 10 mm and 2°), on another patch of grass, under light of another strength (0.8 to "
        "1.15), slope (up to 30 % a metre) and colour, through a lens of another blur (0.5 to 1.1 "
        "pixels), with the noise of 2500 to 8000 electrons, a Bayer mosaic, sharpening, and JPEG "
        "of quality 80 to 92.",
        RULES,
    )


def section_of(name: ExperimentName, frames: Sequence[FrameRead]) -> Section:
    """The section of one experiment."""
    return _SECTIONS[name](frames)


def _x(xyz: Sequence[float], tilt: float) -> float:
    return xyz[0]


def _z(xyz: Sequence[float], tilt: float) -> float:
    return xyz[2]


def _tilt(xyz: Sequence[float], tilt: float) -> float:
    return tilt


def _share_of_height(place: Place) -> float:
    return GOOD_SHARE * place.height_mm


def _stages(frames: Sequence[FrameRead]) -> Section:
    figure, table = sampling()
    return Section("Stages and sampling", (), (), (table,), (stages_figure(), figure))


def _ranges(frames: Sequence[FrameRead]) -> Section:
    table, figure = ranges_table(frames), charts.ranges_figure(frames)
    return Section("Ranges of the layers", (), range_claims(frames), (table,), (figure,))


def _vertical(frames: Sequence[FrameRead]) -> Section:
    claim = measured_claim(
        frames,
        "Heights are measured well over a large range, from 154 to 8 cm.",
        Span("vertical", 8, 154, height_cm, " cm"),
        (_z, _share_of_height, " mm"),
    )
    nominal = (Column("height, cm", 0), height_cm)
    table = series_table(frames, "vertical", "Z, mm", nominal, _z)
    return Section("Vertical series", (), (claim,), (table,), (charts.vertical_figure(frames),))


def _horizontal(frames: Sequence[FrameRead]) -> Section:
    def across(place: Place) -> float:
        return place.x_mm

    claim = measured_claim(
        frames,
        f"Displacements across the pad are measured at {SERIES_MM / 1000:g} m.",
        Span("horizontal", -SIDE_MM, SIDE_MM, across, " mm"),
        (_x, _share_of_height, " mm"),
    )
    table = series_table(frames, "horizontal", "X, mm", (Column("held at X, mm", 0), across), _x)
    figure = charts.error_figure(
        frames, "horizontal", ("held at X, mm", across), ("error of X, mm", _x)
    )
    title = f"Horizontal series at {SERIES_MM / 1000:g} m"
    return Section(title, (), (claim,), (table,), (figure,))


def _attitude(frames: Sequence[FrameRead]) -> Section:
    def tilt(place: Place) -> float:
        return place.tilt_deg

    claim = measured_claim(
        frames,
        f"At {SERIES_MM / 1000:g} m attitudes of 10° to 40° are measured.",
        Span("attitude", 10, 40, tilt, "°"),
        (_tilt, lambda place: GOOD_DEG, "°"),
    )
    table = series_table(frames, "attitude", "tilt, °", (Column("held at, °", 0), tilt), _tilt)
    figures = (
        charts.attitude_figure(frames),
        charts.error_figure(frames, "attitude", ("held at, °", tilt), ("error of tilt, °", _tilt)),
        charts.tilts_figure(frames),
    )
    title = f"Attitude at {SERIES_MM / 1000:g} m"
    words = (
        "The optical axis leans in a direction of its own in each frame and meets the pad near its "
        f"centre's place; the height stays {SERIES_MM:g} mm, so that the pad is farther off at "
        "larger tilts.",
    )
    return Section(title, words, (claim, beyond_claim(frames)), (table,), figures)


def _landing(frames: Sequence[FrameRead]) -> Section:
    claim = measured_claim(
        frames,
        "A landing is followed from 154 to 21 cm.",
        Span("landing", 21, 154, height_cm, " cm"),
        (_z, _share_of_height, " mm"),
    )
    table = series_table(frames, "landing", "Z, mm", (Column("height, cm", 0), height_cm), _z)
    flight = charts.first_flight(frames)
    near = [frame for frame in flight if frame.position_mm[2] < _SAMPLED_FROM_MM]
    tables = (table, samples_table(near))
    return Section("Landing", (), (claim,), tables, charts.landing_figures(frames))


def _continuity(frames: Sequence[FrameRead]) -> Section:
    nominal = (Column("moved by, mm", 0), lambda place: place.x_mm)
    table = series_table(frames, "continuity", "X, mm", nominal, _x)
    words = (
        f"The camera moves along a rail {CELLS_MM:g} mm over the pad, by one cell of "
        f"{FINE_MM:g} mm at a time, so that each step leads to another central window.",
    )
    figures = (charts.continuity_figure(frames),)
    title = "Horizontal continuity, cell by cell"
    return Section(title, words, (steps_claim(frames),), (table,), figures)


_SECTIONS: dict[ExperimentName, Callable[[Sequence[FrameRead]], Section]] = {
    "stages": _stages,
    "ranges": _ranges,
    "vertical": _vertical,
    "horizontal": _horizontal,
    "attitude": _attitude,
    "landing": _landing,
    "continuity": _continuity,
}
