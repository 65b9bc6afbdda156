"""Pictures of a shoot-out: frames, verdicts as strips, errors over the height."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.experiments.figures import svg
from padstudio.experiments.shootout.boards.sheets import Page
from padstudio.experiments.shootout.entry import Entry
from padstudio.experiments.shootout.scores import Outcome
from padstudio.geometry.pose import Pose
from padstudio.simulate.radiance.lens import pixels_of_points
from padstudio.simulate.render import Frame

_THUMBNAIL_PX = 320
# BGR; on pads and grounds alike.
_OUTLINE = (255, 255, 0)
_WIDTH, _LEFT, _RIGHT, _ROW, _TOP = 900, 200, 20, 22, 14
_CHART_HEIGHT = 420
_READ, _FALSE, _MISSED = "#1a6b35", "#a8201f", "#777"
# A board has a colour; its second reader's line is dashed.
_COLORS = (
    "#1a4f8b", "#a8201f", "#1a6b35", "#7a3d9a", "#b06000", "#00707a", "#8a4b2a", "#b0307a",
    "#555555", "#5a6b00", "#0a86c4",
)  # fmt: skip


@dataclass(frozen=True)
class Axis:
    """The level axis: heights in even ratios, or tilts in even steps.

    Attributes
    ----------
    low, high : float
    by_tilt : bool
    """

    low: float
    high: float
    by_tilt: bool

    def place(self, outcome: Outcome) -> float:
        """Where a frame is on the axis, 0 … 1 from the left."""
        if self.by_tilt:
            return (outcome.tilt_deg - self.low) / max(self.high - self.low, 1e-9)
        span = math.log(self.high / self.low) or 1.0
        return math.log(outcome.height_mm / self.low) / span

    def ticks(self) -> Iterator[tuple[float, str]]:
        """Places on the axis and their words."""
        if self.by_tilt:
            for tilt in range(0, 91, 10):
                if self.low <= tilt <= self.high:
                    yield (tilt - self.low) / max(self.high - self.low, 1e-9), f"{tilt}°"
            return
        span = math.log(self.high / self.low) or 1.0
        for power in range(-1, 7):
            for digit in (1, 2, 5):
                height = digit * 10.0**power
                if self.low <= height <= self.high:
                    yield math.log(height / self.low) / span, f"{height / 1000:g} m"


def axis_of(outcomes: Sequence[Outcome], *, by_tilt: bool) -> Axis:
    """The axis on which all frames of a flight have room."""
    values = [outcome.tilt_deg if by_tilt else outcome.height_mm for outcome in outcomes]
    low, high = min(values), max(values)
    return Axis(low, high, by_tilt) if by_tilt else Axis(low / 1.05, high * 1.05, by_tilt)


def thumbnail(frame: Frame, pose: Pose | None, page: Page) -> Image:
    """A frame, small, with the board's outline as a pose says where it is."""
    picture = np.array(frame.image)
    if pose is not None:
        x, y = page.width_mm / 2, page.height_mm / 2
        corners = np.array([[-x, y, 0], [x, y, 0], [x, -y, 0], [-x, -y, 0]])
        sides = np.linspace(corners, np.roll(corners, -1, axis=0), 32).transpose(1, 0, 2)
        pixels = pixels_of_points(frame.truth.camera, pose.to_camera(sides.reshape(-1, 3)))
        width = max(2, picture.shape[1] // 250)
        for start, end in zip(pixels, np.roll(pixels, -1, axis=0), strict=True):
            if np.isfinite([start, end]).all() and np.abs([start, end]).max() < 1e6:
                ends = [tuple(int(v) for v in np.round(point)) for point in (start, end)]
                cv2.line(picture, ends[0], ends[1], _OUTLINE, width, cv2.LINE_AA)
    height = round(picture.shape[0] * _THUMBNAIL_PX / picture.shape[1])
    small = cv2.resize(picture, (_THUMBNAIL_PX, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.uint8)


def side_by_side(pictures: Sequence[Image]) -> bytes:
    """Pictures of one size in a row, as a WebP file."""
    gap = np.full((pictures[0].shape[0], 6, 3), 255, np.uint8)
    row = [part for picture in pictures for part in (picture, gap)][:-1]
    done, data = cv2.imencode(".webp", np.hstack(row), [cv2.IMWRITE_WEBP_QUALITY, 80])
    if not done:
        raise RuntimeError("OpenCV cannot write WebP files")
    return data.tobytes()


def strips(entries: Sequence[Entry], axis: Axis) -> bytes:
    """SVG: a row for each reader, a mark for each frame at its height."""
    height = _TOP + _ROW * len(entries) + 40
    parts = list(_grid(axis, _TOP, _TOP + _ROW * len(entries)))
    for row, entry in enumerate(entries):
        y = _TOP + _ROW * (row + 0.5)
        parts.append(svg.text(f"{entry.title}, {entry.setting}", _LEFT - 10, y + 4, "end", svg.INK))
        parts.append(svg.line((_LEFT, y), (_WIDTH - _RIGHT, y), svg.GRID))
        parts += [_mark(_x(axis.place(outcome)), y, outcome.verdict) for outcome in entry.outcomes]
    return svg.picture(parts, (_WIDTH, height))


def errors(entries: Sequence[Entry], axis: Axis) -> bytes:
    """SVG: the position's error of each frame that was read, over the height, both in ratios."""
    found = [o.error_percent for e in entries for o in e.outcomes if o.verdict == "read"]
    known = [max(error, 1e-4) for error in found if error is not None] or [0.01, 1.0]
    low, high = math.floor(math.log10(min(known))), math.ceil(math.log10(max(known)))
    high = max(high, low + 1)

    def y_of(percent: float) -> float:
        share = (math.log10(max(percent, 1e-4)) - low) / (high - low)
        return _TOP + (1 - share) * _CHART_HEIGHT

    parts = list(_grid(axis, _TOP, _TOP + _CHART_HEIGHT))
    for power in range(low, high + 1):
        y = y_of(10.0**power)
        parts.append(svg.line((_LEFT, y), (_WIDTH - _RIGHT, y), svg.GRID))
        parts.append(svg.text(f"{10.0**power:g} %", _LEFT - 8, y + 4, "end"))
    legend = _TOP + _CHART_HEIGHT + 44
    boards = list(dict.fromkeys(entry.board for entry in entries))
    for number, entry in enumerate(entries):
        color = _COLORS[boards.index(entry.board) % len(_COLORS)]
        dashed = number > 0 and entries[number - 1].board == entry.board
        parts += _curve(entry, color, dashed, lambda o, e: (_x(axis.place(o)), y_of(e)))
        x, y = 20 + 290 * (number % 3), legend + 20 * (number // 3)
        parts.append(svg.polyline([(x, y), (x + 30, y)], color, dashed))
        parts.append(svg.text(f"{entry.title}, {entry.setting}", x + 38, y + 4, "start", svg.INK))
    return svg.picture(parts, (_WIDTH, legend + 20 * math.ceil(len(entries) / 3)))


def _curve(
    entry: Entry, color: str, dashed: bool, at: Callable[[Outcome, float], svg.Point]
) -> Iterator[str]:
    """A line through frames that were read, broken where one between them was not."""
    run: list[svg.Point] = []
    for outcome in entry.outcomes:
        if outcome.verdict == "read" and outcome.error_percent is not None:
            run.append(at(outcome, outcome.error_percent))
            yield svg.dot(*run[-1], color)
        else:
            yield svg.polyline(run, color, dashed)
            run = []
    yield svg.polyline(run, color, dashed)


def _grid(axis: Axis, top: float, bottom: float) -> Iterator[str]:
    for place, words in axis.ticks():
        x = _x(place)
        yield svg.line((x, top), (x, bottom), svg.GRID)
        yield svg.text(words, x, bottom + 18, "middle")


def _x(place: float) -> float:
    return _LEFT + 8 + place * (_WIDTH - _LEFT - _RIGHT - 16)


def _mark(x: float, y: float, verdict: str) -> str:
    """A full bar, a cross or a hollow ring: told apart without colours too."""
    if verdict == "read":
        return f'<rect x="{x - 3.5:.1f}" y="{y - 8}" width="7" height="16" fill="{_READ}"/>'
    if verdict == "false":
        return (
            f'<path d="M{x - 5:.1f} {y - 5}l10 10m0 -10l-10 10" stroke="{_FALSE}" '
            'stroke-width="2.5"/>'
        )
    return f'<circle cx="{x:.1f}" cy="{y}" r="3" fill="#fff" stroke="{_MISSED}"/>'
