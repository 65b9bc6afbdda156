"""Parameters are checked where they are made."""

import dataclasses

import pytest

from padstudio.errors import SpecError
from padstudio.vision.stage.params import (
    DetectorParams,
    PaperParams,
    PrepareParams,
    RefineParams,
    SearchParams,
)


@pytest.mark.parametrize(
    ("kind", "name", "value"),
    [
        (PrepareParams, "impulse_share", -0.1),
        (PrepareParams, "impulse_share", 1.1),
        (SearchParams, "coarsest_px", 31),
        (SearchParams, "finest_px", 89),
        (SearchParams, "least_edges", 15),
        (SearchParams, "least_order", 0.29),
        (SearchParams, "least_order", float("nan")),
        (RefineParams, "few_borders", 3001),
        (RefineParams, "most_borders", 49),
        (RefineParams, "least_cell_px", 1.9),
        (RefineParams, "align_below_px", -1.0),
        (PaperParams, "blocks", 0),
        (DetectorParams, "log10_false_alarm", -1.9),
        (DetectorParams, "log10_false_alarm", float("nan")),
    ],
)
def test_values_out_of_range_are_refused_by_name(kind, name, value):
    with pytest.raises(SpecError, match=name):
        kind(**{name: value})


@pytest.mark.parametrize(
    "kind", [DetectorParams, PaperParams, PrepareParams, RefineParams, SearchParams]
)
def test_parameters_are_frozen_and_named(kind):
    params = kind()
    name = dataclasses.fields(kind)[0].name
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(params, name, None)
    with pytest.raises(TypeError):
        kind(getattr(params, name))
