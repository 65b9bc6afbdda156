"""Names of lens models, and what a file's names and coefficients say together.

Coefficients are taken as OpenCV orders them. A name of another model, names that contradict each
other, and coefficients that fit two models are refused.

References
----------
OpenCV's calib3d (``calibrateCamera``, ``fisheye``); ``sensor_msgs/distortion_models.hpp`` of ROS.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.fields import Asked, LensFields
from padstudio.geometry.camera_files.parts.keys import plain
from padstudio.geometry.camera_files.parts.values import numbers

#: Code of the refusal of a file that says nothing of distortion.
NOT_SAID = "distortion_not_said"
#: What to do about it.
SAY_SO = (
    "if the lens has none, say so: --no-distortion on the command line, no_distortion in REST, the "
    "tick on the Cameras page"
)

#: Names, without case and signs, of models that are the same thing as one of ours.
RADTAN_NAMES = frozenset(
    [
        "plumbbob",
        "rationalpolynomial",
        "rational",
        "radtan",
        "radialtangential",
        "opencv",
        "pinholeradtan",
        "fullopencv",
    ]
)
FISHEYE_NAMES = frozenset(
    [
        "equidistant",
        "equi",
        "fisheye",
        "opencvfisheye",
        "fisheyeopencv",
        "pinholeequi",
        "pinholeequidistant",
        "kannalabrandt",
        "kannalabrandt4",
        "kannalabrandt8",
        "kb4",
        "kb8",
    ]
)
#: Names that say there is no distortion.
NONE_NAMES = frozenset(["none", "nodistortion"])
#: Names of the projection, which leave the distortion open.
PINHOLE_NAMES = frozenset(["pinhole", "perspective", "rectilinear"])
#: Names of models that no camera here has; a text that is one of them is not passed over.
FOREIGN_NAMES = frozenset(
    [
        "omni",
        "omnidirectional",
        "omniradtan",
        "mei",
        "unified",
        "ucm",
        "eucm",
        "extendedunified",
        "ds",
        "doublesphere",
        "fov",
        "atan",
        "brown",
        "brownconrady",
        "inversebrownconrady",
        "modifiedbrownconrady",
        "division",
        "thinprism",
        "tilted",
        "thinprismfisheye",
        "ftheta",
        "scaramuzza",
        "ocam",
        "ocamcalib",
        "cahvor",
        "cahvore",
        "stereographic",
        "orthographic",
        "equisolid",
        "equisolidfisheye",
        "equirectangular",
        "spherical",
        "panoramic",
    ]
)


class Said(NamedTuple):
    """What a file says of its lens.

    Attributes
    ----------
    names : sequence of (str, object)
        Keys that name a lens model, and their values.
    coefficients : (N,) float64 or None
        None where no key holds any.
    not_fisheye : bool
        A switch says so.
    """

    names: Sequence[tuple[str, Any]]
    coefficients: Array | None
    not_fisheye: bool = False


def lens_of(said: Said, asked: Asked) -> LensFields:
    """The lens that a file and its user describe.

    Raises
    ------
    CameraFormatError
        If that is none, two, or one of another kind.
    """
    kinds = {kind for key, value in said.names if (kind := _kind(key, value)) is not None}
    if said.not_fisheye:
        kinds.add("radtan")
    if len(kinds) > 1:
        told = ", ".join(f"{key}: {value}" for key, value in said.names)
        raise CameraFormatError(f"its lens models contradict each other ({told}); leave the right")
    kind = next(iter(kinds), None)
    given = said.coefficients
    if given is None or not len(given):
        return _without(kind, given, asked)
    if asked.no_distortion and (given.any() or kind == "fisheye"):
        raise CameraFormatError(
            "it holds a lens's distortion, and you say there is none; leave one of them out"
        )
    if kind == "none" and given.any():
        raise CameraFormatError("it names no lens model, and holds coefficients; name the model")
    if kind == "fisheye":
        if len(given) != 4:
            raise CameraFormatError(f"fisheye takes 4 distortion coefficients, not {len(given)}")
        return LensFields("fisheye", given)
    if kind is None and len(given) == 4 and not asked.no_distortion:
        raise CameraFormatError(
            "four distortion coefficients may be k1 k2 p1 p2 or a fisheye's; add distortion_model: "
            "plumb_bob or distortion_model: equidistant"
        )
    return LensFields("radtan", _radtan(given))


def _kind(key: str, value: Any) -> str | None:
    """radtan, fisheye or none; None where a name leaves it open."""
    name = plain(value) if isinstance(value, str) else ""
    if (not name and value in (None, "")) or name in PINHOLE_NAMES:
        return None
    for kind, names in (
        ("radtan", RADTAN_NAMES),
        ("fisheye", FISHEYE_NAMES),
        ("none", NONE_NAMES),
    ):
        if name in names:
            return kind
    raise CameraFormatError(
        f"{key} is {str(value)[:60]!r}, a lens model that is not read; calibrate with plumb_bob, "
        "rational_polynomial or equidistant"
    )


def _without(kind: str | None, given: Array | None, asked: Asked) -> LensFields:
    if kind == "fisheye":
        raise CameraFormatError("it names a fisheye and holds none of its four coefficients")
    said_so = kind == "none" or (given is not None and kind is None)
    if not said_so and not asked.no_distortion:
        raise CameraFormatError(
            "it holds no distortion coefficients under a key that is known "
            f"(distortion_coefficients, dist_coeffs, D, …); {SAY_SO}",
            code=NOT_SAID,
        )
    return LensFields("radtan", np.zeros(0))


def _radtan(given: Array) -> Array:
    # OpenCV writes 12 or 14 where thin prism and tilt were not asked for, all zero.
    if len(given) in (12, 14):
        if given[8:].any():
            raise CameraFormatError(
                f"its {len(given)} distortion coefficients include a thin prism or a tilt, not 0; "
                "calibrate without them"
            )
        given = given[:8]
    if len(given) not in (4, 5, 8):
        raise CameraFormatError(f"radtan takes 4, 5 or 8 distortion coefficients, not {len(given)}")
    if len(given) == 8 and given.any() and not (given % 1).any():
        raise CameraFormatError(
            "its eight distortion coefficients are whole numbers, as decimal commas leave of four; "
            "write decimal points"
        )
    return given


def one_vector(found: Sequence[tuple[str, Any]]) -> Array | None:
    """The coefficients that one or several keys hold, which must be the same."""
    vectors = [(key, numbers(value, key)) for key, value in found]
    for key, vector in vectors[1:]:
        first_key, first = vectors[0]
        if not np.array_equal(vector, first):
            raise CameraFormatError(f"{first_key} and {key} contradict each other; leave the right")
    return vectors[0][1] if vectors else None
