"""Camera files: reads ROS, OpenCV, Kalibr and PhotonVision calibrations, writes ROS YAML.

They are read to plain fields, of which `padstudio.geometry.camera.Camera` is built.

What each kind looks like:

- ROS ``camera_info`` YAML: ``image_width``, ``image_height``, ``camera_name``, ``camera_matrix``,
  ``distortion_model`` (plumb_bob, rational_polynomial, equidistant), ``distortion_coefficients``
  (wiki.ros.org/camera_calibration_parsers).
- OpenCV ``FileStorage`` YAML or JSON, as its calibration samples write it; several spellings of
  the keys are about, so case and underscores do not count.
- Kalibr camchain YAML: ``cam0`` with ``intrinsics``, ``distortion_model`` (radtan, equidistant),
  ``distortion_coeffs``, ``resolution`` (github.com/ethz-asl/kalibr/wiki/yaml-formats).
- PhotonVision's calibration JSON: ``resolution``, ``cameraIntrinsics``, ``distCoeffs``,
  ``lensmodel``.

Each may say ``readout_ms`` besides (in Kalibr's under ``cam0``): how long a rolling shutter takes
from the first row to the last, 0 for a global shutter.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from padstudio.arrays import Array
from padstudio.errors import CameraFormatError
from padstudio.geometry import plain_text
from padstudio.geometry.projection import LensModel

Data = Mapping[str, Any]

#: The largest side of a calibrated picture, pixels.
MAX_SIDE = 65_536

_MODELS: dict[str, LensModel] = {
    "plumb_bob": "radtan",
    "rational_polynomial": "radtan",
    "radtan": "radtan",
    "opencv": "radtan",
    "none": "radtan",
    "": "radtan",
    "equidistant": "fisheye",
    "fisheye": "fisheye",
}
_MATRIX_KEYS = ("cameramatrix", "intrinsicmatrix", "k")
_DISTORTION_KEYS = ("distortioncoefficients", "distcoeffs", "distortion", "d")
_SIZE_KEYS = ("imagesize", "framesize", "resolution")


class CameraFields(NamedTuple):
    """What a file says of a camera, in the order and meaning of `Camera`'s attributes."""

    width: int
    height: int
    matrix: Array
    distortion: Array
    model: LensModel
    name: str
    nominal: bool
    readout_ms: float | None


@contextmanager
def naming(name: str) -> Iterator[None]:
    """Lets the messages of camera errors start with a file's name."""
    try:
        yield
    except CameraFormatError as error:
        raise CameraFormatError(f"{name}: {error.message}", detail=error.detail) from error


def read(path: Path) -> bytes:
    """A camera file's content, no more of it than can be one.

    Raises
    ------
    CameraFormatError
        If it cannot be read.
    """
    try:
        with path.open("rb") as file:
            return file.read(plain_text.MAX_JSON_BYTES + 1)
    except OSError as error:
        raise CameraFormatError(f"cannot read {path.name}: {error.strerror}") from error


def parse(data: bytes | str, name: str) -> CameraFields:
    """Fields of a camera file of any of the kinds above.

    Parameters
    ----------
    data : bytes or str
    name : str
        The file's name; messages start with it, and a camera without a name takes its stem.

    Raises
    ------
    CameraFormatError
        If it is none of these kinds, naming what is wrong and where.
    """
    values = plain_text.parse(data.encode() if isinstance(data, str) else data, name)
    if not isinstance(values, dict):
        raise CameraFormatError(f"{name}: holds no keys and values; give a camera calibration")
    with naming(name):
        return _from_values({str(key): value for key, value in values.items()}, Path(name).stem)


def ros_yaml(camera: CameraFields) -> str:
    """A camera as ROS ``camera_info`` YAML, which `parse` reads back."""
    coefficients = camera.distortion.tolist()
    if camera.model == "fisheye":
        model, coefficients = "equidistant", coefficients or [0.0] * 4
    elif len(coefficients) == 8:
        model = "rational_polynomial"
    else:
        model, coefficients = "plumb_bob", (coefficients + [0.0] * 5)[:5]
    projection = np.hstack([camera.matrix, np.zeros((3, 1))])
    lines = [
        f"image_width: {camera.width}",
        f"image_height: {camera.height}",
        f"camera_name: {_quoted(camera.name)}",
        *(["nominal: true"] if camera.nominal else []),
        *([] if camera.readout_ms is None else [f"readout_ms: {_number(camera.readout_ms)}"]),
        *_matrix_lines("camera_matrix", camera.matrix),
        f"distortion_model: {model}",
        *_matrix_lines("distortion_coefficients", np.array([coefficients])),
        *_matrix_lines("rectification_matrix", np.eye(3)),
        *_matrix_lines("projection_matrix", projection),
    ]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    return str(yaml.safe_dump(text, default_style='"', width=10_000)).rstrip("\n")


def _matrix_lines(key: str, matrix: Array) -> list[str]:
    rows, cols = matrix.shape
    numbers = [_number(value) for value in matrix.ravel()]
    return [f"{key}:", f"  rows: {rows}", f"  cols: {cols}", f"  data: [{', '.join(numbers)}]"]


def _number(value: float) -> str:
    # YAML 1.1 wants a point in a number with an exponent; repr leaves it out of "1e-05".
    return re.sub(r"^(-?\d+)e", r"\1.0e", repr(float(value)))


def _from_values(values: Data, stem: str) -> CameraFields:
    chain = [key for key in values if re.fullmatch(r"cam\d+", key)]
    if chain:
        return _from_kalibr(values, chain)
    if "cameraIntrinsics" in values:
        return _from_photonvision(values, stem)
    return _from_opencv(values, stem)


def _from_opencv(values: Data, stem: str) -> CameraFields:
    """ROS and OpenCV, which differ in spelling alone."""
    plain = {key.lower().replace("_", ""): value for key, value in values.items()}
    matrix_key = _first(plain, _MATRIX_KEYS)
    if matrix_key is None:
        raise CameraFormatError(
            "has neither camera_matrix (ROS, OpenCV) nor cam0 (Kalibr) nor cameraIntrinsics "
            "(PhotonVision); give a calibration file of one of these"
        )
    distortion_key = _first(plain, _DISTORTION_KEYS)
    model = str(plain.get("distortionmodel", "none")).lower()
    if _flag(plain.get("fisheyemodel")):
        model = "fisheye"
    return _fields(
        size=_opencv_size(plain),
        matrix=_matrix(plain[matrix_key], "camera_matrix"),
        distortion=[] if distortion_key is None else plain[distortion_key],
        model=model,
        name=str(plain.get("cameraname", stem)),
        nominal=_flag(plain.get("nominal")),
        readout=plain.get("readoutms"),
    )


def _opencv_size(plain: Data) -> Any:
    key = _first(plain, _SIZE_KEYS)
    if key is not None:
        return plain[key]
    sides = [_first(plain, (f"image{side}", side)) for side in ("width", "height")]
    if None in sides:
        raise CameraFormatError(
            "has no image_width and image_height; add the size of the calibrated pictures, pixels"
        )
    return [plain[str(side)] for side in sides]


def _from_kalibr(values: Data, chain: list[str]) -> CameraFields:
    if len(chain) > 1:
        raise CameraFormatError(
            f"holds {len(chain)} cameras ({', '.join(chain)}); give a file with the one that flew"
        )
    camera = values[chain[0]]
    if not isinstance(camera, dict):
        raise CameraFormatError(f"{chain[0]} holds no keys and values")
    projection = camera.get("camera_model", "pinhole")
    if projection != "pinhole":
        raise CameraFormatError(
            f"camera_model is {projection!r}; calibrate with pinhole-radtan or pinhole-equi"
        )
    intrinsics = _numbers(camera.get("intrinsics"), "intrinsics")
    if len(intrinsics) != 4:
        raise CameraFormatError(f"intrinsics has {len(intrinsics)} numbers, not fx, fy, cx, cy")
    fx, fy, cx, cy = intrinsics
    return _fields(
        size=camera.get("resolution"),
        matrix=np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]]),
        distortion=camera.get("distortion_coeffs", []),
        model=str(camera.get("distortion_model", "none")).lower(),
        name=str(camera.get("rostopic", chain[0])),
        readout=camera.get("readout_ms"),
    )


def _from_photonvision(values: Data, stem: str) -> CameraFields:
    lens = str(values.get("lensmodel", "LENSMODEL_OPENCV"))
    # Files of before 2024 name the distortion coefficients so.
    distortion = values.get("distCoeffs", values.get("cameraExtrinsics", []))
    return _fields(
        size=values.get("resolution"),
        matrix=_matrix(values["cameraIntrinsics"], "cameraIntrinsics"),
        distortion=distortion,
        model=re.sub(r"^lensmodel_|\d+$", "", lens.lower()),
        name=stem,
        readout=values.get("readout_ms"),
    )


def _fields(
    *,
    size: Any,
    matrix: Array,
    distortion: Any,
    model: str,
    name: str,
    nominal: bool = False,
    readout: Any = None,
) -> CameraFields:
    if model not in _MODELS:
        raise CameraFormatError(
            f"lens model {model!r} is unknown; calibrate with plumb_bob, rational_polynomial or "
            "equidistant"
        )
    width, height = _size(size)
    if matrix[0, 1] or matrix[1, 0]:
        raise CameraFormatError("the camera matrix has skew; calibrate without it")
    if not (-0.5 <= matrix[0, 2] < width and -0.5 <= matrix[1, 2] < height):
        raise CameraFormatError(
            f"the principal point ({matrix[0, 2]:g}, {matrix[1, 2]:g}) lies outside the picture of "
            f"{width} x {height}; matrix and size are not of one calibration"
        )
    coefficients = _numbers(distortion, "distortion coefficients")
    # OpenCV writes 12 or 14 where thin prism and tilt were not asked for, all zero.
    if len(coefficients) in (12, 14) and not coefficients[8:].any():
        coefficients = coefficients[:8]
    return CameraFields(
        width=width,
        height=height,
        matrix=matrix,
        distortion=coefficients,
        model=_MODELS[model],
        name=name[:200],
        nominal=nominal,
        readout_ms=None if readout is None else float(_numbers([readout], "readout_ms")[0]),
    )


def _first(plain: Data, keys: tuple[str, ...]) -> str | None:
    return next((key for key in keys if plain.get(key) is not None), None)


def _flag(value: Any) -> bool:
    return str(value).lower() in ("1", "true")


def _size(value: Any) -> tuple[int, int]:
    if isinstance(value, dict) and "data" not in value:
        value = [value.get("width"), value.get("height")]
    numbers = _numbers(value, "image size")
    if len(numbers) != 2 or not all(1 <= v <= MAX_SIDE and v == int(v) for v in numbers):
        raise CameraFormatError(
            f"the image size is {value!r}; give width and height as whole numbers of 1 … {MAX_SIDE}"
        )
    return int(numbers[0]), int(numbers[1])


def _matrix(value: Any, place: str) -> Array:
    numbers = _numbers(value, place)
    if len(numbers) != 9:
        raise CameraFormatError(f"{place} has {len(numbers)} numbers; it must be 3 x 3")
    return numbers.reshape(3, 3)


def _numbers(value: Any, place: str) -> Array:
    """A flat vector from a list, nested lists, or ``{rows, cols, data}``."""
    items = value.get("data") if isinstance(value, dict) else value
    if not isinstance(items, list):
        raise CameraFormatError(f"{place} is missing or no list of numbers")
    flat = [v for item in items for v in (item if isinstance(item, list) else [item])]
    try:
        # A text such as "1e-3" is a number to everyone but YAML 1.1.
        numbers = [float(v) for v in flat if not isinstance(v, bool)]
    except (TypeError, ValueError, OverflowError):
        numbers = []
    if len(numbers) != len(flat) or not all(map(math.isfinite, numbers)):
        raise CameraFormatError(f"{place} holds something that is no finite number")
    return np.array(numbers, float)
