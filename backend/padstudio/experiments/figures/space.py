"""Paths and cones in space, in parallel projection."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.experiments.figures import svg
from padstudio.experiments.figures.svg import Point

_SIDE, _TOP = 16, 34

Point3 = Sequence[float]


@dataclass(frozen=True)
class Path3:
    """A path in space, as `padstudio.experiments.figures.chart.Marks`."""

    label: str
    points: tuple[Point3, ...]
    color: str = svg.COLORS[0]
    dashed: bool = False
    dotted: bool = True


@dataclass(frozen=True)
class Cone:
    """A camera in space: its view from its centre along its axis, so far."""

    tip: Point3
    axis: Point3
    length: float
    color: str = svg.COLORS[0]
    half_angle_deg: float = 22.0


def space(
    paths: Sequence[Path3],
    cones: Sequence[Cone] = (),
    square: float = 0.0,
    size: tuple[int, int] = (720, 420),
    azimuth_deg: float = 35.0,
) -> bytes:
    """Paths and cones over a square on the ground, in parallel projection from above and aside.

    Parameters
    ----------
    paths : sequence of Path3
    cones : sequence of Cone
    square : float
        Side of the square about the origin.
    size : (width, height)
    azimuth_deg : float
        From where it is looked at.
    """
    half = square / 2
    rim = [(-half, -half, 0.0), (half, -half, 0.0), (half, half, 0.0), (-half, half, 0.0)]
    view = _View([*rim, *(p for path in paths for p in path.points), *_ends(cones)], size)
    view.turn(azimuth_deg)
    parts = [view.polygon(rim, "#f1f3f5", svg.QUIET)]
    parts += [view.cone(cone) for cone in cones]
    parts += [view.path(path) for path in paths]
    keys = [svg.Key(path.label, path.color, path.dashed) for path in paths]
    return svg.picture([*parts, svg.legend(keys, _SIDE)], size)


class _View:
    """A parallel projection that fits points into the picture."""

    _UP = math.radians(28)

    def __init__(self, points: Sequence[Point3], size: tuple[int, int]) -> None:
        self._points, self._size = np.array(points, float), size
        self._axes = np.eye(3)[:2]

    def turn(self, azimuth_deg: float) -> None:
        """Look from a side, and fit."""
        a, s = math.radians(azimuth_deg), math.sin(self._UP)
        right = (math.cos(a), math.sin(a), 0.0)
        up = (-math.sin(a) * s, math.cos(a) * s, math.cos(self._UP))
        self._axes = np.array([right, up])
        flat = self._points @ self._axes.T
        low, high = flat.min(axis=0), flat.max(axis=0)
        room = np.array(self._size) - (2 * _SIDE, _TOP + _SIDE)
        self._scale = float((room / np.maximum(high - low, 1e-9)).min())
        self._middle = (low + high) / 2

    def at(self, point: Point3) -> Point:
        flat = (self._axes @ np.asarray(point, float) - self._middle) * self._scale
        across, up = self._size[0] / 2, (self._size[1] + _TOP - _SIDE) / 2
        return across + float(flat[0]), up - float(flat[1])

    def polygon(self, points: Sequence[Point3], fill: str, stroke: str) -> str:
        return svg.polygon([self.at(p) for p in points], fill, stroke)

    def path(self, path: Path3) -> str:
        places = [self.at(p) for p in path.points]
        dots = "".join(svg.dot(*p, path.color) for p in places) if path.dotted else ""
        return svg.polyline(places, path.color, path.dashed) + dots

    def cone(self, cone: Cone) -> str:
        rim = [self.at(point) for point in _rim(cone)]
        tip = self.at(cone.tip)
        body = svg.polygon(_hull([tip, *rim]), cone.color, cone.color, 0.14)
        return body + svg.polygon(rim, "none", cone.color)


def _rim(cone: Cone, count: int = 24) -> Array:
    """(count, 3): where a cone ends."""
    axis = np.asarray(cone.axis, float)
    side = np.cross(axis, (0.0, 0.0, 1.0) if abs(axis[2]) < 0.9 else (1.0, 0.0, 0.0))
    side /= np.linalg.norm(side)
    radius = cone.length * math.tan(math.radians(cone.half_angle_deg))
    turns = np.linspace(0, 2 * math.pi, count, endpoint=False)[:, None]
    ring = radius * (np.cos(turns) * side + np.sin(turns) * np.cross(axis, side))
    return np.asarray(np.asarray(cone.tip, float) + cone.length * axis + ring)


def _ends(cones: Sequence[Cone]) -> list[Point3]:
    return [tuple(point) for cone in cones for point in (cone.tip, *_rim(cone, 8))]


def _hull(points: Sequence[Point]) -> list[Point]:
    """The convex hull (A. M. Andrew's monotone chain, 1979)."""
    ordered = sorted(points)

    def half(given: Sequence[Point]) -> list[Point]:
        out: list[Point] = []
        for p in given:
            while len(out) > 1 and _turn(out[-2], out[-1], p) <= 0:
                out.pop()
            out.append(p)
        return out[:-1]

    return half(ordered) + half(ordered[::-1])


def _turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
