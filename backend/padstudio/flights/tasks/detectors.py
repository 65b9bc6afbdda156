"""Detectors from stored texts, kept while the same one is asked for."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import lru_cache
from typing import Any, TypeVar

from padstudio.errors import SpecError, shown
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad
from padstudio.vision.detector import Detector
from padstudio.vision.stage.detection import Method
from padstudio.vision.stage.params import DetectorParams

ParamsT = TypeVar("ParamsT")


@dataclass(frozen=True)
class Recipe:
    """How frames are detected.

    Attributes
    ----------
    pad, camera : str
        The content of a pad file and of a camera file.
    method : {"dense", "paper"}
    params : str
        JSON object as `params_from` takes.
    others : tuple of str
        The content of more pad files: of pads that frames may show as well, or instead.
    """

    pad: str
    camera: str
    method: Method = "dense"
    params: str = "{}"
    others: tuple[str, ...] = ()


# The index of a large pad takes longer to build than a picture to read.
@lru_cache(maxsize=4)
def detector_for(recipe: Recipe) -> Detector:
    """The detector of a recipe; raises as the readers of its files."""
    return Detector(
        [Pad.loads(text) for text in (recipe.pad, *recipe.others)],
        Camera.loads(recipe.camera),
        method=recipe.method,
        params=params_from(json.loads(recipe.params)),
    )


def params_from(values: Mapping[str, Any]) -> DetectorParams:
    """Detector parameters from nested names and values; what is not named keeps its default.

    Parameters
    ----------
    values : mapping
        Such as ``{"refine": {"most_borders": 500}}``.

    Raises
    ------
    SpecError
        If a name is unknown, or a value of the wrong kind or out of range.
    """
    return _changed(DetectorParams(), values, "")


def params_of_words(words: Iterable[str]) -> dict[str, Any]:
    """Nested names and values, as `params_from` takes them, of words such as ``refine.motion=off``.

    Raises
    ------
    SpecError
        If one is no name and value.
    """
    nested: dict[str, Any] = {}
    for word in words:
        name, equals, text = word.partition("=")
        value = _VALUES.get(text.lower())
        if value is None:
            try:
                value = float(text)
            except ValueError:
                value = None
        if not equals or value is None:
            raise SpecError(
                f"{shown(word)} sets no parameter; write NAME=VALUE, as search.least_step=0.4 or "
                "refine.motion=off",
                code="invalid_parameter",
            )
        *groups, own = name.split(".")
        place = nested
        for group in groups:
            place = place.setdefault(group, {})
        place[own] = value
    return nested


_VALUES: dict[str, Any] = {"on": True, "true": True, "off": False, "false": False}


def _changed(params: ParamsT, values: Mapping[str, Any], place: str) -> ParamsT:
    assert is_dataclass(params)
    known = {field.name for field in fields(params)}
    changes: dict[str, Any] = {}
    for name, value in values.items():
        where = f"{place}{name}"
        if name not in known:
            raise SpecError(
                f"there is no parameter {where}; there are {', '.join(sorted(known))}",
                code="invalid_parameter",
            )
        default = getattr(params, name)
        if is_dataclass(default):
            if not isinstance(value, Mapping):
                raise SpecError(f"parameter {where} must be an object", code="invalid_parameter")
            changes[name] = _changed(default, value, f"{where}.")
        else:
            changes[name] = _typed(value, default, where)
    return replace(params, **changes)  # type: ignore[type-var]


def _typed(value: Any, default: Any, where: str) -> Any:
    """A value of its default's type; JSON does not tell 2.0 from 2."""
    kind = type(default)
    if isinstance(value, int | float) and not isinstance(value, bool):
        # Whole numbers of JSON may be beyond what floats reach.
        with suppress(OverflowError):
            number = float(value)
            if kind is float:
                return number
            if kind is int and number.is_integer():
                return int(value)
    if type(value) is kind and kind not in (int, float):
        return value
    raise SpecError(
        f"parameter {where} is {shown(value)}; it must be of type {kind.__name__}",
        code="invalid_parameter",
    )
