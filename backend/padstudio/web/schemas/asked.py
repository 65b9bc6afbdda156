"""What all requests have in common: texts are text, numbers are numbers, and true is true."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, field_validator

from padstudio import text
from padstudio.simulate.trajectories import MAX_HEIGHT_MM

# Beyond, floats no longer tell whole numbers apart.
_MOST_WHOLE = 2**53
# Lists and objects in each other.
_DEEPEST = 20
# Python programs write it with a capital.
_FLAGS = {"true": True, "True": True, "false": False, "False": False}


def plain(value: Any) -> Any:
    """A value whose texts, at any depth, are as `padstudio.text.plain` has them.

    Raises
    ------
    ValueError
        If they are not, or values lie deeper in each other than anything that is asked for.
    """
    return _plain_at(value, _DEEPEST)


def _plain_at(value: Any, deeper: int) -> Any:
    if isinstance(value, str):
        return text.plain(value)
    if isinstance(value, list | dict) and not deeper:
        raise ValueError(f"its lists and objects lie more than {_DEEPEST} deep in each other")
    if isinstance(value, list):
        return [_plain_at(item, deeper - 1) for item in value]
    if isinstance(value, dict):
        return {text.plain(key): _plain_at(item, deeper - 1) for key, item in value.items()}
    return value


def _flag(value: Any) -> bool:
    """Of forms and addresses, which hold texts alone."""
    if isinstance(value, bool):
        return value
    if not isinstance(value, str) or value not in _FLAGS:
        raise ValueError("it must be true or false")
    return _FLAGS[value]


#: A text, or texts, in a form or an address.
Text = Annotated[str, BeforeValidator(plain)]
#: True or false in a form or an address; in JSON the models below see to it.
Flag = Annotated[bool, BeforeValidator(_flag)]


class InAddress(BaseModel):
    """What is asked for in an address: numbers, too, are texts there."""

    model_config = ConfigDict(allow_inf_nan=False)

    @field_validator("*", mode="before")
    @classmethod
    def _plain(cls, value: Any) -> Any:
        return plain(value)


class Asked(BaseModel):
    """A request's JSON: unknown fields are refused, and no value is taken for another kind's."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)

    @field_validator("*", mode="before")
    @classmethod
    def _plain(cls, value: Any) -> Any:
        if isinstance(value, float) and value.is_integer() and abs(value) <= _MOST_WHOLE:
            # JSON has one kind of number: 5.0 is whole.
            return int(value)
        return plain(value)


# JSON has no tuples.
NOT_STRICT = Field(strict=False)
#: Millimetres, pixels, mm/s: as far as anything here reaches.
Place = Annotated[float, Field(ge=-1e7, le=1e7)]
Point = Annotated[tuple[Place, Place], NOT_STRICT]
Triple = Annotated[tuple[Place, Place, Place], NOT_STRICT]
#: A camera's lean, degrees.
Tilt = Annotated[float, Field(ge=0, le=89)]
#: Over the pad, mm.
Height = Annotated[float, Field(ge=1, le=MAX_HEIGHT_MM)]
