"""Outputs of stages kept from one run to the next over the same frame.

Whoever tunes a parameter runs the detector over one frame again and again. A stage whose inputs
are those of an earlier run gives what it gave then, so that only what depends on the parameter is
computed anew. Stages are pure functions of frozen inputs, which makes that safe: an input is
known by what it holds, or, where it is large, by being the very same object. Of parameters a
stage sees only those that name it (`padstudio.vision.stage.parameter.Scope`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from padstudio.pad.spec import Channel
from padstudio.vision.stage.parameter import values_at
from padstudio.vision.stage.params import Group

# Arrays up to this size are known by their bytes.
_SMALL_BYTES = 4096
# What so many runs in a row did not ask for is dropped.
_KEPT_RUNS = 4
_PLAIN = (type(None), bool, int, float, str, bytes)


@dataclass
class _Kept:
    """An output, and what its key rests on: while that lives no other object has its identity."""

    output: Any
    elapsed_ms: float
    inputs: tuple[Any, ...]
    last_run: int


class Memo:
    """What the stages put out in the last few runs over one frame.

    Attributes
    ----------
    channel : {"red", "green", "blue"} or None
        A trace shows every channel's stages, also those that the result does not need; here those
        of this channel alone, where one is named.
    """

    def __init__(self) -> None:
        self.channel: Channel | None = None
        self._kept: dict[Any, _Kept] = {}
        self._run = 0

    def begin(self) -> None:
        """Begin a run: what the last ones did not ask for goes."""
        self._run += 1
        last = self._run - _KEPT_RUNS
        self._kept = {key: kept for key, kept in self._kept.items() if kept.last_run >= last}

    def find(self, key: Any) -> tuple[Any, float] | None:
        """An output and what it took, ms; None where it was not made yet."""
        kept = self._kept.get(key)
        if kept is None:
            return None
        kept.last_run = self._run
        return kept.output, kept.elapsed_ms

    def keep(self, key: Any, output: Any, elapsed_ms: float, inputs: tuple[Any, ...]) -> None:
        """Keep an output with the inputs of which the key was made."""
        self._kept[key] = _Kept(output, elapsed_ms, inputs, self._run)


def key_of(stage: str, function: Callable[..., Any], args: object) -> Any:
    """What a call of a stage's function depends on, hashable."""
    return stage, _function(function, stage), _key(args, stage)


def _function(function: Callable[..., Any], stage: str) -> Any:
    method = getattr(function, "__func__", None)
    if method is None:
        return function
    return method, _key(getattr(function, "__self__"), stage)  # noqa: B009


def _key(value: Any, stage: str) -> Any:
    if isinstance(value, _PLAIN):
        return value
    if isinstance(value, np.ndarray):
        is_small = value.nbytes <= _SMALL_BYTES
        return (value.shape, value.dtype.str, value.tobytes()) if is_small else id(value)
    if isinstance(value, tuple | list):
        return tuple(_key(item, stage) for item in value)
    if isinstance(value, Mapping):
        return tuple((_key(name, stage), _key(item, stage)) for name, item in value.items())
    if isinstance(value, Group):
        return values_at(value, stage)
    if is_dataclass(value) and getattr(value, "__dataclass_params__").frozen:  # noqa: B009
        held = tuple(_key(getattr(value, item.name), stage) for item in fields(value))
        return type(value), held
    return id(value)
