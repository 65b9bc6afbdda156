"""Nominal cameras: what makers' data sheets say of common drones, phones and webcams.

A preset has no distortion and its principal point in the middle; focal lengths of single devices
differ from it by a few per cent, and heights with them. Frames of another size of the same aspect
are read with scaled intrinsics, as with any camera.

How a focal length in pixels follows from a data sheet:

- "35 mm equivalent" compares picture *diagonals*: f_px = f_35 / 43.27 mm x the diagonal of the full
  still in pixels. Video of another aspect is taken to be the still's full width scaled, which is so
  in the modes listed; makers do not always say where a mode crops further.
- a diagonal field of view: f_px = half the diagonal / tan(half the angle).
- focal length and pixel pitch, where a sensor's data sheet gives both: f_px = f / pitch.

Sources, all of the makers: DJI's specification pages of each aircraft (effective pixels, "35 mm
format equivalent", image sizes, video resolutions); Apple's and Google's technical specifications
of the phones' main cameras; Logitech's of the webcams' diagonal fields of view; Raspberry Pi's
camera hardware documentation (module 2: 3.04 mm, 1.12 um; module 3: 4.74 mm, 1.4 um).

Readout times of the Raspberry Pi's modules follow from the Linux kernel's drivers, line length over
pixel rate times rows: imx219.c, 3448 / 182.4 MHz x 2464; imx708.c, 15648 / 595.2 MHz x 2592 (full
resolution). Makers of the others do not tell theirs; drones' differ from mode to mode.

The Mini 2's 2.7K video is the camera of the double-layer pad's flights: 24 mm equivalent on a
4000 x 3000 still of 5000 px diagonal gives 2773.5 px, times 2720 / 4000 gives 1886 px.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from padstudio.errors import NotFoundError
from padstudio.geometry.camera import Camera

NOTE = "nominal, calibrate for accuracy"
_PREFIX = "preset-"
#: Diagonal of a 36 mm x 24 mm negative, mm.
_NEGATIVE_DIAGONAL_MM = math.hypot(36.0, 24.0)


@dataclass(frozen=True)
class Preset:
    """A camera from a data sheet.

    Attributes
    ----------
    id : str
        Stable, starts with ``preset-``.
    camera : Camera
        With ``nominal`` True.
    note : str
        What the user must know of it.
    """

    id: str
    camera: Camera
    note: str = NOTE


def load_camera(name: str, *, no_distortion: bool = False) -> Camera:
    """The camera of a camera file, or of a preset's id; a file of that name wins.

    Parameters
    ----------
    name : str
        Of a file of several cameras, ``FILE#NAME`` is the one of that name or number.
    no_distortion : bool
        As of `Camera.load`; presets have none.
    """
    if name.startswith(_PREFIX) and not Path(name).exists():
        return get(name).camera
    file, which = file_and_choice(name)
    return Camera.load(file, no_distortion=no_distortion, which=which)


def file_and_choice(name: str) -> tuple[str, str | None]:
    """A camera file, and which of its cameras ``FILE#NAME`` means; a file of that name wins."""
    file, mark, chosen = name.rpartition("#")
    if mark and Path(file).exists() and not Path(name).exists():
        return file, chosen
    return name, None


def get(preset_id: str) -> Preset:
    """The preset of an id.

    Raises
    ------
    NotFoundError
        If there is none.
    """
    try:
        return PRESETS[preset_id]
    except KeyError:
        raise NotFoundError(
            f"there is no camera preset {preset_id!r}; there are {', '.join(PRESETS)}"
        ) from None


def _preset(
    slug: str,
    name: str,
    size: tuple[int, int],
    focal_px: float,
    readout_ms: float | None = None,
) -> Preset:
    width, height = size
    matrix = np.array(
        [[focal_px, 0.0, (width - 1) / 2], [0.0, focal_px, (height - 1) / 2], [0.0, 0.0, 1.0]]
    )
    camera = Camera(width, height, matrix, name=name, nominal=True, readout_ms=readout_ms)
    return Preset(f"preset-{slug}", camera)


def _equivalent(
    slug: str,
    name: str,
    f35_mm: float,
    still: tuple[int, int],
    videos: dict[str, tuple[int, int]],
) -> list[Preset]:
    """The still camera and the video modes that scale its full width."""
    focal_px = f35_mm / _NEGATIVE_DIAGONAL_MM * math.hypot(*still)
    made = [_preset(f"{slug}-still", f"{name}, still", still, focal_px)]
    made += [
        _preset(
            f"{slug}-{mode.lower().replace('.', '')}",
            f"{name}, {mode} video",
            size,
            focal_px * size[0] / still[0],
        )
        for mode, size in videos.items()
    ]
    return made


def _diagonal(slug: str, name: str, size: tuple[int, int], view_deg: float) -> Preset:
    focal_px = math.hypot(*size) / 2 / math.tan(math.radians(view_deg) / 2)
    return _preset(slug, name, size, focal_px)


_4K, _27K, _1080P = (3840, 2160), (2720, 1530), (1920, 1080)

#: All presets by id, the drones first.
PRESETS: dict[str, Preset] = {
    preset.id: preset
    for preset in [
        _preset("dji-mini-27k", "DJI Mini 2, 2.7K video", _27K, 1886.0),
        *_equivalent("dji-mini-2", "DJI Mini 2", 24, (4000, 3000), {"4K": _4K, "1080p": _1080P}),
        *_equivalent(
            "dji-mini-3-pro", "DJI Mini 3 Pro, 4 Pro", 24, (4032, 3024), {"4K": _4K, "2.7K": _27K}
        ),
        *_equivalent("dji-air-2s", "DJI Air 2S", 22, (5472, 3648), {"5.4K": (5472, 3078)}),
        *_equivalent("dji-air-3", "DJI Air 3, wide camera", 24, (4032, 3024), {"4K": _4K}),
        *_equivalent("dji-mavic-2-pro", "DJI Mavic 2 Pro", 28, (5472, 3648), {"4K": _4K}),
        *_equivalent("dji-mavic-3", "DJI Mavic 3, wide camera", 24, (5280, 3956), {"4K": _4K}),
        *_equivalent("dji-phantom-4-pro", "DJI Phantom 4 Pro", 24, (5472, 3648), {"4K": _4K}),
        *_equivalent("phone-26mm", "Phone, 26 mm main camera (iPhone 13)", 26, (4032, 3024), {}),
        *_equivalent("phone-25mm", "Phone, 25 mm main camera (Pixel 6)", 25, (4080, 3072), {}),
        _diagonal("webcam-c920", "Logitech C920, 1080p", _1080P, 78.0),
        _diagonal("webcam-c930e", "Logitech C930e, 1080p", _1080P, 90.0),
        _diagonal("webcam-c270", "Logitech C270, 720p", (1280, 720), 55.0),
        _preset(
            "raspberry-pi-2",
            "Raspberry Pi camera module 2",
            (3280, 2464),
            3.04e3 / 1.12,
            readout_ms=46.6,
        ),
        _preset(
            "raspberry-pi-3",
            "Raspberry Pi camera module 3",
            (4608, 2592),
            4.74e3 / 1.4,
            readout_ms=68.1,
        ),
    ]
}
