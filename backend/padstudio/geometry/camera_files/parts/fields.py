"""What a camera file says, whatever its form, and what the user says beside it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Literal, NamedTuple, TypeVar

from padstudio.arrays import Array
from padstudio.errors import CameraFormatError, shown
from padstudio.geometry.camera_files.parts.values import one_number, whole_size

Data = Mapping[str, Any]
LensModel = Literal["radtan", "fisheye"]
ItemT = TypeVar("ItemT")

# No lens sits so near a picture's corner, as parts of its sides; numbers in other units do.
_CORNER = 0.1
# Characters of a message's beginning and end that are told.
_HALF = 280

#: Code of the refusal of a file of several cameras, of which none was chosen.
SEVERAL = "several_cameras"


class Asked(NamedTuple):
    """What the user says of a camera file.

    Attributes
    ----------
    no_distortion : bool
        The lens has none, where the file is silent.
    which : str or None
        Of a file of several cameras, the one that is meant.
    """

    no_distortion: bool = False
    which: str | None = None


class CameraFields(NamedTuple):
    """What a file says of a camera, in the order and meaning of `Camera`'s attributes."""

    width: int
    height: int
    matrix: Array
    distortion: Array
    model: LensModel
    name: str
    nominal: bool = False
    readout_ms: float | None = None
    notes: tuple[str, ...] = ()


class LensFields(NamedTuple):
    """A lens model and its coefficients, as of `Camera`."""

    model: LensModel
    coefficients: Array


def camera_fields(
    size: Any,
    matrix: Array,
    lens: LensFields,
    name: str,
    *,
    nominal: bool = False,
    readout: Any = None,
) -> CameraFields:
    """Fields of a camera, if they go together.

    Raises
    ------
    CameraFormatError
        If the matrix is zero, has skew or is not in pixels from the picture's corner, or its
        principal point lies outside the picture.
    """
    width, height = whole_size(size, "image size")
    if not matrix.any():
        raise CameraFormatError("the camera matrix is all 0: the camera was never calibrated")
    if matrix[0, 1] or matrix[1, 0]:
        raise CameraFormatError("the camera matrix has skew; calibrate without it")
    if not (-0.5 <= matrix[0, 2] < width and -0.5 <= matrix[1, 2] < height):
        raise CameraFormatError(
            f"the principal point ({matrix[0, 2]:g}, {matrix[1, 2]:g}) lies outside the picture of "
            f"{width} x {height}; matrix and size are not of one calibration"
        )
    off_x, off_y = abs(matrix[0, 2] / width - 0.5), abs(matrix[1, 2] / height - 0.5)
    if min(off_x, off_y) > 0.5 - _CORNER:
        raise CameraFormatError(
            f"the principal point ({matrix[0, 2]:g}, {matrix[1, 2]:g}) is in a corner of "
            f"{width} x {height}: it is in millimetres, over the picture's size, or counted from "
            "elsewhere. Give the camera's lengths in pixels, as its program writes them"
        )
    return CameraFields(
        width=width,
        height=height,
        matrix=matrix,
        distortion=lens.coefficients,
        model=lens.model,
        name=name[:200],
        nominal=nominal,
        readout_ms=None if readout is None else one_number(readout, "readout_ms"),
    )


def choose(cameras: Mapping[str, ItemT], asked: Asked) -> tuple[str, ItemT]:
    """The camera that is meant, of one file's, by name.

    Raises
    ------
    CameraFormatError
        ``several_cameras`` if none was chosen of several; also if there is none of that name.
    """
    names = ", ".join(list(cameras)[:20])
    if asked.which is not None:
        if asked.which not in cameras:
            raise CameraFormatError(f"holds no camera {shown(asked.which)}; it holds {names}")
        return asked.which, cameras[asked.which]
    if len(cameras) > 1:
        raise CameraFormatError(
            f"holds {len(cameras)} cameras ({names}); choose one: FILE#{next(iter(cameras))} on "
            "the command line, camera in REST, Which camera on the Cameras page",
            code=SEVERAL,
            detail={"cameras": list(cameras)[:1000]},
        )
    return next(iter(cameras.items()))


def refuse_choice(asked: Asked) -> None:
    """Refuse a choice of camera where a file's form holds one without a name."""
    if asked.which is not None:
        raise CameraFormatError(f"holds one camera; leave out the choice of {shown(asked.which)}")


@contextmanager
def naming(name: str) -> Iterator[None]:
    """Lets messages of camera errors start with a file's name, and repeat little of the file."""
    try:
        yield
    except CameraFormatError as error:
        raise CameraFormatError(
            f"{name}: {_in_short(error.message)}", code=error.error_code, detail=error.detail
        ) from error


def _in_short(message: str) -> str:
    """A sentence without its middle, where that repeats a whole file; its end says what to do."""
    return message if len(message) <= 2 * _HALF else f"{message[:_HALF]} … {message[-_HALF:]}"
