"""From light to a stored picture: lens, sensor, colour, tone and compression."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Image
from padstudio.color import srgb_from_linear
from padstudio.errors import SpecError, shown
from padstudio.simulate.response import Response

Light = NDArray[np.float32]

# The light is kept in 16 bits until it is developed.
_RAW_MAX = 65535


@dataclass(frozen=True, kw_only=True)
class Glare:
    """A reflection of the sun or a lamp, with the haze it spreads.

    Attributes
    ----------
    x, y : float
        Its centre, shares of the frame's width and height.
    radius : float
        Of the bright core, share of the frame's height.
    strength : float
        Light at the centre; 1.0 alone brings black to white.
    """

    x: float = 0.5
    y: float = 0.5
    radius: float = 0.25
    strength: float = 3.0


@dataclass(frozen=True, kw_only=True)
class Imaging:
    """Optics, sensor and processing of a camera.

    Attributes
    ----------
    exposure_ms : float
        Time each row gathers light; with a motion it blurs.
    readout_ms : float
        From the first row's exposure to the last row's; 0 is a global shutter.
    brightness : float
        Exposure relative to a correct one.
    blur_px : float
        Standard deviation of the lens's blur, pixels.
    defocus_px : float
        Radius of the disc of confusion, pixels.
    vignetting : float
        Share of the light that is missing in the frame's corners.
    glare : Glare or None
    full_well_e : float
        Electrons at which a pixel saturates.
    read_noise_e : float
        Standard deviation of the noise of reading, electrons.
    hot_pixels : float
        Share of pixels that are stuck at black or white.
    bayer : bool
        Sample through an RGGB mosaic and demosaic.
    sharpen : float
        Strength of the camera's own unsharp mask.
    tone : {"srgb", "linear"}
    response : Response or None
        Of the sensor; None takes the scene's colours as they are. A monochrome one has no mosaic.
    jpeg_quality : int or None
        1 … 100, 4:2:0; None stores what the sensor gave.
    """

    exposure_ms: float = 2.0
    readout_ms: float = 0.0
    brightness: float = 1.0
    blur_px: float = 0.58
    defocus_px: float = 0.0
    vignetting: float = 0.25
    glare: Glare | None = None
    full_well_e: float = 8_000.0
    read_noise_e: float = 4.0
    hot_pixels: float = 0.0
    bayer: bool = True
    sharpen: float = 0.0
    tone: Literal["srgb", "linear"] = "srgb"
    response: Response | None = None
    jpeg_quality: int | None = 88

    def __post_init__(self) -> None:
        for name, low, high in _RANGES:
            value = getattr(self, name)
            if not low <= value <= high:
                raise SpecError(f"{name} is {value}; it must lie within {low} … {high}")
        if self.tone not in ("srgb", "linear"):
            raise SpecError(f"tone is {shown(self.tone)}; use srgb or linear")
        if self.jpeg_quality is not None and not 1 <= self.jpeg_quality <= 100:
            raise SpecError(f"jpeg_quality is {self.jpeg_quality}; it must lie within 1 … 100")

    @classmethod
    def ideal(cls) -> Imaging:
        """A camera without faults: area sampling and the sRGB curve, nothing else."""
        return cls(
            exposure_ms=0.0,
            blur_px=0.0,
            vignetting=0.0,
            read_noise_e=0.0,
            full_well_e=float("inf"),
            bayer=False,
            jpeg_quality=None,
        )

    def with_changes(self, **changes: Any) -> Imaging:
        """A copy with other values; raises `SpecError` where one is out of range."""
        return replace(self, **changes)


_RANGES = (
    ("exposure_ms", 0.0, 1000.0),
    ("readout_ms", 0.0, 1000.0),
    ("brightness", 0.001, 100.0),
    ("blur_px", 0.0, 50.0),
    ("defocus_px", 0.0, 100.0),
    ("vignetting", 0.0, 0.95),
    ("full_well_e", 50.0, float("inf")),
    ("read_noise_e", 0.0, 10_000.0),
    ("hot_pixels", 0.0, 0.5),
    ("sharpen", 0.0, 5.0),
)


def expose(light: Light, imaging: Imaging, rng: np.random.Generator) -> Image:
    """The picture that a camera makes of the light on its sensor, before compression.

    Parameters
    ----------
    light : (H, W, 3) float32
        Linear RGB as the sensor's response has it, 1.0 saturates at brightness 1. Overwritten.
    imaging : Imaging
    rng : numpy.random.Generator

    Returns
    -------
    (H, W, 3) uint8
        BGR.
    """
    light = _lens(light, imaging)
    mono = imaging.response is not None and imaging.response.mono
    bayer = imaging.bayer and not mono
    sampled = _mosaic(light) if bayer else light[..., 0] if mono else light
    raw = sensor(_shaded(sampled, imaging), imaging, rng)
    if mono:
        bgr = cv2.cvtColor(raw, cv2.COLOR_GRAY2BGR)
    elif bayer:
        # OpenCV names mosaics after the second row's second and third pixel.
        bgr = cv2.cvtColor(raw, cv2.COLOR_BayerBG2BGR_EA)
    else:
        bgr = cv2.cvtColor(raw, cv2.COLOR_RGB2BGR)
    picture = np.asarray(_tone_table(imaging.tone)[bgr], np.uint8)
    if imaging.sharpen > 0:
        soft = cv2.GaussianBlur(picture, (0, 0), 1.0)
        picture = np.asarray(
            cv2.addWeighted(picture, 1 + imaging.sharpen, soft, -imaging.sharpen, 0), np.uint8
        )
    return picture


def encode_jpeg(picture: Image, quality: int) -> bytes:
    """A picture (H, W, 3) uint8 BGR as a JPEG file with 4:2:0 colour."""
    options = [
        cv2.IMWRITE_JPEG_QUALITY,
        quality,
        cv2.IMWRITE_JPEG_SAMPLING_FACTOR,
        cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420,
    ]
    return bytes(cv2.imencode(".jpg", picture, options)[1])


def sensor(light: Light, imaging: Imaging, rng: np.random.Generator) -> NDArray[np.uint16]:
    """Photon and read noise, stuck pixels, saturation.

    The Poisson count of photons is drawn from a normal law of the same mean and variance, which
    above some twenty electrons nobody can tell apart, and below them the noise of reading covers.

    Parameters
    ----------
    light : (H, W) or (H, W, 3) float32
        1.0 is saturation.

    Returns
    -------
    same shape, uint16
        65535 is saturation.
    """
    out = light
    if np.isfinite(imaging.full_well_e):
        well = np.float32(imaging.full_well_e)
        # In place: writing to fresh memory takes as long as the arithmetic.
        out = np.maximum(light, 0)
        out *= 1 / well
        out += np.float32(imaging.read_noise_e / well) ** 2
        np.sqrt(out, out=out)
        out *= rng.standard_normal(light.shape, dtype=np.float32)
        out += light
    if imaging.hot_pixels > 0:
        draw = rng.random(light.shape, dtype=np.float32)
        out = np.where(draw < imaging.hot_pixels / 2, np.float32(0), out)
        out = np.where(draw > 1 - imaging.hot_pixels / 2, np.float32(1), out)
    scaled = out * np.float32(_RAW_MAX)
    scaled += np.float32(0.5)
    return np.clip(scaled, 0, _RAW_MAX, out=scaled).astype(np.uint16)


def _lens(light: Light, imaging: Imaging) -> Light:
    if imaging.defocus_px > 0:
        light = np.asarray(cv2.filter2D(light, -1, _disc(imaging.defocus_px)), np.float32)
    if imaging.blur_px > 0:
        light = np.asarray(cv2.GaussianBlur(light, (0, 0), imaging.blur_px), np.float32)
    return light


def _shaded(light: Light, imaging: Imaging) -> Light:
    """Glare, exposure and darker corners, on (H, W) or (H, W, 3), which is overwritten."""
    height, width = light.shape[:2]
    y = (np.arange(height, dtype=np.float32) - (height - 1) / 2)[:, None]
    x = (np.arange(width, dtype=np.float32) - (width - 1) / 2)[None, :]
    # Plane by plane: numpy takes three times as long where it spreads over three channels.
    planes = np.moveaxis(light, -1, 0) if light.ndim == 3 else light[None]
    if imaging.glare is not None:
        g = imaging.glare
        dx, dy = x - (g.x - 0.5) * width, y - (g.y - 0.5) * height
        square = (dx**2 + dy**2) / np.float32(g.radius * height) ** 2
        glow = np.float32(g.strength) * np.exp(-square)
        for plane in planes:
            plane += glow
    gain = np.float32(imaging.brightness)
    if imaging.vignetting > 0:
        square = (x**2 + y**2) / np.float32((width**2 + height**2) / 4)
        falloff = gain * (1 - np.float32(imaging.vignetting) * square)
        for plane in planes:
            plane *= falloff
    elif gain != 1:
        light *= gain
    return light


def _disc(radius: float) -> NDArray[np.float32]:
    """A disc of a radius in pixels with soft rim, of sum one."""
    reach = int(np.ceil(radius))
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    kernel = np.clip(radius + 0.5 - np.hypot(x, y), 0, 1).astype(np.float32)
    return np.asarray(kernel / kernel.sum(), np.float32)


def _mosaic(light: Light) -> Light:
    """RGGB: red at even rows and columns."""
    raw = np.empty(light.shape[:2], np.float32)
    raw[0::2, 0::2] = light[0::2, 0::2, 0]
    raw[0::2, 1::2] = light[0::2, 1::2, 1]
    raw[1::2, 0::2] = light[1::2, 0::2, 1]
    raw[1::2, 1::2] = light[1::2, 1::2, 2]
    return raw


def _tone_table(tone: str) -> Image:
    """(65536,) uint8: stored value of each raw value."""
    linear = np.arange(_RAW_MAX + 1) / _RAW_MAX
    curve = srgb_from_linear(linear) if tone == "srgb" else linear
    return np.round(curve * 255).astype(np.uint8)
