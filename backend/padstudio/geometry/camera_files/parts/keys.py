"""Which keys of camera files are known, which are harmless, and what is refused.

A lens that is lost gives poses that are centimetres off and do not say so. Therefore every key is
known to its form, known to be harmless, or a plain text that names no lens model; any other, which
holds a number, a list or a mapping or is called like a part of a lens, is refused by name.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import Any

from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.values import is_number

#: Harmless where they hold one text, number or truth value.
SCALAR_KEYS = frozenset(
    [
        "name",
        "cameraname",
        "camera",
        "cameraid",
        "id",
        "uid",
        "uuid",
        "label",
        "description",
        "comment",
        "comments",
        "note",
        "notes",
        "author",
        "operator",
        "user",
        "host",
        "machine",
        "software",
        "program",
        "tool",
        "generator",
        "creator",
        "source",
        "version",
        "fileversion",
        "formatversion",
        "schemaversion",
        "date",
        "time",
        "timestamp",
        "stamp",
        "created",
        "createdat",
        "modified",
        "updated",
        "updatedat",
        "calibrationtime",
        "calibrationdate",
        "calibrationtimestamp",
        "calibratedat",
        "serial",
        "serialnumber",
        "serialno",
        "manufacturer",
        "vendor",
        "make",
        "brand",
        "device",
        "devicename",
        "deviceid",
        "devicemodel",
        "sensormodel",
        "phonemodel",
        "dronemodel",
        "sensor",
        "sensorname",
        "lensname",
        "frame",
        "frameid",
        "cameraframe",
        "opticalframe",
        "topic",
        "rostopic",
        "cameratopic",
        "imagetopic",
        "fps",
        "framerate",
        "hz",
        "pixelformat",
        "encoding",
        "exposure",
        "exposuretime",
        "gain",
        "iso",
        "temperature",
        "platform",
        "os",
        "seq",
        "calibrated",
        "iscalibrated",
        "success",
        "enabled",
        "flags",
        "calibrationflags",
        "flag",
        "aspectratio",
        "fixaspectratio",
        "fixprincipalpoint",
        "zerotangentdist",
        "fov",
        "hfov",
        "vfov",
        "dfov",
        "fovx",
        "fovy",
        "fovdeg",
        "focallengthmm",
        "sensorwidth",
        "sensorheight",
        "sensorwidthmm",
        "sensorheightmm",
        "aperturewidth",
        "apertureheight",
        "pixelsize",
        "pixelsizeum",
        "pixelpitch",
        "pixelpitchum",
        "rpe",
        "ret",
        "retval",
        "perviewerror",
        "quality",
        "score",
    ]
)
#: Harmless whatever they hold: of the undistorted picture, of how the calibration was made, of how
#: sure it is, of where the camera sits.
ANY_KEYS = re.compile(
    r"(projection|rectification|rectified|undistorted)matrix|undistorted(cameramatrix|k)"
    r"|(new|optimal|optimalnew)(cameramatrix|cameramtx|matrix|mtx|k)|newcamera(matrix|mtx)?"
    r"|valid(pix)?roi|header"
    r"|rms.*|.*(errors?|errs?|rms|rmse|rmserror|covariances?|cov|sigmas?|std|stds|stddevs?|stdev"
    r"|deviations?|uncertaint(y|ies)|variances?|residuals?|meansquare)"
    r"|std(dev)?iations?(int|ext)rinsics|std(int|ext)rinsics|perview.*"
    r"|(chess|checker)?boards?(size|width|height|rows|cols|type|shape|points)?"
    r"|(chess|checker)board.*|squares?(size|length|width|height|mm|sizemm|lengthmm)"
    r"|patterns?(size|type|width|height|rows|cols)?|markers?(size|length)|charuco.*|aruco.*"
    r"|grid(points|size|width|height)?|target(type|cols|rows|size)?"
    r"|calobject(warp|size|spacing)|images?(count|paths?|files?|points|names?|used)?"
    r"|imagepoints|objectpoints|corners|observations|snapshots?|samples|views"
    r"|(nr|n|num|number|numberof|count)(of)?(frames|images|views|samples|pictures)"
    r"|extrinsics?(parameters)?|rvecs?|tvecs?|rotations?|translations?|quaternion|position|pose"
    r"|t(cam|imu|cn|body|base|b|w|world)[a-z0-9]*|baseline"
)
# The rectification and the projection of the undistorted picture, as messages of ROS call them.
_MESSAGE_KEYS = {"r": 9, "p": 12}
#: A key called so is no plain text: it is a part of a lens, or says which one it is.
LENS_KEYS = re.compile(
    r".*(dist|fisheye|model|projection|skew|radial|tangential|rational|prism|omni|polynom|coeff"
    r"|undist|rectif|affin|tilt|shear|crop|scale|flip|mirror).*|[kpsbd]\d+|xi|alpha|beta|tau[xy]?|omega|gamma|kc|lens"
)


def plain(key: str) -> str:
    """A key or name without case and signs."""
    return re.sub(r"[^a-z0-9]", "", key.lower())


def gather(
    values: Mapping[str, Any],
    known: Mapping[str, str],
    understood: str,
    *,
    names: Collection[str] = (),
) -> dict[str, list[tuple[str, Any]]]:
    """Values by what they are; an absent one is an empty list.

    Parameters
    ----------
    values : mapping
        Of a file, by key.
    known : mapping
        What a key without case and signs is, in one word.
    understood : str
        What to write instead, for messages.
    names : collection of str
        Names of lens models, which are no plain text.

    Raises
    ------
    CameraFormatError
        If a key is neither known nor harmless.
    """
    found: dict[str, list[tuple[str, Any]]] = {word: [] for word in known.values()}
    for key, value in values.items():
        word = known.get(plain(key))
        if word is None:
            if not is_harmless(key, value, names):
                raise CameraFormatError(
                    f"the key {key[:80]!r} is not known and could hold a part of the lens; "
                    f"understood are {understood}. Remove it if it says nothing of the lens"
                )
        elif value is not None:
            found[word].append((key, value))
    return found


def is_harmless(key: str, value: Any, names: Collection[str] = ()) -> bool:
    """True for a key that says nothing of the lens, whatever the form."""
    word = plain(key)
    is_scalar = not isinstance(value, list | dict)
    if value is None or ANY_KEYS.fullmatch(word):
        return True
    if word in SCALAR_KEYS and is_scalar:
        return not (isinstance(value, str) and plain(value) in names)
    if word in _MESSAGE_KEYS:
        items = value.get("data") if isinstance(value, dict) else value
        return isinstance(items, list) and len(items) in (_MESSAGE_KEYS[word], 3)
    if LENS_KEYS.fullmatch(word) or not isinstance(value, str) or is_number(value):
        return False
    return plain(value) not in names and not re.fullmatch(r"[\s\d.,;()\[\]+\-eE]+", value)
