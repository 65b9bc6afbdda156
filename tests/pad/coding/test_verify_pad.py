"""What is proved of whole pads: shared, near and independent layers, and broken promises."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from places import FOOTAGE
from windows import least_apart

from padstudio.pad.coding.generate import PadSpec, generate_pad
from padstudio.pad.coding.verify_pad import verify_pad
from padstudio.pad.spec import Layer, Pad

NEW = generate_pad(PadSpec(rows=40, cols=50, ratio=4))


def with_blue(field: np.ndarray) -> Pad:
    return replace(NEW, layers=(NEW.layers[0], Layer("blue", 40.0, field)))


def test_a_new_pad_is_independent() -> None:
    found = verify_pad(NEW)
    (pair,) = found.apart
    assert (found.relation, found.broken) == ("independent", ())
    assert (pair.channels, pair.windows, pair.shared) == (("red", "blue"), 6 * 8, 0)
    truth = least_apart(NEW.layers[0].field, NEW.layers[1].field, 5)
    assert pair.min_distance == min(truth, pair.distance_limit + 1) >= 3


def test_old_pads_are_told_by_their_fields() -> None:
    pad = Pad.load(FOOTAGE / "pad_a.json")
    assert pad.layer_fields is None
    found = verify_pad(pad)
    (pair,) = found.apart
    assert (found.relation, pair.is_corner, pair.min_distance) == ("shared", True, 0)
    assert (pair.shared, pair.windows) == (441, 441)


@pytest.mark.parametrize("turn", range(4))
def test_a_code_is_shared_in_any_turn_and_at_any_place(turn: int) -> None:
    field = np.rot90(NEW.layers[0].field[12:21, 30:39], turn)
    found = verify_pad(with_blue(field))
    (pair,) = found.apart
    assert (pair.relation, pair.shared, pair.is_corner) == ("shared", 25, False)
    assert found.broken == ("the red and blue layers are not independent, but shared",)


def test_layers_nearer_than_the_pad_promises() -> None:
    field = NEW.layers[0].field[3:8, 7:12].copy()
    field[2, 2] ^= 1
    found = verify_pad(with_blue(np.rot90(field)))
    (pair,) = found.apart
    assert (pair.relation, pair.min_distance, pair.shared) == ("near", 1, 0)
    assert verify_pad(replace(with_blue(field), distance=1)).relation == "independent"


def test_each_two_of_three_layers_are_held_against_each_other() -> None:
    green = Layer("green", 20.0, NEW.layers[1].field[1:, 1:])
    found = verify_pad(replace(NEW, layers=(*NEW.layers, green)))
    relations = {pair.channels: pair.relation for pair in found.apart}
    assert relations == {
        ("red", "green"): "independent",
        ("red", "blue"): "independent",
        ("green", "blue"): "shared",
    }
    assert found.relation == "shared"
    assert [channel for channel, _ in found.layers] == ["red", "green", "blue"]


def test_broken_promises_are_named() -> None:
    flat = verify_pad(with_blue(np.zeros((8, 8), np.uint8)))
    assert "a window of the blue layer occurs twice" in flat.broken
    assert verify_pad(replace(NEW, distance=5)).broken[0].endswith("differ in 3 cells only")
    lines = verify_pad(replace(with_blue(np.zeros((8, 8), np.uint8)), visible_lines=True))
    assert "some inner lines of the blue layer are not visible" in lines.broken
    # Who promises nothing breaks nothing.
    silent = replace(with_blue(np.zeros((8, 8), np.uint8)), unique=None, layer_fields=None)
    assert verify_pad(silent).broken == ()


def test_a_single_layer_has_no_relation() -> None:
    found = verify_pad(replace(NEW, layers=NEW.layers[:1]))
    assert (found.relation, found.apart, found.broken) == (None, (), ())


def test_it_goes_into_json() -> None:
    plain = json.loads(json.dumps(verify_pad(NEW).to_dict()))
    assert (plain["channel"], plain["layers"], plain["windows"]) == ("red", "independent", 36 * 46)
    assert plain["others"][0]["channel"] == "blue"
    assert set(plain["apart"][0]) == {
        "channels", "relation", "windows", "shared", "is_corner", "distance_limit", "min_distance",
    }  # fmt: skip
