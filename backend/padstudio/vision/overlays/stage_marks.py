"""The marks of each stage's output."""

from __future__ import annotations

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Channel
from padstudio.vision.baseline.central_window import CentralWindow
from padstudio.vision.baseline.decode import WindowRead
from padstudio.vision.baseline.edges import EdgeMap
from padstudio.vision.baseline.hough import Lines
from padstudio.vision.baseline.line_grid import Family, LineGrid
from padstudio.vision.baseline.pose import WindowChoice, WindowPose
from padstudio.vision.cells.correlation import Placement
from padstudio.vision.cells.layer_read import LayerRead
from padstudio.vision.dense.answer import Choice
from padstudio.vision.dense.whole_pad import WholeSign
from padstudio.vision.outline.quadrilateral import Outline, OutlinePose
from padstudio.vision.overlays.lattice_lines import family_lines, lattice_lines
from padstudio.vision.overlays.marks import Line, LineKind, Marker, Marks
from padstudio.vision.overlays.stages import shown_output
from padstudio.vision.refine.results import RefinedPose
from padstudio.vision.search.lattice import Lattice
from padstudio.vision.search.line_spacing import LineFamilies
from padstudio.vision.stage.trace import Trace

# A line of a lens is bent, so it is drawn through so many points.
_POINTS = 16


def marks_of(trace: Trace, name: str, channel: Channel | None, camera: Camera) -> Marks:
    """What a stage says of the frame.

    Parameters
    ----------
    trace : Trace
    name : str
        One of `padstudio.vision.stage.trace.STAGES`.
    channel : {"red", "green", "blue"} or None
    camera : Camera
        At the frame's size.
    """
    marks = Marks()
    output = shown_output(trace, name, channel)
    if isinstance(output, LineFamilies):
        # The lattice that these lines became tells more of them.
        grid = shown_output(trace, "grid", channel)
        if isinstance(grid, Lattice) and grid.families is output:
            output = grid
    marker = _MARKERS.get(type(output))
    if marker is not None:
        marker(marks, output, camera)
    return marks


def _lattice(marks: Marks, output: Lattice, camera: Camera) -> None:
    marks.lines += lattice_lines(output, camera)


def _families(marks: Marks, output: LineFamilies, camera: Camera) -> None:
    marks.lines += family_lines(output, camera)


def _merged(marks: Marks, output: Lines, camera: Camera) -> None:
    text = "no family was found for it"
    for ends in output.ends:
        marks.lines.append(Line(_stroke(output.edges, *ends), None, "found", None, text))


def _line_grid(marks: Marks, output: LineGrid, camera: Camera) -> None:
    edges = output.found.edges
    for ends, reason in zip(output.found.ends, output.dropped, strict=True):
        if reason:
            marks.lines.append(Line(_stroke(edges, *ends), None, "dropped", None, reason))
    for axis, (family, other) in enumerate(
        ((output.columns, output.rows), (output.rows, output.columns))
    ):
        for k, line in enumerate(family.lines):
            is_new = bool(family.inserted[k])
            text = "no line was found here; the spacing says that one is" if is_new else ""
            kind: LineKind = "inserted" if is_new else "found"
            xy = _stroke(edges, *_between(line, other))
            marks.lines.append(Line(xy, axis, kind, family.first + k, text))


def _between(line: Array, other: Family) -> tuple[Array, Array]:
    """Where a line crosses the first and the last line of the other family."""
    ends = np.cross(line, other.lines[[0, -1]])
    return ends[0, :2] / ends[0, 2], ends[1, :2] / ends[1, 2]


def _stroke(edges: EdgeMap, start: Array, end: Array) -> Array:
    """Frame pixels (N, 2) along a line that is straight without the lens's distortion."""
    stops = start + np.linspace(0, 1, _POINTS)[:, None] * (end - start)
    return edges.plane.to_frame(edges.bend(stops))


def _window(marks: Marks, output: CentralWindow, camera: Camera) -> None:
    _line_grid(marks, output.grid, camera)
    marks.outlines.append(output.corners_xy)


def _placement(marks: Marks, output: Placement | LayerRead, camera: Camera) -> None:
    marks.add_cells(output.cells, output.expected)


def _choice(marks: Marks, output: Choice, camera: Camera) -> None:
    marks.add_cells(output.read.cells, output.read.expected)


def _window_read(marks: Marks, output: WindowRead, camera: Camera) -> None:
    marks.add_cells(output.cells, output.expected)
    marks.outlines.append(output.window.corners_xy)


def _window_choice(marks: Marks, output: WindowChoice, camera: Camera) -> None:
    _window_read(marks, output.read, camera)


def _window_pose(marks: Marks, output: WindowPose, camera: Camera) -> None:
    _window_read(marks, output.read, camera)
    marks.add_axes(output.pose, output.camera, output.points_mm)


def _refined(marks: Marks, output: RefinedPose, camera: Camera) -> None:
    if output.edge_points is not None:
        marks.add_points(output.edge_points.xy, output.fit.inliers)
    marks.add_axes(output.fit.pose.pose, output.camera, output.borders.points_mm)


def _outline(marks: Marks, output: Outline, camera: Camera) -> None:
    marks.outlines.append(output.corners_xy)
    for side in output.sides:
        marks.add_points(side.points_xy, side.inliers)


def _outline_pose(marks: Marks, output: OutlinePose, camera: Camera) -> None:
    marks.add_cells(output.read.cells, output.read.expected)
    marks.outlines.append(output.outline.corners_xy)
    marks.add_axes(output.pose, output.camera, output.points_mm)


def _whole_sign(marks: Marks, output: WholeSign, camera: Camera) -> None:
    marks.add_cells(output.read.cells, output.read.expected)
    marks.outlines.append(output.outline.corners_xy)


_MARKERS: dict[type, Marker] = {
    Lattice: _lattice,
    LineFamilies: _families,
    Lines: _merged,
    LineGrid: _line_grid,
    CentralWindow: _window,
    Placement: _placement,
    LayerRead: _placement,
    Choice: _choice,
    WindowRead: _window_read,
    WindowChoice: _window_choice,
    WindowPose: _window_pose,
    RefinedPose: _refined,
    Outline: _outline,
    OutlinePose: _outline_pose,
    WholeSign: _whole_sign,
}
