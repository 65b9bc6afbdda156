"""Fields and pads hold what their spec says, by comparing every window with every other."""

from __future__ import annotations

import hashlib
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from windows import least_apart, lines_visible, nearest_distances

from padstudio.errors import SearchCancelledError, SpecError
from padstudio.pad.coding.generate import (
    FieldSearchError,
    FieldSpec,
    PadSpec,
    any_seed,
    generate_field,
    generate_pad,
)
from padstudio.pad.coding.search.bounds import bounds

SPECS = [
    {"rows": 30, "cols": 45, "window": 5, "distance": 1},
    {"rows": 45, "cols": 30, "window": 5, "distance": 3},
    {"rows": 22, "cols": 22, "window": 5, "distance": 4},
    {"rows": 16, "cols": 16, "window": 5, "distance": 5},
    {"rows": 40, "cols": 40, "window": 5, "distance": 2},
    {"rows": 12, "cols": 12, "window": 3, "distance": 1},
    {"rows": 36, "cols": 40, "window": 4, "distance": 1},
    {"rows": 8, "cols": 9, "window": 4, "distance": 3},
    {"rows": 30, "cols": 30, "window": 3, "levels": 3, "distance": 1},
    {"rows": 6, "cols": 6, "window": 2, "levels": 4, "distance": 1},
    {"rows": 20, "cols": 12, "window": 2, "levels": 16, "distance": 2},
    {"rows": 25, "cols": 30, "window": 6, "distance": 4},
    {"rows": 40, "cols": 40, "window": 6, "distance": 7},
    {"rows": 20, "cols": 20, "window": 8, "levels": 16, "distance": 1},
    {"rows": 40, "cols": 40, "window": 5, "distance": 1, "unique": "plain"},
    {"rows": 40, "cols": 50, "window": 3, "levels": 4, "distance": 1, "unique": "plain"},
    {"rows": 40, "cols": 50, "window": 4, "distance": 2, "unique": "plain"},
    {"rows": 50, "cols": 50, "window": 4, "distance": 1, "unique": "plain"},
    {"rows": 30, "cols": 30, "window": 5, "distance": 2, "visible_lines": True},
    {"rows": 30, "cols": 30, "window": 7, "distance": 1, "visible_lines": True},
    {"rows": 40, "cols": 30, "window": 5, "distance": 1, "method": "growth"},
    {"rows": 30, "cols": 40, "distance": 1, "unique": "plain", "method": "growth"},
    {"rows": 9, "cols": 9, "distance": 3, "method": "growth"},
]


@pytest.mark.parametrize("kind", SPECS, ids=lambda kind: "-".join(map(str, kind.values())))
def test_fields_hold_their_property(kind: dict[str, object]) -> None:
    spec = FieldSpec(**kind)  # type: ignore[arg-type]
    field = generate_field(spec)
    assert field.shape == (spec.rows, spec.cols)
    assert int(field.max()) < spec.levels
    nearest = nearest_distances(field, spec.window, rotation=spec.unique == "rotation")
    assert int(nearest.min()) >= spec.distance
    if spec.visible_lines:
        assert lines_visible(field, spec.window)


@settings(max_examples=25, deadline=None)
@given(
    window=st.integers(2, 6),
    levels=st.integers(2, 6),
    extra_rows=st.integers(0, 8),
    extra_cols=st.integers(0, 8),
    unique=st.sampled_from(["rotation", "plain"]),
    method=st.sampled_from(["auto", "growth"]),
    seed=st.integers(0, 2**40),
)
def test_any_small_spec_is_met_or_refused(
    window: int,
    levels: int,
    extra_rows: int,
    extra_cols: int,
    unique: str,
    method: str,
    seed: int,
) -> None:
    spec = FieldSpec(
        rows=window + extra_rows,
        cols=window + extra_cols,
        window=window,
        levels=levels,
        unique=unique,  # type: ignore[arg-type]
        distance=1,
        method=method,  # type: ignore[arg-type]
        seed=seed,
    )
    try:
        field = generate_field(spec, budget_s=0.3)
    except SpecError:
        assert bounds(spec).outlook == "impossible"
    except FieldSearchError:
        assert bounds(spec).outlook == "long"
    else:
        assert int(nearest_distances(field, window, rotation=unique == "rotation").min()) > 0


@pytest.mark.parametrize(
    ("kind", "digest"),
    [
        ({"rows": 40, "cols": 50}, "bf495e7e2b4d535e"),
        ({"rows": 40, "cols": 50, "distance": 1, "method": "growth"}, "6104d3de1195f938"),
        ({"rows": 40, "cols": 50, "window": 7, "seed": 5}, "3dc1bba073980dda"),
        ({"rows": 92, "cols": 92, "window": 4, "distance": 1}, "b4f916028c59f456"),
        ({"rows": 90, "cols": 80, "distance": 1, "unique": "plain"}, "e8d7d7c36277992a"),
    ],
)
def test_same_spec_and_seed_give_the_same_field_in_every_version(
    kind: dict[str, object], digest: str
) -> None:
    field = generate_field(FieldSpec(**kind))  # type: ignore[arg-type]
    assert hashlib.sha256(field.tobytes()).hexdigest()[:16] == digest


def test_other_seeds_give_other_fields() -> None:
    one, other = (generate_field(FieldSpec(rows=30, cols=30, seed=seed)) for seed in (1, 2))
    assert (one != other).mean() > 0.3


def test_both_levels_are_about_equally_frequent() -> None:
    for method in ("auto", "growth"):
        spec = FieldSpec(rows=100, cols=100, distance=1, method=method)  # type: ignore[arg-type]
        assert 0.45 < generate_field(spec).mean() < 0.55


def test_the_default_pad() -> None:
    pad = generate_pad()
    red, blue = pad.layers
    assert (red.channel, red.field.shape, red.cell_mm) == ("red", (125, 125), 10.0)
    assert (blue.channel, blue.field.shape, blue.cell_mm) == ("blue", (25, 25), 50.0)
    assert least_apart(red.field[:36, :36], blue.field, 5) >= 3
    assert (pad.unique, pad.distance, pad.seed, pad.size_mm) == ("rotation", 3, 1, (1250, 1250))
    assert int(nearest_distances(red.field[:36, :36], 5, rotation=True).min()) >= 3


def test_a_ratio_of_one_makes_one_layer() -> None:
    pad = generate_pad(PadSpec(rows=12, cols=17, ratio=1, quiet_mm=3.0, name="one"))
    assert [layer.channel for layer in pad.layers] == ["red"]
    assert (pad.name, pad.quiet_mm) == ("one", 3.0)


def test_a_drawn_seed_is_kept_and_gives_the_same_pad_again() -> None:
    pad = generate_pad(PadSpec(rows=20, cols=20, ratio=1, seed=any_seed(None)))
    assert pad.seed is not None
    again = generate_pad(PadSpec(rows=20, cols=20, ratio=1, seed=any_seed(pad.seed)))
    assert np.array_equal(pad.layers[0].field, again.layers[0].field)


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ({"window": 1}, "window is 1"),
        ({"window": 40}, "window is 40"),
        ({"levels": 1}, "levels is 1"),
        ({"levels": 99}, "levels is 99"),
        ({"rows": 4}, "rows is 4"),
        ({"rows": 10**6}, "rows is 1000000"),
        ({"distance": 0}, "distance is 0"),
        ({"distance": 26}, "distance is 26"),
        ({"seed": -1}, "seed is -1"),
        ({"ratio": 0}, "ratio is 0"),
        ({"ratio": 30}, "at most 25"),
        ({"unique": "maybe"}, "unique is 'maybe'"),
        ({"method": "luck"}, "method is 'luck'"),
        ({"rows": 4001}, "at most 4000"),
        ({"rows": 13, "cols": 13, "window": 3, "distance": 1, "ratio": 1}, "at most 12 x 12"),
    ],
)
def test_absurd_pads_are_refused_by_name(kind: dict[str, object], words: str) -> None:
    with pytest.raises(SpecError, match=words):
        generate_pad(PadSpec(**kind))  # type: ignore[arg-type]


@pytest.mark.parametrize("method", ["auto", "growth"])
def test_a_spent_budget_ends_with_a_verified_part(
    method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A clock that goes on by 0.1 s at each look: 20 looks, however fast the machine.
    clock = itertools.count()
    monkeypatch.setattr("padstudio.pad.coding.search.spec.monotonic", lambda: 0.1 * next(clock))
    spec = FieldSpec(rows=400, cols=60, distance=3, method=method)  # type: ignore[arg-type]
    with pytest.raises(FieldSearchError) as caught:
        generate_field(spec, budget_s=2.0)
    part = caught.value.field
    assert part is not None
    assert 5 <= part.shape[0] < 400
    assert part.shape[1] == 60
    assert caught.value.detail == {"rows": part.shape[0], "cols": 60}
    assert int(nearest_distances(part[:40], 5, rotation=True).min()) >= 3


@pytest.mark.parametrize("method", ["auto", "growth"])
def test_a_search_reports_progress_and_can_be_cancelled(method: str) -> None:
    shares: list[float] = []
    spec = FieldSpec(rows=900, cols=900, distance=1, method=method)  # type: ignore[arg-type]
    with pytest.raises(SearchCancelledError):
        generate_field(spec, progress=shares.append, cancel=lambda: len(shares) > 2)
    assert len(shares) == 3
    assert all(0 <= share <= 1 for share in shares)
