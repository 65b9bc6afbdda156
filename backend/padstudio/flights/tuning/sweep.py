"""One parameter over several values, on frames of a flight: which are won, which are lost."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from padstudio.flights.tasks.detectors import Recipe
from padstudio.flights.tuning.bench import Subject, detector_of
from padstudio.vision.stage.memo import Memo
from padstudio.workers.inside import checkpoint

Value = int | float | bool


def with_value(params: dict[str, Any], name: str, value: Value) -> dict[str, Any]:
    """Nested parameters with one set, by its name with its group."""
    group, _, own = name.rpartition(".")
    if not group:
        return {**params, own: value}
    return {**params, group: {**params.get(group, {}), own: value}}


def sweep_frame(subject: Subject, recipe: Recipe, name: str, values: Sequence[Value]) -> list[bool]:
    """Whether a frame, read as a still, has a pose under each value.

    Parameters
    ----------
    subject : Subject
    recipe : Recipe
        With the other parameters.
    name : str
        Of the parameter, with its group.
    values : sequence of int, float or bool

    Returns
    -------
    list of bool
        Shorter where the task was told to stop.

    Raises
    ------
    SpecError
        If a value is out of range.
    StudioError
        If the frame cannot be read.
    """
    image, memo, found = subject.read(), Memo(), []
    params = json.loads(recipe.params)
    for value in values:
        if checkpoint():
            break
        one = replace(recipe, params=json.dumps(with_value(params, name, value), sort_keys=True))
        found.append(detector_of(one).detect(image, memo=memo).ok)
    return found
