"""A parameter's declaration is all that its checks and its listing are made from."""

import re
from dataclasses import dataclass, field, fields, is_dataclass

import pytest

from padstudio.errors import SpecError
from padstudio.vision.stage.parameter import (
    Parameter,
    Scope,
    check,
    parameter,
    parameters_of,
    switch,
    values_at,
)
from padstudio.vision.stage.params import DetectorParams
from padstudio.vision.stage.trace import STAGES


@dataclass(frozen=True, kw_only=True)
class Inner:
    most: int = parameter(30, 10, 100, "px", "The most.", Scope(("edges", "lines"), ("dense",)))
    few: int = parameter(20, 5, "most", "", "Some of them.")


HERE = Scope(("edges", "lines"), ("dense",))


@dataclass(frozen=True, kw_only=True)
class Outer:
    share: float = parameter(0.5, 0.0, 1.0, "share", "A share.")
    on: bool = switch(True, "Do it.")
    inner: Inner = field(default_factory=Inner)


def test_all_parameters_are_listed_in_order():
    assert list(parameters_of(Outer())) == [
        Parameter("share", "", "float", 0.5, 0.0, 1.0, None, None, "share", "A share."),
        Parameter("on", "", "bool", True, 0, 1, None, None, "", "Do it."),
        Parameter("inner.most", "inner", "int", 30, 10, 100, None, None, "px", "The most.", HERE),
        Parameter("inner.few", "inner", "int", 20, 5, 100, None, "most", "", "Some of them."),
    ]


@pytest.mark.parametrize("values", [{"most": 10, "few": 5}, {"most": 100, "few": 100}])
def test_the_ends_of_a_range_belong_to_it(values):
    check(Inner(**values))


@pytest.mark.parametrize(
    ("values", "name"), [({"most": 101}, "most"), ({"few": 31}, "few"), ({"few": 4}, "few")]
)
def test_a_value_out_of_range_is_named(values, name):
    with pytest.raises(SpecError, match=rf"^{name} is"):
        check(Inner(**values))


def test_every_parameter_of_the_detector_is_declared():
    def leaves(group):
        for item in fields(group):
            value = getattr(group, item.name)
            yield from leaves(value) if is_dataclass(value) else (item.name,)

    listed = list(parameters_of(DetectorParams()))
    assert [item.name.rpartition(".")[2] for item in listed] == list(leaves(DetectorParams()))


@pytest.mark.parametrize("item", list(parameters_of(DetectorParams())), ids=lambda item: item.name)
def test_every_parameter_of_the_detector_is_told_in_one_sentence(item):
    assert re.fullmatch(r"[A-Z][^.]*(\.\d[^.]*)*\.", item.text)
    assert item.low <= item.default <= item.high
    assert item.low < item.high


@pytest.mark.parametrize("item", list(parameters_of(DetectorParams())), ids=lambda item: item.name)
def test_every_parameter_of_the_detector_knows_its_stages(item):
    assert item.scope.stages
    assert set(item.scope.stages) <= set(STAGES)


def test_a_stage_sees_the_values_that_name_it():
    assert values_at(Outer(inner=Inner(most=40)), "lines") == ((40,),)
    assert values_at(Outer(), "pose") == ((),)
