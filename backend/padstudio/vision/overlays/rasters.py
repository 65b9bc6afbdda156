"""What a stage works on or puts out as a plain picture, and where in the frame it lies.

Nothing is drawn into it: pages lay lines and cells over it as data (`marks`). Only the part and
the size that somebody looks at are made.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np

from padstudio.arrays import Array, Image
from padstudio.pad.spec import Channel
from padstudio.vision.baseline.central_window import CentralWindow
from padstudio.vision.baseline.edges import EdgeMap
from padstudio.vision.baseline.hough import Lines
from padstudio.vision.baseline.line_grid import LineGrid
from padstudio.vision.frame.block_mean import Binary
from padstudio.vision.frame.prepare import Denoise, Stretch, Unmixed, denoised
from padstudio.vision.frame.pyramid import BGR_INDEX, Plane
from padstudio.vision.overlays import canvas as drawing
from padstudio.vision.overlays.stages import shown_output
from padstudio.vision.search.edges import Steps
from padstudio.vision.search.lattice import Lattice
from padstudio.vision.search.line_spacing import LineFamilies
from padstudio.vision.stage.trace import Trace

#: Left, top, right and bottom in the frame, pixels from its corner: a frame is (0, 0, W, H).
Part = tuple[float, float, float, float]
_FRAME = "frame"
# Coloured points stand out on a darker picture.
_DIMMED = 0.55


@dataclass(frozen=True, eq=False)
class Raster:
    """A picture and its place in the frame.

    Attributes
    ----------
    values : (h, w) or (h, w, 3) uint8, or (h, w) float32
        BGR where it has colours.
    x0, y0 : float
        Its corner in the frame, pixels from the frame's corner.
    pixel : float
        Side of its pixels in frame pixels.
    tone : callable or None
        What is still to be done to the part that is looked at.
    is_thin : bool
        Bright lines on black, which a mean over pixels would darken: they are made wider.
    """

    values: Any
    x0: float = 0.0
    y0: float = 0.0
    pixel: float = 1.0
    tone: Callable[[Image], Image] | None = None
    is_thin: bool = False

    @property
    def part(self) -> Part:
        """All of it."""
        height, width = self.values.shape[:2]
        return (
            self.x0, self.y0, self.x0 + width * self.pixel, self.y0 + height * self.pixel,
        )  # fmt: skip

    def cut(self, part: Part | None, scale: float) -> tuple[Image, Part]:
        """What of it lies in a part of the frame, no finer than it is shown.

        Parameters
        ----------
        part : Part or None
            None is all of it.
        scale : float
            Shown pixels per frame pixel.

        Returns
        -------
        image : (h, w) or (h, w, 3) uint8
            Empty where nothing of it lies there.
        part : Part
            Its place; whole pixels of the raster, so a little more than was asked for.
        """
        height, width = self.values.shape[:2]
        left, top, right, bottom = part or self.part
        columns = _span(left, right, self.x0, self.pixel, width)
        rows = _span(top, bottom, self.y0, self.pixel, height)
        image = self.values[rows[0] : rows[1], columns[0] : columns[1]]
        place = (
            self.x0 + columns[0] * self.pixel, self.y0 + rows[0] * self.pixel,
            self.x0 + columns[1] * self.pixel, self.y0 + rows[1] * self.pixel,
        )  # fmt: skip
        if not image.size:
            return np.zeros((0, 0), np.uint8), place
        size = [max(1, round(n * self.pixel * scale)) for n in (image.shape[1], image.shape[0])]
        if size[0] < image.shape[1] and size[1] < image.shape[0]:
            if self.is_thin:
                reach = -(-image.shape[1] // size[0])
                image = cv2.dilate(image, np.ones((reach, reach), np.uint8))
            image = cv2.resize(image, (size[0], size[1]), interpolation=cv2.INTER_AREA)
        if image.dtype != np.uint8:
            image = np.clip(np.rint(image), 0, 255).astype(np.uint8)
        image = np.ascontiguousarray(image)
        return (self.tone(image) if self.tone else image), place


def _span(low: float, high: float, start: float, pixel: float, count: int) -> tuple[int, int]:
    first = int(np.clip(np.floor((low - start) / pixel), 0, count))
    last = int(np.clip(np.ceil((high - start) / pixel), 0, count))
    return first, max(first, last)


def raster_of(trace: Trace, name: str, channel: Channel | None = None) -> Raster | None:
    """A stage's picture, or with ``frame`` for a name the frame's own.

    Returns
    -------
    Raster or None
        None where the stage did not run, or has no picture.
    """
    if name == _FRAME:
        return _one_channel(Raster(trace.image), channel)
    output = shown_output(trace, name, channel)
    make = _RASTERS.get(type(output))
    if make is not None:
        return make(trace, output, channel)
    # What is told of cells and poses is laid over the frame itself.
    return None if output is None else _one_channel(Raster(trace.image), channel)


def place_of(trace: Trace, name: str, channel: Channel | None = None) -> tuple[Part, float] | None:
    """Where a stage's picture lies and the side of its pixels, without making it."""
    output = shown_output(trace, name, channel)
    if output is None:
        return None
    plane_of = _PLANES.get(type(output))
    if plane_of is None:
        return Raster(trace.image).part, 1.0
    plane = plane_of(output)
    return _in_place(plane, plane.values).part, float(plane.pixel)


def _one_channel(raster: Raster, channel: Channel | None) -> Raster:
    if channel is None:
        return raster
    index = BGR_INDEX[channel]

    def tone(image: Image) -> Image:
        whole = raster.tone(image) if raster.tone else image
        return np.asarray(cv2.extractChannel(whole, index), np.uint8)

    return Raster(raster.values, raster.x0, raster.y0, raster.pixel, tone)


def _of_stretch(trace: Trace, output: Stretch, channel: Channel | None) -> Raster:
    unmixed = trace.get("unmix")
    image = trace.image
    if unmixed is not None and isinstance(unmixed.output, Unmixed):
        image = unmixed.output.image
    return _one_channel(Raster(image, tone=output.apply), channel)


def _of_denoise(trace: Trace, output: Denoise, channel: Channel | None) -> Raster:
    return _one_channel(Raster(denoised(trace.image, output)), channel)


def _of_unmixed(trace: Trace, output: Unmixed, channel: Channel | None) -> Raster:
    return _one_channel(Raster(output.image), channel)


def _in_place(plane: Plane, values: Any) -> Raster:
    pixel = float(plane.pixel)
    return Raster(values, plane.x0 * pixel, plane.y0 * pixel, pixel)


def _of_plane(trace: Trace, output: Plane, channel: Channel | None) -> Raster:
    return _in_place(output, output.values)


def _of_binary(trace: Trace, output: Binary, channel: Channel | None) -> Raster:
    return _in_place(output.plane, output.mask)


def _of_edge_map(trace: Trace, output: EdgeMap, channel: Channel | None) -> Raster:
    return _in_place(output.plane, np.maximum(output.mask // 3, output.thin))


def _of_steps(trace: Trace, output: Steps, channel: Channel | None) -> Raster:
    values = np.zeros(output.plane.values.shape, np.uint8)
    _put(values, output.plane.from_frame(output.xy), 255)
    return replace(_in_place(output.plane, values), is_thin=True)


def _of_families(trace: Trace, output: LineFamilies, channel: Channel | None) -> Raster:
    plane = output.edges.plane
    grey = cv2.convertScaleAbs(plane.values, alpha=_DIMMED)
    values = np.asarray(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), np.uint8)
    local = plane.from_frame(output.edges.xy)
    _put(values, local[output.on_u], drawing.FIRST)
    _put(values, local[output.on_v], drawing.SECOND)
    return _in_place(plane, values)


def _put(values: Image, xy: Array, value: Any) -> None:
    height, width = values.shape[:2]
    x, y = np.rint(xy).astype(np.intp).T
    inside = (x >= 0) & (y >= 0) & (x < width) & (y < height)
    values[y[inside], x[inside]] = value


def _of_lattice(trace: Trace, output: Lattice, channel: Channel | None) -> Raster:
    return _of_plane(trace, output.families.edges.plane, channel)


def _of_lines(trace: Trace, output: Lines, channel: Channel | None) -> Raster:
    return _of_plane(trace, output.edges.plane, channel)


def _of_line_grid(trace: Trace, output: LineGrid, channel: Channel | None) -> Raster:
    return _of_plane(trace, output.found.edges.plane, channel)


def _of_window(trace: Trace, output: CentralWindow, channel: Channel | None) -> Raster:
    return _of_plane(trace, output.plane, channel)


_RASTERS: dict[type, Callable[[Trace, Any, Channel | None], Raster]] = {
    Stretch: _of_stretch,
    Denoise: _of_denoise,
    Unmixed: _of_unmixed,
    Plane: _of_plane,
    Binary: _of_binary,
    EdgeMap: _of_edge_map,
    Steps: _of_steps,
    LineFamilies: _of_families,
    Lattice: _of_lattice,
    Lines: _of_lines,
    LineGrid: _of_line_grid,
    CentralWindow: _of_window,
}

_PLANES: dict[type, Callable[[Any], Plane]] = {
    Plane: lambda output: output,
    Binary: lambda output: output.plane,
    EdgeMap: lambda output: output.plane,
    Steps: lambda output: output.plane,
    LineFamilies: lambda output: output.edges.plane,
    Lattice: lambda output: output.families.edges.plane,
    Lines: lambda output: output.edges.plane,
    LineGrid: lambda output: output.found.edges.plane,
    CentralWindow: lambda output: output.plane,
}
