"""Turns stage outputs into pictures; the stages themselves never draw."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Image
from padstudio.pad.spec import Channel
from padstudio.vision.cells.correlation import Placement
from padstudio.vision.cells.layer_read import LayerRead
from padstudio.vision.dense.answer import Choice
from padstudio.vision.dense.whole_pad import WholeSign
from padstudio.vision.frame.block_mean import Binary
from padstudio.vision.frame.prepare import Denoise, Stretch, Unmixed, denoised
from padstudio.vision.frame.pyramid import BGR_INDEX, Plane
from padstudio.vision.overlays import baseline
from padstudio.vision.overlays import canvas as drawing
from padstudio.vision.refine.results import RefinedPose
from padstudio.vision.search.edges import Steps
from padstudio.vision.search.lattice import Lattice
from padstudio.vision.search.line_spacing import LineFamilies
from padstudio.vision.stage.trace import StageFailure, Trace

MAX_WIDTH = drawing.MAX_WIDTH


def stage_picture(trace: Trace, name: str, channel: Channel | None = None) -> Image | None:
    """A stage's output as a picture.

    Parameters
    ----------
    trace : Trace
    name : str
        One of `padstudio.vision.stage.trace.STAGES`.
    channel : {"red", "green", "blue"} or None

    Returns
    -------
    (h, w, 3) uint8 or None
        BGR: the whole frame, or the part of it that the stage looked at. None where the stage did
        not run, or left nothing to see.
    """
    output = shown_output(trace, name, channel)
    painter = _PAINTERS.get(type(output))
    return painter(trace, output, channel) if painter else None


def shown_output(trace: Trace, name: str, channel: Channel | None = None) -> object:
    """What is shown of a stage: its output; where it failed, what it had to work on.

    None where the stage did not run, or there is nothing to see.
    """
    record = trace.get(name, channel)
    if record is None:
        return None
    output = record.output
    if isinstance(output, StageFailure):
        output = _last_seen(trace, name, channel)
    return output if type(output) in _PAINTERS else None


def _last_seen(trace: Trace, name: str, channel: Channel | None) -> object:
    """What a failed stage had to work on, or the last thing it put out."""
    seen = [
        record.output
        for record in trace.records
        if record.channel == channel
        and not isinstance(record.output, StageFailure)
        and type(record.output) in _PAINTERS
    ]
    own = [
        record.output
        for record in trace.records
        if record.name == name
        and record.channel == channel
        and not isinstance(record.output, StageFailure)
        and type(record.output) in _PAINTERS
    ]
    return (own or seen or [None])[-1]


def _paint_stretch(trace: Trace, output: Stretch, channel: Channel | None) -> Image:
    picture = drawing.fit(trace.image, MAX_WIDTH)
    unmixed = trace.get("unmix")
    if unmixed is not None and isinstance(unmixed.output, Unmixed):
        picture = drawing.fit(unmixed.output.image, MAX_WIDTH)
    return _one_channel(output.apply(picture), channel)


def _paint_unmix(trace: Trace, output: Unmixed, channel: Channel | None) -> Image:
    return _one_channel(drawing.fit(output.image, MAX_WIDTH), channel)


def _paint_denoise(trace: Trace, output: Denoise, channel: Channel | None) -> Image:
    return _one_channel(drawing.fit(denoised(trace.image, output), MAX_WIDTH), channel)


def _one_channel(picture: Image, channel: Channel | None) -> Image:
    if channel is None:
        return picture
    plane = cv2.extractChannel(picture, BGR_INDEX[channel])
    return np.asarray(cv2.cvtColor(plane, cv2.COLOR_GRAY2BGR), np.uint8)


def _paint_plane(trace: Trace, output: Plane, channel: Channel | None) -> Image:
    return drawing.enlarge(drawing.gray(output.values))[0]


def _paint_binary(trace: Trace, output: Binary, channel: Channel | None) -> Image:
    picture = np.asarray(cv2.cvtColor(output.mask, cv2.COLOR_GRAY2BGR), np.uint8)
    return drawing.enlarge(picture)[0]


def _paint_edges(trace: Trace, output: Steps, channel: Channel | None) -> Image:
    dark = np.zeros((*output.plane.values.shape, 3), np.uint8)
    picture, factor = drawing.enlarge(dark)
    drawing.points(picture, output.plane.from_frame(output.xy), (255, 255, 255), factor)
    return picture


def _paint_lines(trace: Trace, output: LineFamilies, channel: Channel | None) -> Image:
    plane = output.edges.plane
    picture, factor = drawing.enlarge(drawing.dim(drawing.gray(plane.values)))
    local = plane.from_frame(output.edges.xy)
    drawing.points(picture, local[output.on_u], drawing.FIRST, factor)
    drawing.points(picture, local[output.on_v], drawing.SECOND, factor)
    return picture


def _paint_lattice(trace: Trace, output: Lattice, channel: Channel | None) -> Image:
    edges = output.families.edges
    picture, factor = drawing.enlarge(drawing.dim(drawing.gray(edges.plane.values)))
    drawing.lattice(picture, output, factor)
    return picture


def _paint_placement(trace: Trace, output: Placement, channel: Channel | None) -> Image:
    return _cells_over(trace, output.cells, output.expected)


def _paint_read(trace: Trace, output: LayerRead, channel: Channel | None) -> Image:
    return _cells_over(trace, output.cells, output.expected)


def _paint_choice(trace: Trace, output: Choice, channel: Channel | None) -> Image:
    return _cells_over(trace, output.read.cells, output.read.expected)


def _cells_over(trace: Trace, cells: Any, expected: NDArray[np.int8]) -> Image:
    picture = drawing.fit(trace.image, MAX_WIDTH)
    canvas = drawing.Canvas(picture, trace.image.shape[1] / picture.shape[1])
    canvas.grid(cells)
    canvas.cells(cells, expected)
    return canvas.picture


def _paint_whole_sign(trace: Trace, output: WholeSign, channel: Channel | None) -> Image:
    picture = drawing.fit(trace.image, MAX_WIDTH)
    canvas = drawing.Canvas(picture, trace.image.shape[1] / picture.shape[1])
    canvas.cells(output.read.cells, output.read.expected)
    canvas.quad(output.outline.corners_xy)
    return canvas.picture


def _paint_refined(trace: Trace, output: RefinedPose, channel: Channel | None) -> Image:
    picture = drawing.fit(trace.image, MAX_WIDTH)
    canvas = drawing.Canvas(picture, trace.image.shape[1] / picture.shape[1])
    canvas.borders(output)
    canvas.axes(output)
    return canvas.picture


_PAINTERS: dict[type, Callable[[Trace, Any, Channel | None], Image]] = {
    Stretch: _paint_stretch,
    Denoise: _paint_denoise,
    Unmixed: _paint_unmix,
    Plane: _paint_plane,
    Binary: _paint_binary,
    Steps: _paint_edges,
    LineFamilies: _paint_lines,
    Lattice: _paint_lattice,
    Placement: _paint_placement,
    LayerRead: _paint_read,
    Choice: _paint_choice,
    RefinedPose: _paint_refined,
    WholeSign: _paint_whole_sign,
    **baseline.PAINTERS,
}
