"""Detector parameters from JSON: taken by name, refused by name."""

from __future__ import annotations

from typing import Any

import flight_orders
import pytest

from padstudio.errors import SpecError
from padstudio.flights.tasks.detectors import Recipe, detector_for, params_from, params_of_words
from padstudio.vision.stage.params import DetectorParams


def test_what_is_not_named_keeps_its_default() -> None:
    assert params_from({}) == DetectorParams()
    changed = params_from({"refine": {"most_borders": 2000.0}, "log10_false_alarm": -9})
    assert changed.refine.most_borders == 2000
    assert changed.log10_false_alarm == -9.0
    assert changed.search == DetectorParams().search


@pytest.mark.parametrize(
    ("values", "match"),
    [
        ({"refin": {}}, "no parameter refin;"),
        ({"refine": {"most": 1}}, "no parameter refine.most;"),
        ({"refine": 3}, "refine must be an object"),
        ({"refine": {"most_borders": 0.5}}, "refine.most_borders is 0.5"),
        ({"refine": {"most_borders": True}}, "refine.most_borders is True"),
        ({"refine": {"motion": 1}}, "refine.motion is 1"),
        ({"log10_false_alarm": "low"}, "log10_false_alarm is 'low'"),
        ({"refine": {"most_borders": 1}}, "most_borders is 1"),
    ],
)
def test_what_is_refused(values: dict[str, Any], match: str) -> None:
    with pytest.raises(SpecError, match=match):
        params_from(values)


def test_a_detector_is_made_once_for_each_recipe() -> None:
    recipe = Recipe(flight_orders.PAD, flight_orders.camera())
    assert detector_for(recipe) is detector_for(Recipe(recipe.pad, recipe.camera))
    other = detector_for(Recipe(recipe.pad, recipe.camera, "paper", '{"log10_false_alarm": -9}'))
    assert (other.method, other.params.log10_false_alarm) == ("paper", -9.0)


def test_parameters_of_words():
    words = [
        "search.least_step=0.4",
        "refine.motion=off",
        "log10_false_alarm=-8",
        "refine.most_borders=500",
    ]
    params = params_from(params_of_words(words))
    assert (params.search.least_step, params.refine.motion) == (0.4, False)
    assert (params.log10_false_alarm, params.refine.most_borders) == (-8.0, 500)


@pytest.mark.parametrize("word", ["search.least_step", "search.least_step=", "x=some", "=", ""])
def test_words_that_set_nothing_are_refused(word):
    with pytest.raises(SpecError, match="sets no parameter"):
        params_of_words([word])
