"""Pictures of the paper's stages; see `padstudio.vision.overlays.stages`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np

from padstudio.arrays import Array, Image
from padstudio.pad.spec import Channel
from padstudio.vision.baseline.central_window import CentralWindow
from padstudio.vision.baseline.decode import WindowRead
from padstudio.vision.baseline.edges import EdgeMap
from padstudio.vision.baseline.hough import Lines
from padstudio.vision.baseline.line_grid import Family, LineGrid
from padstudio.vision.baseline.pose import WindowChoice, WindowPose
from padstudio.vision.outline.quadrilateral import Outline, OutlinePose
from padstudio.vision.overlays import canvas as drawing
from padstudio.vision.stage.trace import Trace

Painter = Callable[[Trace, Any, Channel | None], Image]

_DROPPED: drawing.Color = (150, 150, 150)
_WINDOW: drawing.Color = (90, 220, 90)
_CENTRE: drawing.Color = (60, 60, 255)
_DASH_PX = 9.0


def _paint_edges(trace: Trace, output: EdgeMap, channel: Channel | None) -> Image:
    picture = np.asarray(cv2.cvtColor(output.mask, cv2.COLOR_GRAY2BGR), np.uint8) // 3
    picture[output.thin > 0] = 255
    return picture


def _paint_merged(trace: Trace, output: Lines, channel: Channel | None) -> Image:
    picture = drawing.dim(drawing.gray(output.edges.plane.values))
    for pieces, color in ((output.segments, drawing.SECOND), (output.ends, drawing.FIRST)):
        for start, end in pieces:
            _stroke(picture, output.edges, start, end, color)
    return picture


def _paint_line_grid(trace: Trace, output: LineGrid, channel: Channel | None) -> Image:
    """Families in two colours, inserted lines dashed, dropped ones grey."""
    picture = drawing.dim(drawing.gray(output.found.edges.plane.values))
    for start, end in output.found.ends[~output.kept]:
        _stroke(picture, output.found.edges, start, end, _DROPPED)
    _draw_families(picture, output)
    return picture


def _draw_families(picture: Image, grid: LineGrid) -> None:
    for family, other, color in (
        (grid.columns, grid.rows, drawing.FIRST),
        (grid.rows, grid.columns, drawing.SECOND),
    ):
        for line, inserted in zip(family.lines, family.inserted, strict=True):
            start, end = _between(line, other)
            _stroke(picture, grid.found.edges, start, end, color, dashed=bool(inserted))


def _between(line: Array, other: Family) -> tuple[Array, Array]:
    """Where a line crosses the first and the last line of the other family."""
    ends = np.cross(line, other.lines[[0, -1]])
    return ends[0, :2] / ends[0, 2], ends[1, :2] / ends[1, 2]


def _stroke(
    picture: Image,
    edges: EdgeMap,
    start: Array,
    end: Array,
    color: drawing.Color,
    *,
    dashed: bool = False,
) -> None:
    """Draw a line that is straight without the lens's distortion."""
    length = float(np.linalg.norm(end - start))
    count = int(np.clip(length / _DASH_PX, 2, 400)) // 2 * 2 + 1
    stops = edges.bend(start + np.linspace(0, 1, count + 1)[:, None] * (end - start))
    for k in range(0, count, 2 if dashed else 1):
        drawing.segment(picture, stops[k], stops[k + 1], color)


def _paint_window(trace: Trace, output: CentralWindow, channel: Channel | None) -> Image:
    picture = drawing.dim(drawing.gray(output.plane.values))
    _draw_families(picture, output.grid)
    corners = output.plane.from_frame(output.corners_xy)
    for k in range(4):
        drawing.segment(picture, corners[k], corners[(k + 1) % 4], _WINDOW, 3)
    centre = output.plane.from_frame(output.centre_xy[None])[0]
    drawing.disc(picture, centre, 5.0, _CENTRE)
    return picture


def _paint_read(trace: Trace, output: WindowRead, channel: Channel | None) -> Image:
    canvas = _canvas(trace)
    canvas.cells(output.cells, output.expected)
    canvas.quadrilateral(output.window.corners_xy, _WINDOW)
    return canvas.picture


def _paint_choice(trace: Trace, output: WindowChoice, channel: Channel | None) -> Image:
    return _paint_read(trace, output.read, channel)


def _paint_window_pose(trace: Trace, output: WindowPose, channel: Channel | None) -> Image:
    canvas = _canvas(trace)
    canvas.cells(output.read.cells, output.read.expected)
    canvas.quadrilateral(output.read.window.corners_xy, _WINDOW)
    canvas.pose_axes(output.pose, output.camera, output.covariance, output.points_mm)
    return canvas.picture


def _paint_outline(trace: Trace, output: Outline, channel: Channel | None) -> Image:
    canvas = _canvas(trace)
    canvas.quadrilateral(output.corners_xy, _WINDOW)
    for side in output.sides:
        canvas.dots(side.points_xy[~side.inliers], drawing.WRONG)
        canvas.dots(side.points_xy[side.inliers], drawing.SECOND)
    return canvas.picture


def _paint_outline_pose(trace: Trace, output: OutlinePose, channel: Channel | None) -> Image:
    canvas = _canvas(trace)
    canvas.cells(output.read.cells, output.read.expected)
    canvas.quadrilateral(output.outline.corners_xy, _WINDOW)
    canvas.pose_axes(output.pose, output.camera, output.covariance, output.points_mm)
    return canvas.picture


def _canvas(trace: Trace) -> drawing.Canvas:
    picture = drawing.fit(trace.image, drawing.MAX_WIDTH)
    return drawing.Canvas(picture, trace.image.shape[1] / picture.shape[1])


#: How each of the paper's stage outputs is painted.
PAINTERS: dict[type, Painter] = {
    EdgeMap: _paint_edges,
    Lines: _paint_merged,
    LineGrid: _paint_line_grid,
    CentralWindow: _paint_window,
    WindowRead: _paint_read,
    WindowChoice: _paint_choice,
    WindowPose: _paint_window_pose,
    Outline: _paint_outline,
    OutlinePose: _paint_outline_pose,
}
