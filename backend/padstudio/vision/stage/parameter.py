"""What a parameter is: its default, range, unit and sentence, declared once where it stands.

A group of parameters is a frozen dataclass whose fields are made by `parameter` (or are groups
themselves). `check` holds values to the ranges, and `parameters_of` lists them, so that checks,
sliders and documentation are made from the one declaration.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, TypeVar

from padstudio.errors import SpecError

T = TypeVar("T", int, float, bool)

#: A bound of a range: a number, or the name of a number's parameter in the same group.
Bound = float | str

#: The detector's methods, as of `padstudio.vision.stage.detection.Method`.
METHODS = ("dense", "paper")


@dataclass(frozen=True)
class Scope:
    """Where a parameter counts.

    Attributes
    ----------
    stages : tuple of str
        The stages that look at it, the first one where a reader looks for it: no other is run
        again where it changes.
    methods : tuple of str
    followed : bool
        It counts only where the last frame's pose is followed, never in a still.
    """

    stages: tuple[str, ...] = ()
    methods: tuple[str, ...] = METHODS
    followed: bool = False


_ANYWHERE = Scope()


@dataclass(frozen=True)
class _Declared:
    low: Bound
    high: Bound
    unit: str
    text: str
    scope: Scope


@dataclass(frozen=True)
class Parameter:
    """One parameter as sliders and tables show it.

    Attributes
    ----------
    name : str
        With its groups, as ``refine.most_borders``.
    group : str
        ``refine``; empty for those that stand in no group.
    kind : {"int", "float", "bool"}
    default : int, float or bool
    low, high : float
        The range, ends included; of a bool 0 and 1.
    not_below, not_above : str or None
        The parameter of the same group that bounds it more closely, where one does.
    unit : str
        ``px``, ``cells``, ``degrees``, ``share``, ``log10`` …; empty where it counts things.
    text : str
        One sentence: what it does.
    scope : Scope
    """

    name: str
    group: str
    kind: str
    default: int | float | bool
    low: float
    high: float
    not_below: str | None
    not_above: str | None
    unit: str
    text: str
    scope: Scope = _ANYWHERE


def parameter(
    default: T, low: Bound, high: Bound, unit: str, text: str, scope: Scope = _ANYWHERE
) -> T:
    """A field of a group.

    Parameters
    ----------
    default : int, float or bool
    low, high : float or str
        The range, ends included; a name stands for what that parameter of the group is set to.
    unit, text, scope
        As of `Parameter`.
    """
    return field(default=default, metadata={_Declared: _Declared(low, high, unit, text, scope)})


def switch(default: bool, text: str, scope: Scope = _ANYWHERE) -> bool:
    """A field that is on or off."""
    return parameter(default, 0, 1, "", text, scope)


def values_at(group: Any, stage: str) -> tuple[Any, ...]:
    """What a stage sees of a group and of the groups within it, in the order of declaration."""
    found: list[Any] = []
    for item in fields(group):
        declared: _Declared | None = item.metadata.get(_Declared)
        value = getattr(group, item.name)
        if declared is None:
            found.append(values_at(value, stage))
        elif stage in declared.scope.stages:
            found.append(value)
    return tuple(found)


def check(group: Any) -> None:
    """Hold a group's values to their ranges.

    Raises
    ------
    SpecError
        That names the first value out of its range.
    """
    for item in fields(group):
        declared: _Declared | None = item.metadata.get(_Declared)
        if declared is None:
            continue
        value = getattr(group, item.name)
        low, high = (
            getattr(group, bound) if isinstance(bound, str) else bound
            for bound in (declared.low, declared.high)
        )
        if not low <= value <= high:
            raise SpecError(f"{item.name} is {value}; it must lie within {low} … {high}")


def parameters_of(group: Any, place: str = "") -> Iterator[Parameter]:
    """All parameters of a group and of the groups within it, in the order of their declaration.

    Parameters
    ----------
    group : dataclass instance
        Whose values are told as defaults.
    place : str
        The group's name, empty for the outermost one.
    """
    declared = {item.name: item.metadata.get(_Declared) for item in fields(group)}
    for name, own in declared.items():
        value = getattr(group, name)
        where = f"{place}.{name}" if place else name
        if own is None:
            assert is_dataclass(value)
            yield from parameters_of(value, where)
            continue
        low, not_below = _bound(declared, own.low, "low")
        high, not_above = _bound(declared, own.high, "high")
        kind = type(value).__name__
        yield Parameter(
            where, place, kind, value, low, high, not_below, not_above,
            own.unit, own.text, own.scope,
        )  # fmt: skip


def _bound(
    declared: dict[str, _Declared | None], bound: Bound, end: str
) -> tuple[float, str | None]:
    """A bound as a number, and the parameter that stands for it, where one does."""
    if not isinstance(bound, str):
        return bound, None
    other = declared[bound]
    assert other is not None
    return _bound(declared, getattr(other, end), end)[0], bound
