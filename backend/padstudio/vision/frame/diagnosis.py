"""Why a frame failed, measured on the frame, and what to try.

A stage only knows what it did not find. The cause is often elsewhere: too little light, motion,
a pad that is too far away, inks that are too much alike. Each suspicion is measured; the first one
that holds replaces the stage's own reason, and the stage's own words follow.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Image
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad
from padstudio.vision.frame.prepare import Stretch, find_stretch, prepare
from padstudio.vision.frame.pyramid import Box, Pyramid
from padstudio.vision.frame.regions import Region, faint_regions, find_regions
from padstudio.vision.frame.veil import is_veiled, unveiled
from padstudio.vision.stage.params import PrepareParams
from padstudio.vision.stage.trace import Reason, Recorder, StageFailure

# These pick a sentence, no pose depends on them. Brightest grey value below which a frame is too
# dark (a tenth of the range), and share of burnt-out pixels that a pad alone does not explain.
_DARK_TOP, _BURNT = 24.0, 0.2
# Range below which the steps between grey values and noise are most of what is seen.
_LEAST_RANGE = 10.0
# Coarse cells narrower than this can no longer be read: the sampling limit.
_LEAST_CELL_PX = 2.0
# Steps as seen without blur spread over so many pixels.
_SHARP_STEP_PX = 2.0
# Blur is named from three such steps on, and where the energy of slopes across it, which edges of
# two directions at right angles would make equal, is less than so much of that along it.
_BLUR_PX = 6.0
_BLUR_RATIO = 0.4
_AXES = ((1, 0), (0, 1))
# Correlation of two layers' channels, which are coded independently, from which inks are alike.
_CROSSTALK = 0.8
# Side of the part that is examined, pixels: many cells, and a few milliseconds.
_SAMPLE = 512


@dataclass(frozen=True)
class FrameEvidence:
    """What the frame is examined with.

    Attributes
    ----------
    pyramid : Pyramid
    camera : Camera
    pad : Pad
    stretch : Stretch
    regions : list of Region
        As `find_regions` gives them; the last one is the whole frame.
    light : Stretch or None
        Of the frame as it came, where a veil was taken off.
    came : Pyramid or None
        The frame as it came.
    """

    pyramid: Pyramid
    camera: Camera
    pad: Pad
    stretch: Stretch
    regions: list[Region]
    light: Stretch | None = None
    came: Pyramid | None = None

    @property
    def clear(self) -> list[Region]:
        """Regions of clear pad colour."""
        return self.regions[:-1]

    @cached_property
    def faint(self) -> list[Region]:
        """Regions of fainter marks."""
        return faint_regions(self.pyramid, self.pad, self.clear)

    def in_order(self) -> Iterator[Region]:
        """All regions as they are looked at, each made when it is asked for."""
        yield from self.clear
        yield from self.faint
        yield self.regions[-1]

    @property
    def box(self) -> Box:
        """The likeliest part of the frame."""
        return self.regions[0].box

    @property
    def seen(self) -> bool:
        """True where a part of the frame has the pad's colour."""
        return len(self.regions) > 1


def examine(
    image: Image,
    pad: Pad,
    camera: Camera,
    params: PrepareParams,
    recorder: Recorder,
    pads: int = 1,
) -> FrameEvidence:
    """What every method begins with: the frame prepared, its grey values, and where the pad can be.

    Parameters
    ----------
    image : (H, W, 3) uint8
        BGR.
    pad : Pad
    camera : Camera
        As calibrated; it is scaled to the frame.
    params : PrepareParams
    recorder : Recorder
        Keeps the stages `denoise`, `unmix`, `stretch` and `clean`.
    pads : int
        How many pads of these channels may be in view.

    Raises
    ------
    CameraMismatchError
        If the frame's aspect is not the camera's.
    """
    camera = camera.for_frame(image.shape[1], image.shape[0])
    pyramid = came = prepare(image, pad, params, recorder)
    stretch = light = recorder.run("stretch", None, find_stretch, pyramid)
    if is_veiled(light):
        pyramid = Pyramid(unveiled(pyramid.level(0)))
        found = recorder.run("stretch", None, find_stretch, pyramid)
        stretch = replace(found, veiled=True, grey=light.grey)
    regions = recorder.run("clean", None, find_regions, pyramid, pad, pads)
    return FrameEvidence(pyramid, camera, pad, stretch, regions, light, came)


def diagnose(frame: FrameEvidence, failure: StageFailure) -> StageFailure:
    """The likeliest cause of a failure, with figures and advice.

    Parameters
    ----------
    frame : FrameEvidence
    failure : StageFailure
        What the stage that came nearest to an answer says.

    Returns
    -------
    StageFailure
        Of the same stage.
    """
    # Few cells that agree are in good light: they are too near, or too far away.
    checks = (_size,) if failure.reason is Reason.TOO_FEW_CELLS else _CHECKS
    for check in checks:
        for reason, detail, advice in check(frame):
            return replace(
                failure, reason=reason, detail=f"{detail}; {failure.detail}", advice=advice
            )
    return replace(failure, advice=failure.advice or _ADVICE.get(failure.reason, ""))


Finding = tuple[Reason, str, str]


def _light(frame: FrameEvidence) -> Iterator[Finding]:
    stretch = frame.light or frame.stretch
    top = max(stretch.high)
    if stretch.bright > _BURNT:
        yield (
            Reason.OVEREXPOSED,
            f"overexposed: {100 * stretch.bright:.0f} % of the picture is burnt out",
            "lower the exposure by one or two stops, or shade the pad from glare",
        )
    if top < _DARK_TOP:
        yield (
            Reason.UNDEREXPOSED,
            f"underexposed: the brightest parts reach {top:.0f} of 255",
            "raise exposure or gain, or light the pad",
        )
    contrast = max(h - low for h, low in zip(stretch.high, stretch.low, strict=True))
    if contrast < 2 * _LEAST_RANGE and stretch.dark < 0.5:
        yield (
            Reason.NO_CONTRAST,
            f"the picture is nearly flat: its grey values span {contrast:.0f} of 255",
            "check that the lens is free and the pad in view",
        )


def _size(frame: FrameEvidence) -> Iterator[Finding]:
    """Cells too small or too large, judged by the size of what has the pad's colour."""
    if not frame.seen:
        return
    pad, box = frame.pad, frame.box
    coarse = max(layer.cell_mm for layer in pad.layers)
    width_px = max(box.x1 - box.x0, box.y1 - box.y0) / 1.15
    touches = box.x0 <= 0 or box.y0 <= 0
    touches = touches or box.x1 >= frame.pyramid.width or box.y1 >= frame.pyramid.height
    cell_px = width_px * coarse / math.hypot(*pad.size_mm)
    if touches or cell_px >= _LEAST_CELL_PX:
        return
    height_m = frame.camera.focal_px * coarse / _LEAST_CELL_PX / 1000
    yield (
        Reason.CELLS_TOO_SMALL,
        f"the largest cells are about {cell_px:.1f} px wide here, {_LEAST_CELL_PX:.0f} are needed",
        f"fly below about {height_m:.1f} m with this camera, or print larger cells",
    )


def _blur(frame: FrameEvidence) -> Iterator[Finding]:
    """Motion blur flattens steps across its direction and leaves those along it.

    Only where the pad's colour is seen: other things may well have edges of one direction.
    """
    if not frame.seen:
        return
    plane = _sample(frame)
    angles = np.arange(0, 180, 15)
    gx, gy = (cv2.Sobel(plane, cv2.CV_32F, *axes, ksize=3, scale=0.125) for axes in _AXES)
    xx, xy, yy = (float(cv2.mean(a * b)[0]) for a, b in ((gx, gx), (gx, gy), (gy, gy)))
    c, s = np.cos(np.radians(angles)), np.sin(np.radians(angles))
    # The mean square of the slope along each direction.
    energy = c * c * xx + 2 * c * s * xy + s * s * yy
    least, most = int(np.argmin(energy)), int(np.argmax(energy))
    if energy[most] < 1e-3 or energy[least] > _BLUR_RATIO * energy[most]:
        return
    length = _SHARP_STEP_PX * energy[most] / max(energy[least], 1e-6)
    if length < _BLUR_PX:
        return
    direction = (180 - int(angles[least])) % 180
    yield (
        Reason.MOTION_BLUR,
        f"motion blur of about {min(length, 99.0):.0f} px along {direction}° in the picture",
        "shorten the exposure, add light, or fly slower",
    )


def _inks(frame: FrameEvidence) -> Iterator[Finding]:
    """The layers are coded apart, so their channels should not go together."""
    channels = [layer.channel for layer in frame.pad.layers]
    if len(channels) < 2 or not frame.seen:
        return
    first, second = (_sample(frame, channel) for channel in channels[:2])
    a, b = (plane - cv2.blur(plane, (31, 31)) for plane in (first, second))
    spread = float(a.std() * b.std())
    if spread < 1.0:
        return
    alike = float((a * b).mean()) / spread
    if alike > _CROSSTALK:
        yield (
            Reason.CROSSTALK,
            f"{channels[1]} is {100 * alike:.0f} % {channels[0]}",
            "un-mix by a photo of the test strip, or reprint with purer inks",
        )


def _sample(frame: FrameEvidence, channel: str | None = None) -> NDArray[np.float32]:
    """The middle of the likeliest part of the frame, at its own scale, stretched."""
    box, side = frame.box, _SAMPLE // 2
    x, y = (box.x0 + box.x1) // 2, (box.y0 + box.y1) // 2
    part = Box(
        max(box.x0, x - side), max(box.y0, y - side), min(box.x1, x + side), min(box.y1, y + side)
    )
    layer = next(item for item in frame.pad.layers if channel in (None, item.channel))
    values = frame.pyramid.plane(layer.channel, 0, part).values
    return np.asarray(values * np.float32(frame.stretch.gain(layer.channel)), np.float32)


_CHECKS: tuple[Callable[[FrameEvidence], Iterator[Finding]], ...] = (_light, _size, _inks, _blur)

_ADVICE = {
    Reason.NO_EDGES: "check that the pad is in view and in focus",
    Reason.TOO_FEW_LINES: "check that the pad is in view and lies flat",
    Reason.NO_LATTICE: "check that the pad is in view, lies flat, and that the camera file is this "
    "camera's",
    Reason.UNKNOWN_CODE: "another pad? Choose the file that this one was printed from",
    Reason.TOO_FEW_CELLS: "fly a little higher, so that more cells are in view",
    Reason.POSE_REJECTED: "check the camera file, and that the pad lies flat",
}
