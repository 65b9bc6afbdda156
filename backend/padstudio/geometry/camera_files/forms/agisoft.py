"""Agisoft Metashape's camera calibration XML, of frame and fisheye cameras.

Its p1 and p2 are OpenCV's p2 and p1, its pixels have (0.5, 0.5) for the centre of the top-left one,
and cx, cy are counted from the middle of the picture; b1 is what fx exceeds fy by. Parameters that
are zero are left out of the file.

References
----------
Agisoft Metashape User Manual, Professional Edition, appendix "Camera models":
u = w/2 + cx + x' f + x' b1 + y' b2, v = h/2 + cy + y' f, with
x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6 + k4 r^8) + p1 (r^2 + 2 x^2) + 2 p2 x y; a fisheye's x, y are
those of the equidistant projection.
"""

from __future__ import annotations

import numpy as np

from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.fields import (
    Asked,
    CameraFields,
    Data,
    LensFields,
    camera_fields,
    refuse_choice,
)
from padstudio.geometry.camera_files.parts.lenses import NOT_SAID, SAY_SO
from padstudio.geometry.camera_files.parts.values import one_number, pinhole, whole_size

_LENS = ("k1", "k2", "k3", "k4", "p1", "p2", "p3", "p4", "b1", "b2", "skew")
_KNOWN = {"projection", "width", "height", "f", "cx", "cy", *_LENS, "date", "label", "serial"}


def read(values: Data, stem: str, asked: Asked) -> CameraFields:
    """Fields of its camera."""
    refuse_choice(asked)
    for key in values:
        if key not in _KNOWN:
            raise CameraFormatError(
                f"the element {key[:80]!r} is not known; a calibration has projection, width, "
                "height, f, cx, cy, k1 … k4, p1, p2, b1, b2. Export it anew from Metashape"
            )
    missing = [key for key in ("projection", "width", "height", "f") if values.get(key) is None]
    if missing:
        raise CameraFormatError(f"has no {missing[0]}; export the calibration from Metashape")
    size = whole_size([values["width"], values["height"]], "image size")
    given = {
        key: one_number(values[key], key) if values.get(key) is not None else 0.0
        for key in ("f", "cx", "cy", *_LENS)
    }
    matrix = pinhole(
        given["f"] + given["b1"],
        given["f"],
        size[0] / 2 + given["cx"] - 0.5,
        size[1] / 2 + given["cy"] - 0.5,
    )
    if not any(values.get(key) is not None for key in _LENS) and not asked.no_distortion:
        raise CameraFormatError(f"it holds no distortion; {SAY_SO}", code=NOT_SAID)
    return camera_fields(list(size), matrix, _lens(values["projection"], given, asked), stem)


def _lens(projection: object, given: dict[str, float], asked: Asked) -> LensFields:
    used = [key for key in _LENS if given[key] and key != "b1"]
    if asked.no_distortion:
        if used or projection != "frame":
            raise CameraFormatError(
                "it holds a lens's distortion, and you say there is none; leave one of them out"
            )
        return LensFields("radtan", np.zeros(0))
    if projection == "frame":
        _refuse(used, {"k4", "p3", "p4", "b2", "skew"}, "calibrate with k1, k2, k3, p1, p2, b1")
        order = ("k1", "k2", "p2", "p1", "k3")
        return LensFields("radtan", np.array([given[key] for key in order]))
    if projection == "fisheye":
        _refuse(used, {"p1", "p2", "p3", "p4", "b2", "skew"}, "calibrate with k1 … k4 and b1")
        return LensFields("fisheye", np.array([given[key] for key in ("k1", "k2", "k3", "k4")]))
    raise CameraFormatError(
        f"projection is {str(projection)[:60]!r}, a lens model that is not read; frame and fisheye "
        "are"
    )


def _refuse(used: list[str], unfit: set[str], todo: str) -> None:
    found = [key for key in used if key in unfit]
    if found:
        raise CameraFormatError(f"its {found[0]} is not 0, which no lens model here has; {todo}")
