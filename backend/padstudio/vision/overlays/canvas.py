"""Strokes and colours of the overlays."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array, Image
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.cells.sampling import CellGrid
from padstudio.vision.dense.answer import uncertainty_of
from padstudio.vision.refine.results import RefinedPose
from padstudio.vision.search.lattice import Lattice
from padstudio.vision.stage.detection import Uncertainty

Color = tuple[int, int, int]

#: The two line families, told apart by lightness as well as by hue.
FIRST: Color = (70, 190, 255)
SECOND: Color = (255, 200, 60)
RIGHT: Color = (90, 220, 90)
WRONG: Color = (60, 60, 255)
#: Of the pad's X, Y, Z.
AXES: tuple[Color, Color, Color] = ((80, 80, 255), (90, 220, 90), (255, 140, 80))
# Positions are drawn with this many fractional bits.
_SHIFT = 4
_MOST_LINES = 400
# Grid lines nearer to each other than this would hide the picture.
_LEAST_GRID_PX = 7.0
# Smaller pictures are enlarged to at least this width.
_SHOWN_WIDTH = 700

#: Pictures are made no wider than this.
MAX_WIDTH = 1600


def fit(image: Image, width: int) -> Image:
    """A copy no wider than ``width``."""
    if image.shape[1] <= width:
        return image.copy()
    height = round(image.shape[0] * width / image.shape[1])
    return np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8)


def gray(values: NDArray[np.float32]) -> Image:
    """A plane as a grey picture, (h, w, 3) uint8."""
    plane = np.clip(np.round(values), 0, 255).astype(np.uint8)
    return np.asarray(cv2.cvtColor(plane, cv2.COLOR_GRAY2BGR), np.uint8)


def dim(picture: Image) -> Image:
    """A darker copy, on which strokes stand out."""
    return (picture * 0.55).astype(np.uint8)


def enlarge(picture: Image) -> tuple[Image, int]:
    """A small picture by a whole factor, so that strokes on it are fine, and the factor."""
    factor = max(1, -(-_SHOWN_WIDTH // picture.shape[1]))
    if factor == 1:
        return picture, 1
    return np.repeat(np.repeat(picture, factor, axis=0), factor, axis=1), factor


def points(picture: Image, xy: Array, color: Color, factor: int = 1) -> None:
    """Mark positions of a picture enlarged by a factor."""
    h, w = picture.shape[:2]
    # Large pictures are looked at scaled down, where single pixels fade.
    size = max(1, factor // 2, round(w / MAX_WIDTH))
    first = np.round((xy + 0.5) * factor - size / 2).astype(int)
    for dy in range(size):
        for dx in range(size):
            x, y = first[:, 0] + dx, first[:, 1] + dy
            inside = (x >= 0) & (y >= 0) & (x < w) & (y < h)
            picture[y[inside], x[inside]] = color


def lattice(picture: Image, found: Lattice, factor: int = 1) -> None:
    """Draw numbered grid lines into the plane they were found in, enlarged by a factor."""
    edges = found.families.edges
    scale = _ray_to_pixel(edges.rays[:, :2], edges.plane.from_frame(edges.xy))
    spans = ((found.columns, found.rows, FIRST), (found.rows, found.columns, SECOND))
    for axis, (numbers, span, color) in enumerate(spans):
        step = max(1, (numbers[1] - numbers[0]) // _MOST_LINES)
        for number in range(numbers[0], numbers[1] + 1, step):
            along = np.linspace(span[0], span[1], 24)
            fixed = np.full_like(along, number)
            pair = (fixed, along) if axis == 0 else (along, fixed)
            line = scale(found.to_rays(np.stack(pair, axis=1)))
            _polyline(picture, (line + 0.5) * factor - 0.5, color)


def _ray_to_pixel(rays: Array, pixels: Array):  # type: ignore[no-untyped-def]
    """A smooth map from rays to plane pixels, lens included, fitted to the edges' own pairs."""
    centre, spread = rays.mean(axis=0), max(float(rays.std()), 1e-9)

    def terms(r: Array) -> Array:
        x, y = ((r - centre) / spread).T
        return np.stack(
            [np.ones_like(x), x, y, x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3], axis=1
        )

    solved = np.linalg.lstsq(terms(rays), pixels, rcond=None)[0]
    return lambda r: terms(r) @ solved


def _polyline(picture: Image, xy: Array, color: Color, thickness: int = 1) -> None:
    if not np.isfinite(xy).all() or np.abs(xy).max() > 1e5:
        return
    at = np.round(xy * (1 << _SHIFT)).astype(np.int32)
    cv2.polylines(picture, [at.reshape(-1, 1, 2)], False, color, thickness, cv2.LINE_AA, _SHIFT)


def segment(picture: Image, start: Array, end: Array, color: Color, thickness: int = 1) -> None:
    """Draw a straight line between two points, smoothly."""
    _polyline(picture, np.stack([start, end]), color, thickness)


def disc(picture: Image, xy: Array, radius: float, color: Color) -> None:
    """Fill a disc, smoothly."""
    x, y = (int(v) for v in np.round(xy * (1 << _SHIFT)))
    r = max(1, round(radius * (1 << _SHIFT)))
    cv2.circle(picture, (x, y), r, color, cv2.FILLED, cv2.LINE_AA, _SHIFT)


class Canvas:
    """A picture of a frame to draw on in frame pixels.

    Parameters
    ----------
    picture : (h, w, 3) uint8
        Drawn into.
    scale : float
        Frame pixels per pixel of the picture.
    """

    def __init__(self, picture: Image, scale: float) -> None:
        self.picture = picture
        self._scale = scale

    def _at(self, xy: Array) -> Array:
        return (xy + 0.5) / self._scale - 0.5

    def cells(self, cells: CellGrid, expected: NDArray[np.int8]) -> None:
        """Mark each read cell: green where it agrees with the pad, red where it does not."""
        count = max(int(expected.max()) + 1, 2)
        levels = cells.levels(count)
        radius = float(np.clip(cells.cell_px / self._scale * 0.16, 0.5, 9))
        xy = self._at(cells.xy)
        for row, col in zip(*np.nonzero(cells.seen), strict=True):
            if expected[row, col] < 0:
                continue
            agrees = levels[row, col] == expected[row, col]
            self._dot(xy[row, col], radius if agrees else radius * 1.6, RIGHT if agrees else WRONG)

    def grid(self, cells: CellGrid) -> None:
        """Draw the lines between the read cells, faintly, where they stand apart."""
        if cells.cell_px / self._scale < _LEAST_GRID_PX:
            return
        lines = self.picture.copy()
        xy = self._at(np.where(cells.seen[..., None], cells.xy, np.nan))
        for axis in (0, 1):
            table = np.moveaxis(xy, axis, 0)
            for between in (table[:-1] + table[1:]) / 2:
                known = between[np.isfinite(between).all(axis=1)]
                if len(known) > 1:
                    _polyline(lines, known, (255, 255, 255))
        cv2.addWeighted(lines, 0.45, self.picture, 0.55, 0, dst=self.picture)

    def quad(self, corners: Array) -> None:
        """Draw a closed outline of four corners, frame pixels."""
        at = self._at(np.vstack([corners, corners[:1]]))
        _polyline(self.picture, at, (0, 0, 0), 4)
        _polyline(self.picture, at, FIRST, 2)

    def _dot(self, xy: Array, radius: float, color: Color) -> None:
        disc(self.picture, xy, radius, color)

    def dots(self, xy: Array, color: Color) -> None:
        """Mark points (N, 2)."""
        for at in self._at(xy):
            self._dot(at, 1.6, color)

    def quadrilateral(self, corners_xy: Array, color: Color) -> None:
        """Draw a closed line through corners (N, 2), the first of them marked."""
        at = self._at(corners_xy)
        _polyline(self.picture, np.concatenate([at, at[:1]]), color, 3)
        self._dot(at[0], 6.0, color)

    def borders(self, found: RefinedPose) -> None:
        """Mark the measured borders, those that count and those that do not.

        Where the pattern was matched as a whole, its borders are marked where the pose puts them.
        """
        if found.edge_points is None:
            self.dots(found.fit.pose.project(found.camera, found.borders.points_mm), SECOND)
            return
        at = self._at(found.edge_points.xy)
        for inlier, color in ((False, WRONG), (True, SECOND)):
            for xy in at[found.fit.inliers == inlier]:
                self._dot(xy, 1.2, color)

    def axes(self, found: RefinedPose) -> None:
        """Draw the pad's axes (X red, Y green, Z blue) amid the measured part.

        Where only range and bearing are known, the way to the pad's centre instead.
        """
        sigma = uncertainty_of(found.fit, found.camera.focal_px)
        if self._is_bearing(found.fit.pose.pose, found.camera, sigma):
            return
        points_mm = found.borders.points_mm
        origin = points_mm.mean(axis=0)
        length = 0.4 * max(float(np.ptp(points_mm[:, :2], axis=0).min()), found.layer.cell_mm)
        self._axes(found.fit.pose.project(found.camera, _axes_mm(origin, length)))

    def pose_axes(self, pose: Pose, camera: Camera, covariance: Array, points_mm: Array) -> None:
        """As `axes`, amid some of the pad's points, (N, 3) mm."""
        if self._is_bearing(pose, camera, Uncertainty.of(pose, covariance)):
            return
        size = float(np.ptp(points_mm[:, :2], axis=0).min())
        axes_mm = _axes_mm(points_mm.mean(axis=0), 0.4 * size)
        self._axes(MovingPose(pose).project(camera, axes_mm))

    def _is_bearing(self, pose: Pose, camera: Camera, sigma: Uncertainty) -> bool:
        """Mark the pad's centre where the attitude is too uncertain to be shown."""
        if sigma.quality_at(pose.range_mm) != "bearing":
            return False
        centre = camera.project(pose.bearing[None])[0]
        self.way_to(centre, pose.range_mm, sigma.range_sigma_mm)
        return True

    def way_to(self, centre_xy: Array, range_mm: float, sigma_mm: float) -> None:
        """Draw a ring about the pad's centre, or an arrow to it, and say how far away it is."""
        if not np.isfinite(centre_xy).all():
            return
        height, width = self.picture.shape[:2]
        size = np.array([width, height], float)
        radius = max(10.0, width / 60)
        at = self._at(centre_xy)
        inside = bool(((at > radius) & (at < size - radius)).all())
        if inside:
            way = [at + radius * _turned(angle) for angle in np.linspace(0, 2 * np.pi, 49)]
        else:
            ahead = (at - size / 2) / np.linalg.norm(at - size / 2)
            tip = size / 2 + ahead * (0.45 * height)
            barbs = [tip - radius * (ahead @ _rotation(turn)) for turn in (0.5, -0.5)]
            way = [size / 2, tip, barbs[0], tip, barbs[1]]
            at = tip
        _polyline(self.picture, np.array(way), (0, 0, 0), 5)
        _polyline(self.picture, np.array(way), FIRST, 2)
        text = f"{range_mm / 1000:.2f} +- {sigma_mm / 1000:.2f} m"
        _label(self.picture, at + [1.4 * radius, -1.4 * radius], text, width / 1400)

    def _axes(self, xy: Array) -> None:
        """Draw three strokes from the first of four points."""
        at = self._at(xy)
        for end, color in zip(at[1:], AXES, strict=True):
            if np.isfinite(end).all() and np.isfinite(at[0]).all():
                segment(self.picture, at[0], end, (0, 0, 0), 6)
                segment(self.picture, at[0], end, color, 3)


def _turned(angle: float) -> Array:
    return np.array([np.cos(angle), np.sin(angle)])


def _rotation(angle: float) -> Array:
    return np.array([_turned(angle), _turned(angle + np.pi / 2)])


def _label(picture: Image, xy: Array, text: str, scale: float) -> None:
    """Write a text at a place, moved so that it lies in the picture."""
    scale, font = max(0.5, scale), cv2.FONT_HERSHEY_SIMPLEX
    thick = max(1, round(2 * scale))
    (wide, tall), below = cv2.getTextSize(text, font, scale, thick)
    room = np.array([picture.shape[1] - wide - 4, picture.shape[0] - below - 4])
    x, y = np.clip(xy, [4, tall + 4], np.maximum(room, [4, tall + 4])).astype(int).tolist()
    for color, width in (((0, 0, 0), thick + 3), (FIRST, thick)):
        cv2.putText(picture, text, (x, y), font, scale, color, width, cv2.LINE_AA)


def _axes_mm(origin: Array, length: float) -> Array:
    return np.vstack([origin, origin + length * np.eye(3)])
