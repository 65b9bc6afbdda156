"""Writes cameras in the forms of other programs, each of which is read back."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.fields import CameraFields

_COLMAP = """\
# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
# pixels as COLMAP counts them: (0.5, 0.5) is the centre of the top-left pixel
"""


def write(camera: CameraFields, form: str) -> str:
    """A camera in one of `FORMS`.

    Raises
    ------
    CameraFormatError
        If the form does not exist, or has no such lens.
    """
    if form not in FORMS:
        raise CameraFormatError(f"cameras are not written as {form!r}; take {', '.join(FORMS)}")
    return FORMS[form](camera)


def ros_yaml(camera: CameraFields) -> str:
    """A camera as ROS ``camera_info`` YAML."""
    model = _ROS_MODELS.get((camera.model, len(camera.distortion)), "plumb_bob")
    projection = np.hstack([camera.matrix, np.zeros((3, 1))])
    lines = [
        f"image_width: {camera.width}",
        f"image_height: {camera.height}",
        f"camera_name: {_quoted(camera.name)}",
        *_own_lines(camera),
        *_matrix_lines("camera_matrix", camera.matrix),
        f"distortion_model: {model}",
        *_matrix_lines("distortion_coefficients", np.array([filled(camera)])),
        *_matrix_lines("rectification_matrix", np.eye(3)),
        *_matrix_lines("projection_matrix", projection),
    ]
    return "\n".join(lines) + "\n"


def opencv_yaml(camera: CameraFields) -> str:
    """A camera as OpenCV's ``FileStorage`` YAML, with the keys of its calibration samples."""
    # OpenCV reads few escapes.
    name = "".join(c if c.isprintable() and c not in '"\\' else " " for c in camera.name)
    lines = [
        "%YAML:1.0",
        "---",
        f"image_width: {camera.width}",
        f"image_height: {camera.height}",
        f'camera_name: "{name}"',
        *(line.replace("true", "1") for line in _own_lines(camera)),
        f"fisheye_model: {int(camera.model == 'fisheye')}",
        *_matrix_lines("camera_matrix", camera.matrix, opencv=True),
        *_matrix_lines("distortion_coefficients", np.array([filled(camera)]).T, opencv=True),
    ]
    return "\n".join(lines) + "\n"


def kalibr_yaml(camera: CameraFields) -> str:
    """A camera as a Kalibr camchain of one, whose topic is its name.

    Raises
    ------
    CameraFormatError
        If its lens has more than Kalibr's four coefficients.
    """
    k = camera.distortion
    if camera.model == "fisheye":
        model, coefficients = "equidistant", filled(camera)
    elif not k.any():
        model, coefficients = "none", []
    elif k[4:].any():
        raise CameraFormatError(
            "Kalibr's radtan has four distortion coefficients, and this lens more; calibrate with "
            "four, or write another form"
        )
    else:
        model, coefficients = "radtan", k[:4].tolist()
    m = camera.matrix
    readout = camera.readout_ms
    lines = [
        "cam0:",
        "  camera_model: pinhole",
        f"  intrinsics: {_list([m[0, 0], m[1, 1], m[0, 2], m[1, 2]])}",
        f"  distortion_model: {model}",
        f"  distortion_coeffs: {_list(coefficients)}",
        f"  resolution: [{camera.width}, {camera.height}]",
        f"  rostopic: {_quoted(camera.name)}",
        *([] if readout is None else [f"  readout_ms: {_number(readout)}"]),
    ]
    return "\n".join(lines) + "\n"


def colmap_text(camera: CameraFields) -> str:
    """A camera as COLMAP's ``cameras.txt``, number 1."""
    return colmap_cameras([camera])


def colmap_cameras(cameras: Sequence[CameraFields]) -> str:
    """COLMAP's ``cameras.txt`` of cameras, numbered from 1."""
    return _COLMAP + "".join(
        f"{number} {_colmap_model(camera)}\n" for number, camera in enumerate(cameras, 1)
    )


def _colmap_model(camera: CameraFields) -> str:
    """COLMAP's model, size and parameters of a camera; its models take OpenCV's coefficients."""
    k = camera.distortion
    if camera.model == "fisheye":
        name, coefficients = "OPENCV_FISHEYE", filled(camera)
    elif not k.any():
        name, coefficients = "PINHOLE", []
    elif not k[4:].any():
        name, coefficients = "OPENCV", k[:4].tolist()
    else:
        name, coefficients = "FULL_OPENCV", [*k.tolist(), 0.0, 0.0, 0.0][:8]
    m = camera.matrix
    values = [m[0, 0], m[1, 1], m[0, 2] + 0.5, m[1, 2] + 0.5, *coefficients]
    numbers = " ".join(repr(float(value)) for value in values)
    return f"{name} {camera.width} {camera.height} {numbers}"


def filled(camera: CameraFields) -> list[float]:
    """The coefficients, filled up with zeros to the four, five or eight that programs expect."""
    coefficients: list[float] = camera.distortion.tolist()
    if camera.model == "fisheye":
        return coefficients or [0.0] * 4
    return coefficients if len(coefficients) == 8 else (coefficients + [0.0] * 5)[:5]


#: Writers by form.
FORMS: dict[str, Callable[[CameraFields], str]] = {
    "ros": ros_yaml,
    "opencv": opencv_yaml,
    "kalibr": kalibr_yaml,
    "colmap": colmap_text,
}
_ROS_MODELS = {
    ("fisheye", 0): "equidistant",
    ("fisheye", 4): "equidistant",
    ("radtan", 8): "rational_polynomial",
}


def _own_lines(camera: CameraFields) -> list[str]:
    """Keys of ours, which other programs pass over."""
    readout = camera.readout_ms
    return [
        *(["nominal: true"] if camera.nominal else []),
        *([] if readout is None else [f"readout_ms: {_number(readout)}"]),
    ]


def _quoted(text: str) -> str:
    import yaml

    return str(yaml.safe_dump(text, default_style='"', width=10_000)).rstrip("\n")


def _matrix_lines(key: str, matrix: Array, *, opencv: bool = False) -> list[str]:
    rows, cols = matrix.shape
    tag, kind = (" !!opencv-matrix", ["   dt: d"]) if opencv else ("", [])
    indent = "   " if opencv else "  "
    return [
        f"{key}:{tag}",
        f"{indent}rows: {rows}",
        f"{indent}cols: {cols}",
        *kind,
        f"{indent}data: {_list(matrix.ravel().tolist())}",
    ]


def _list(values: list[float]) -> str:
    return f"[{', '.join(_number(value) for value in values)}]"


def _number(value: float) -> str:
    # YAML 1.1 wants a point in a number with an exponent; repr leaves it out of "1e-05".
    return re.sub(r"^(-?\d+)e", r"\1.0e", repr(float(value)))
