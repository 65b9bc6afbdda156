"""Numbers of camera files, in the ways in which programs write lists and matrices."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import CameraFormatError

#: The largest side of a calibrated picture, pixels.
MAX_SIDE = 65_536

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_BRACKETS = {"(": ")", "[": "]"}
# What stands in an OpenCV matrix beside its numbers.
_MATRIX_KEYS = {"rows", "cols", "data", "dt", "type", "type_id", "sizes"}


def is_number(value: Any) -> bool:
    """True for a number, or a text that is one."""
    if isinstance(value, str):
        return _NUMBER.fullmatch(value.strip()) is not None
    return isinstance(value, int | float) and not isinstance(value, bool)


def numbers(value: Any, place: str) -> Array:
    """A flat vector of finite numbers.

    Parameters
    ----------
    value : object
        A list, a list of rows, a matrix as OpenCV and ROS write it (``rows``, ``cols``, ``data``),
        or a text of numbers with spaces or commas between them, in brackets or not.
    place : str
        What messages call it.

    Raises
    ------
    CameraFormatError
        If it is none of these, or a matrix has not as many numbers as it says.
    """
    items = value
    if isinstance(value, dict):
        items = _matrix_data(value, place)
    found: list[float] = []
    if not isinstance(items, list | str):
        raise CameraFormatError(f"{place} is missing or no list of numbers")
    _collect(items, found, place, depth=0)
    if isinstance(value, dict):
        _check_count(value, len(found), place)
    return np.array(found, float)


def one_number(value: Any, place: str) -> float:
    """A finite number, or a text that is one."""
    found = numbers([value] if not isinstance(value, list | dict) else value, place)
    if len(found) != 1:
        raise CameraFormatError(f"{place} has {len(found)} numbers; give one")
    return float(found[0])


def matrix_3x3(value: Any, place: str) -> Array:
    """A camera matrix from nine numbers, or from fx, fy, cx and cy by name."""
    if isinstance(value, dict) and set(value) == {"fx", "fy", "cx", "cy"}:
        return pinhole(*(one_number(value[key], key) for key in ("fx", "fy", "cx", "cy")))
    found = numbers(value, place)
    if len(found) != 9:
        raise CameraFormatError(f"{place} has {len(found)} numbers; it must be 3 x 3")
    return found.reshape(3, 3)


def pinhole(fx: float, fy: float, cx: float, cy: float) -> Array:
    """The camera matrix (3, 3) of focal lengths and principal point, pixels."""
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def whole_size(value: Any, place: str) -> tuple[int, int]:
    """Width and height, pixels, from a list or from ``width`` and ``height``."""
    if isinstance(value, dict) and "data" not in value:
        if set(value) == {"w", "h"}:
            value = {"width": value["w"], "height": value["h"]}
        if set(value) != {"width", "height"}:
            raise CameraFormatError(f"{place} has {', '.join(map(str, value))}; give width, height")
        value = [value["width"], value["height"]]
    found = numbers(value, place)
    if len(found) != 2 or not all(1 <= v <= MAX_SIDE and v == int(v) for v in found):
        shown = ", ".join(f"{v:.12g}" for v in found[:4])
        raise CameraFormatError(
            f"the image size is [{shown}]; give width and height as whole numbers of 1 … {MAX_SIDE}"
        )
    return int(found[0]), int(found[1])


def word(value: Any, place: str) -> str:
    """A text."""
    if not isinstance(value, str):
        raise CameraFormatError(f"{place} is missing or no text; give the lens model's name")
    return value


def flag(value: Any, place: str) -> bool:
    """Yes or no."""
    text = str(value).strip().lower() if isinstance(value, str | bool | int | float) else ""
    if text in ("1", "1.0", "true", "yes", "on"):
        return True
    if text in ("0", "0.0", "false", "no", "off", "none"):
        return False
    raise CameraFormatError(f"{place} is neither true nor false; give one of them")


def _matrix_data(value: dict[str, Any], place: str) -> Any:
    unknown = [key for key in value if key not in _MATRIX_KEYS]
    if unknown or "data" not in value:
        raise CameraFormatError(
            f"{place} is missing or no list of numbers; a matrix has rows, cols and data"
            + (f", not {unknown[0]}" if unknown else "")
        )
    return value["data"]


def _check_count(value: dict[str, Any], count: int, place: str) -> None:
    if "sizes" in value:
        said = numbers(value["sizes"], f"{place} sizes")
    elif "rows" in value and "cols" in value:
        said = numbers([value["rows"], value["cols"]], f"{place} rows and cols")
    else:
        return
    if math.prod(said.tolist()) != count:
        shape = " x ".join(f"{v:g}" for v in said)
        raise CameraFormatError(
            f"{place} has {count} numbers and says {shape}; the file was cut or changed by hand"
        )


def _collect(items: Any, found: list[float], place: str, depth: int) -> None:
    if isinstance(items, str):
        items = _words(items)
    if isinstance(items, list) and depth < 3:
        for item in items:
            _collect(item, found, place, depth + 1)
        return
    number = _as_float(items)
    if number is None:
        raise CameraFormatError(f"{place} holds something that is no finite number")
    found.append(number)


def _words(text: str) -> Any:
    """The numbers of a text, or the text where it is something else."""
    inner = text.strip()
    if not inner:
        return None
    if _BRACKETS.get(inner[0]) == inner[-1]:
        inner = inner[1:-1]
    words = inner.replace(",", " ").split()
    if not all(_NUMBER.fullmatch(word) for word in words):
        return None
    return [float(word) for word in words]


def _as_float(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None
