"""Charts: axes, marks, bands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from padstudio.experiments.figures import svg
from padstudio.experiments.figures.svg import Point

_LEFT, _RIGHT, _TOP, _BOTTOM = 64, 16, 34, 46
# Ticks along an axis, at the most and about.
_TICKS = 7


@dataclass(frozen=True)
class Axis:
    """An axis.

    Attributes
    ----------
    title : str
        With the unit.
    low, high : float
        Its ends.
    log : bool
        Even ratios are even lengths; both ends are then above 0.
    ticks : tuple of float
        None chooses them.
    """

    title: str
    low: float
    high: float
    log: bool = False
    ticks: tuple[float, ...] = ()

    def share(self, value: float) -> float:
        """Where a value lies, 0 at the low end and 1 at the high one."""
        if self.log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    @property
    def marked(self) -> tuple[float, ...]:
        """Its ticks."""
        return self.ticks or (_ratios(self) if self.log else _steps(self.low, self.high))


@dataclass(frozen=True)
class Marks:
    """One series.

    Attributes
    ----------
    label : str
        In the legend; empty leaves it out.
    points : tuple of (x, y)
        What is not finite is left out, and parts the line.
    color : str
    spread : tuple of float
        Half the length of each point's bar; empty draws none.
    joined, dotted, dashed : bool
        By a line; with dots; the line is dashed.
    """

    label: str
    points: tuple[Point, ...]
    color: str = svg.COLORS[0]
    spread: tuple[float, ...] = ()
    joined: bool = True
    dotted: bool = True
    dashed: bool = False


@dataclass(frozen=True)
class Band:
    """A part of the x axis that is shaded.

    Attributes
    ----------
    low, high : float
    label : str
        Stands in it.
    color : str
    """

    low: float
    high: float
    label: str = ""
    color: str = "#8a9099"


def chart(
    x: Axis,
    y: Axis,
    marks: Sequence[Marks],
    bands: Sequence[Band] = (),
    size: tuple[int, int] = (720, 320),
) -> bytes:
    """A chart.

    Parameters
    ----------
    x, y : Axis
    marks : sequence of Marks
    bands : sequence of Band
    size : (width, height)
        Pixels.
    """
    frame = _Frame(x, y, size)
    parts = [*map(frame.band, bands), *frame.grid(), *(frame.series(each) for each in marks)]
    keys = [svg.Key(each.label, each.color, each.dashed) for each in marks]
    return svg.picture([*parts, *frame.labels(), svg.legend(keys, _LEFT)], size)


class _Frame:
    """The place of a chart's values in the picture."""

    def __init__(self, x: Axis, y: Axis, size: tuple[int, int]) -> None:
        self.x, self.y = x, y
        self.right, self.bottom = size[0] - _RIGHT, size[1] - _BOTTOM

    def at(self, point: Point) -> Point:
        across, up = self.x.share(point[0]), self.y.share(point[1])
        return (
            _LEFT + across * (self.right - _LEFT),
            self.bottom - min(max(up, -0.02), 1.02) * (self.bottom - _TOP),
        )

    def band(self, band: Band) -> str:
        (left, _), (right, _) = self.at((band.low, self.y.low)), self.at((band.high, self.y.low))
        words = svg.text(band.label, (left + right) / 2, _TOP + 14, "middle", svg.QUIET, 11)
        return (
            f'<rect x="{left:.1f}" y="{_TOP}" width="{right - left:.1f}" '
            f'height="{self.bottom - _TOP}" fill="{band.color}" fill-opacity="0.16"/>{words}'
        )

    def grid(self) -> list[str]:
        parts = []
        for value in self.x.marked:
            across, _ = self.at((value, self.y.low))
            parts.append(svg.line((across, _TOP), (across, self.bottom), svg.GRID))
            parts.append(svg.text(svg.number(value), across, self.bottom + 16, "middle"))
        for value in self.y.marked:
            _, down = self.at((self.x.low, value))
            parts.append(svg.line((_LEFT, down), (self.right, down), svg.GRID))
            parts.append(svg.text(svg.number(value), _LEFT - 8, down + 4, "end"))
        corner = (_LEFT, self.bottom)
        return [*parts, svg.line((_LEFT, _TOP), corner, svg.QUIET),
                svg.line(corner, (self.right, self.bottom), svg.QUIET)]  # fmt: skip

    def labels(self) -> list[str]:
        across, down = (_LEFT + self.right) / 2, (_TOP + self.bottom) / 2
        turned = f'<g transform="translate(16 {down:.0f}) rotate(-90)">'
        return [
            svg.text(self.x.title, across, self.bottom + 36, "middle", svg.INK),
            turned + svg.text(self.y.title, 0, 0, "middle", svg.INK) + "</g>",
        ]

    def series(self, marks: Marks) -> str:
        parts = []
        if marks.joined:
            parts += [
                svg.polyline([self.at(p) for p in run], marks.color, marks.dashed)
                for run in _runs(marks.points)
            ]
        for place, point in enumerate(marks.points):
            if not _is_finite(point):
                continue
            across, down = self.at(point)
            if marks.spread and math.isfinite(marks.spread[place]):
                half = marks.spread[place]
                _, high = self.at((point[0], point[1] + half))
                _, low = self.at((point[0], point[1] - half))
                parts.append(svg.line((across, high), (across, low), marks.color, 1.5))
            if marks.dotted:
                parts.append(svg.dot(across, down, marks.color))
        return "".join(parts)


def _steps(low: float, high: float) -> tuple[float, ...]:
    """Round values between two."""
    rough = (high - low) / _TICKS
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * k for k in (1, 2, 2.5, 5, 10) if power * k >= rough)
    first = math.ceil(low / step - 1e-9)
    return tuple(step * k for k in range(first, math.floor(high / step + 1e-9) + 1))


def _ratios(axis: Axis) -> tuple[float, ...]:
    """1, 2 and 5 of each power of ten between two; powers alone where these are many."""
    first, last = math.floor(math.log10(axis.low)), math.ceil(math.log10(axis.high))
    leads = (1, 2, 5) if last - first <= 3 else (1,)
    values = (lead * 10.0**power for power in range(first, last + 1) for lead in leads)
    slack = 1 + 1e-9
    return tuple(v for v in values if axis.low / slack <= v <= axis.high * slack)


def _is_finite(point: Point) -> bool:
    return math.isfinite(point[0]) and math.isfinite(point[1])


def _runs(points: Sequence[Point]) -> list[list[Point]]:
    """Parts of a line between what is not finite."""
    runs: list[list[Point]] = [[]]
    for point in points:
        if _is_finite(point):
            runs[-1].append(point)
        elif runs[-1]:
            runs.append([])
    return [run for run in runs if len(run) > 1]
