"""Stages `stretch`, `denoise`, `unmix` and `channel`: from a frame to comparable planes."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Image, YuvFrame
from padstudio.pad.crosstalk import Matrix
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.frame import pixels_kernel
from padstudio.vision.frame.pyramid import BGR_INDEX, Box, Plane, Pyramid, Window
from padstudio.vision.frame.unmix import unmix
from padstudio.vision.frame.yuv import YuvPyramid
from padstudio.vision.stage.params import PrepareParams
from padstudio.vision.stage.trace import Recorder

# Percentiles rather than extremes: one hot pixel must not decide.
_DARK, _BRIGHT = 0.5, 99.5
# Range at the least: a stretch by more would only show the steps between grey values.
_LEAST_RANGE = 12.0
# Percentiles are taken at about this width, where single pixels no longer count.
_STATISTICS_WIDTH = 400
# A frame is grey where channels differ by more than this in less than this share of it.
_GREY, _COLOURED = 3, 0.002
# A pixel is an impulse when it is this far from its neighbours' median and nearly black or white:
# a quarter of the range, and its last thirtieth on either side.
_IMPULSE_STEP, _BLACK, _WHITE = 60, 8, 247
# Side of the samples, pixels: 46 000 together, of which the default threshold is 230.
_SAMPLE = 96
_SAMPLED = np.array([[0.5, 0.5], [0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]])


@dataclass(frozen=True)
class Stretch:
    """Linear stretch of each channel: ``low`` goes to 0, ``high`` to 255.

    Attributes
    ----------
    low, high : (blue, green, red) of float
        Grey values of the frame.
    dark, bright : float
        Share of pixels at 2 or below in all channels, and at 253 or above in any.
    grey : bool
        True where all channels show the same.
    veiled : bool
        True where the frame's contrast was made stronger, and its noise with it.
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    dark: float
    bright: float
    grey: bool = False
    veiled: bool = False

    def apply(self, image: Image) -> Image:
        """The stretched picture, (H, W, 3) uint8."""
        low, high = np.array(self.low), np.array(self.high)
        values = np.arange(256)[:, None]
        table = np.clip(255 * (values - low) / (high - low), 0, 255)
        return np.asarray(cv2.LUT(image, np.round(table).astype(np.uint8)[None]), np.uint8)

    def gain(self, channel: Channel) -> float:
        """Stretched grey values per grey value of the frame."""
        k = BGR_INDEX[channel]
        return 255 / (self.high[k] - self.low[k])


@dataclass(frozen=True)
class Denoise:
    """Whether the frame was cleared of salt and pepper.

    Attributes
    ----------
    impulses : float
        Share of pixels that are impulses, from samples of the frame.
    applied : bool
        True where the 3 × 3 median was taken.
    """

    impulses: float
    applied: bool


@dataclass(frozen=True, eq=False)
class Unmixed:
    """A frame whose colours were taken apart by the pad's crosstalk.

    Attributes
    ----------
    image : (H, W, 3) uint8
        BGR.
    """

    image: Image


def find_stretch(pyramid: Pyramid) -> Stretch:
    """Measure the grey values that span a frame."""
    level = max(0, round(np.log2(max(pyramid.width / _STATISTICS_WIDTH, 1))))
    image = pyramid.level(level)
    low, high = [], []
    for k in range(3):
        histogram = cv2.calcHist([image], [k], None, [256], [0, 256]).ravel()
        share = np.cumsum(histogram) / histogram.sum() * 100
        a = int(np.searchsorted(share, _DARK))
        b = max(int(np.searchsorted(share, _BRIGHT)), int(a + _LEAST_RANGE))
        low.append(float(a))
        high.append(float(b))
    blue, green, red = cv2.split(image)
    top = np.asarray(cv2.max(cv2.max(blue, green), red))
    colour = top - cv2.min(cv2.min(blue, green), red)
    return Stretch(
        (low[0], low[1], low[2]),
        (high[0], high[1], high[2]),
        float((top <= 2).mean()),
        float((top >= 253).mean()),
        bool((colour > _GREY).mean() < _COLOURED),
    )


def find_denoise(brightness: Window, threshold: float) -> Denoise:
    """Measure salt and pepper in five samples of a frame.

    Parameters
    ----------
    brightness : Window
        At the frame's own scale.
    threshold : float
        Share of impulses from which the median is worth its time.
    """
    h, w = len(brightness.values), brightness.width
    size = min(_SAMPLE, h, w)
    corners = (_SAMPLED * [w - size, h - size]).astype(np.intp)
    limits = (float(_BLACK), float(_WHITE), float(_IMPULSE_STEP))
    found = pixels_kernel.impulses(brightness, corners, size, *limits)
    share = found / (len(corners) * (size - 2) ** 2)
    return Denoise(share, share > threshold)


def denoised(image: Image, denoise: Denoise) -> Image:
    """The frame without salt and pepper, or the frame itself."""
    return np.asarray(cv2.medianBlur(image, 3)) if denoise.applied else image


def take_apart(image: Image, matrix: Matrix) -> Unmixed:
    """The frame with its colours taken apart."""
    return Unmixed(unmix(image, matrix))


def prepare(
    image: Image | YuvFrame, pad: Pad, params: PrepareParams, recorder: Recorder
) -> Pyramid:
    """A frame without salt and pepper, its colours taken apart where the pad knows their mixture.

    Parameters
    ----------
    image : (H, W, 3) uint8, BGR, or YuvFrame
    pad : Pad
    params : PrepareParams
    recorder : Recorder
        Keeps the stages `denoise` and `unmix`.
    """
    if isinstance(image, YuvFrame):
        pyramid: Pyramid = YuvPyramid(image)
    else:
        pyramid = recorder.make("denoise", Pyramid, image)
    denoise = recorder.run("denoise", None, find_denoise, pyramid.brightness, params.impulse_share)
    mixed = pad.crosstalk is not None and params.unmix
    if not (denoise.applied or mixed or recorder.keep):
        return pyramid
    frame = recorder.make("denoise", denoised, pyramid.level(0), denoise)
    if pad.crosstalk is not None and params.unmix:
        frame = recorder.run("unmix", None, take_apart, frame, pad.crosstalk).image
    return recorder.make("denoise", Pyramid, frame)


def take_channel(
    pyramid: Pyramid, stretch: Stretch, channel: Channel, level: int, box: Box | None = None
) -> Plane:
    """One channel of a part of the frame at one scale, stretched, not clipped."""
    plane = pyramid.plane(channel, level, box)
    values: NDArray[np.float32] = plane.values
    values -= stretch.low[BGR_INDEX[channel]]
    values *= stretch.gain(channel)
    return plane
