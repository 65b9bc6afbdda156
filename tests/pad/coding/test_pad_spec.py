"""Layers of new pads: independent by comparing every window with every other, or the paper's."""

from __future__ import annotations

import hashlib
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from windows import least_apart, lines_visible, nearest_distances

from padstudio.errors import SpecError
from padstudio.pad.coding.generate import FieldSearchError, PadSpec, blue_beside, generate_pad
from padstudio.pad.coding.search.bounds import bounds, check_possible, cuts_first
from padstudio.pad.spec import Pad

KINDS = [
    {"rows": 40, "cols": 50, "distance": 3},
    {"rows": 40, "cols": 50, "distance": 2, "ratio": 3},
    {"rows": 31, "cols": 44, "distance": 4, "ratio": 6, "cell_mm": 3.0},
    {"rows": 44, "cols": 44, "window": 4, "distance": 1, "ratio": 2},
    {"rows": 36, "cols": 25, "window": 4, "levels": 3, "distance": 2, "ratio": 4},
    {"rows": 40, "cols": 33, "window": 3, "levels": 4, "distance": 1, "ratio": 3},
    {"rows": 11, "cols": 11, "window": 3, "distance": 1, "ratio": 3},
    {"rows": 30, "cols": 35, "window": 6, "distance": 5},
    {"rows": 40, "cols": 50, "distance": 1, "unique": "plain"},
    {"rows": 44, "cols": 44, "window": 4, "distance": 1, "unique": "plain", "ratio": 3},
    {
        "rows": 56,
        "cols": 56,
        "window": 3,
        "levels": 3,
        "distance": 1,
        "unique": "plain",
        "ratio": 8,
    },
    {"rows": 40, "cols": 50, "distance": 2, "unique": "plain", "ratio": 4},
    {"rows": 30, "cols": 30, "window": 6, "distance": 2, "unique": "plain", "ratio": 4},
    {"rows": 30, "cols": 40, "distance": 2, "visible_lines": True, "ratio": 4},
    {"rows": 40, "cols": 30, "distance": 1, "method": "growth", "ratio": 4},
    {"rows": 30, "cols": 40, "distance": 1, "unique": "plain", "method": "growth", "ratio": 4},
]


def assert_independent(pad: Pad, spec: PadSpec) -> None:
    red, blue = (layer.field for layer in pad.layers)
    assert blue.shape == (spec.rows // spec.ratio, spec.cols // spec.ratio)
    for field in (red, blue):
        nearest = nearest_distances(field, spec.window, rotation=spec.unique == "rotation")
        assert int(nearest.min()) >= spec.distance
        assert lines_visible(field, spec.window) or not spec.visible_lines
    assert least_apart(red, blue, spec.window) >= spec.distance
    assert pad.layer_fields == "independent"


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: "-".join(map(str, kind.values())))
def test_layers_are_independent(kind: dict[str, object]) -> None:
    spec = PadSpec(**kind)  # type: ignore[arg-type]
    assert_independent(generate_pad(spec), spec)


@settings(max_examples=40, deadline=None)
@given(
    kind=st.fixed_dictionaries(
        {
            "window": st.integers(2, 6),
            "levels": st.sampled_from([2, 2, 3, 4, 9]),
            "distance": st.integers(1, 4),
            "ratio": st.integers(2, 5),
            "unique": st.sampled_from(["rotation", "plain"]),
            "method": st.sampled_from(["auto", "auto", "growth"]),
            "visible_lines": st.booleans(),
            "seed": st.integers(0, 2**63 - 1),
        }
    ),
    extra=st.tuples(st.integers(0, 9), st.integers(0, 9)),
)
def test_any_small_pad_is_independent_or_refused(
    kind: dict[str, int], extra: tuple[int, int]
) -> None:
    rows, cols = (kind["window"] * kind["ratio"] + more for more in extra)
    spec = PadSpec(rows=rows, cols=cols, **kind)  # type: ignore[arg-type]
    try:
        pad = generate_pad(spec, budget_s=0.3)
    except SpecError:
        assert bounds(spec).outlook == "impossible"
    except FieldSearchError:
        return
    else:
        assert_independent(pad, spec)


@pytest.mark.parametrize(
    ("kind", "digest"),
    [
        ({}, "548cb2e604e78ffc"),
        ({"rows": 40, "cols": 52, "ratio": 4, "seed": 9, "distance": 2}, "22c1c0dd719f7f5c"),
        (
            {"rows": 40, "cols": 30, "ratio": 3, "distance": 1, "unique": "plain", "seed": 2},
            "b1f4557f625f7d62",
        ),
        (
            {"rows": 40, "cols": 30, "ratio": 3, "distance": 1, "method": "growth", "seed": 3},
            "018426a35597a11b",
        ),
        (
            {"rows": 30, "cols": 44, "window": 4, "levels": 3, "ratio": 7, "seed": 5},
            "41c1dab8b0636ced",
        ),
    ],
)
def test_the_papers_layers_stay_what_they_were(kind: dict[str, object], digest: str) -> None:
    pad = generate_pad(PadSpec(layers="paper", **kind))  # type: ignore[arg-type]
    red, blue = (layer.field for layer in pad.layers)
    assert np.array_equal(blue, red[: blue.shape[0], : blue.shape[1]])
    assert hashlib.sha256(red.tobytes() + blue.tobytes()).hexdigest()[:16] == digest
    assert pad.layer_fields == "paper"


@pytest.mark.parametrize(
    ("kind", "digest"),
    [
        ({}, "38171db1b8072c66"),
        (
            {"rows": 40, "cols": 30, "ratio": 3, "distance": 1, "unique": "plain"},
            "e4f6ca745d08cd5c",
        ),
        (
            {"rows": 40, "cols": 30, "ratio": 3, "distance": 1, "method": "growth"},
            "54527d4746d4e7b1",
        ),
    ],
)
def test_independent_layers_are_the_same_in_every_version(
    kind: dict[str, object], digest: str
) -> None:
    layers = generate_pad(PadSpec(**kind)).layers  # type: ignore[arg-type]
    fields = b"".join(layer.field.tobytes() for layer in layers)
    assert hashlib.sha256(fields).hexdigest()[:16] == digest


def test_a_single_layer_is_independent_of_nothing() -> None:
    one, other = (
        generate_pad(PadSpec(rows=30, cols=30, ratio=1, layers=layers))  # type: ignore[arg-type]
        for layers in ("independent", "paper")
    )
    assert np.array_equal(one.layers[0].field, other.layers[0].field)
    assert (one.layer_fields, other.layer_fields) == (None, None)


def test_what_only_fits_with_a_shared_code_is_refused_and_says_so() -> None:
    spec = {"rows": 12, "cols": 13, "window": 3, "distance": 1, "ratio": 2}
    with pytest.raises(SpecError, match=r'12 x 13 and 6 x 6 cells need 126 .* layers="paper"'):
        generate_pad(PadSpec(**spec))  # type: ignore[arg-type]
    check_possible(PadSpec(**spec, layers="paper"))  # type: ignore[arg-type]
    # Where the red layer alone is too large, the paper's construction is no way out.
    with pytest.raises(SpecError) as caught:
        generate_pad(PadSpec(**spec | {"cols": 15}))  # type: ignore[arg-type]
    assert "paper" not in caught.value.message


def test_a_search_that_ends_makes_no_pad_that_shares_a_code(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = itertools.count()
    monkeypatch.setattr("padstudio.pad.coding.search.spec.monotonic", lambda: 0.1 * next(clock))
    with pytest.raises(FieldSearchError, match='or layers that share a code, layers="paper"'):
        generate_pad(PadSpec(rows=400, cols=60), budget_s=3.0)


def test_the_bound_counts_the_windows_of_both_layers() -> None:
    found, alone = bounds(PadSpec()), bounds(PadSpec(layers="paper"))
    assert (found.windows_needed, alone.windows_needed) == (121**2 + 21**2, 121**2)
    for each, side in ((found, found.largest_square), (alone, alone.largest_square)):
        assert each.windows_at_most == alone.windows_at_most
        assert (side - 4) ** 2 <= each.windows_at_most < (side - 3) ** 2 * 1.05
    side = found.largest_square
    assert (side - 4) ** 2 + (side // 5 - 4) ** 2 <= found.windows_at_most
    assert (side - 3) ** 2 + ((side + 1) // 5 - 4) ** 2 > found.windows_at_most


def test_a_sequence_is_cut_only_where_it_leaves_room_in_every_turn() -> None:
    plain = {"distance": 1, "unique": "plain"}
    assert cuts_first(PadSpec(rows=1500, cols=1500, **plain))  # type: ignore[arg-type]
    assert not cuts_first(PadSpec(rows=3000, cols=3000, **plain))  # type: ignore[arg-type]
    assert cuts_first(PadSpec(rows=3000, cols=3000, layers="paper", **plain))  # type: ignore[arg-type]


def test_a_blue_layer_beside_a_red_one_from_elsewhere() -> None:
    red = np.random.default_rng(3).integers(0, 3, (40, 33)).astype(np.uint8)
    spec = PadSpec(rows=40, cols=33, window=4, levels=3, distance=3, ratio=4)
    blue = blue_beside(spec, red)
    assert blue.shape == (10, 8)
    assert least_apart(red, blue, 4) >= 3


def test_an_unknown_choice_is_refused_by_name() -> None:
    with pytest.raises(SpecError, match="layers is 'both'") as caught:
        PadSpec(layers="both")  # type: ignore[arg-type]
    assert caught.value.detail == {"field": "layers"}
