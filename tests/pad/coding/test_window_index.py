"""The index finds every window of a field, in every turn, and no other."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from padstudio.errors import SpecError
from padstudio.pad.coding.generate import FieldSpec, generate_field
from padstudio.pad.coding.window_index import Places, WindowIndex


@pytest.fixture(scope="module")
def field() -> NDArray[np.uint8]:
    return generate_field(FieldSpec(rows=50, cols=70, seed=4))


def windows_at(
    field: NDArray[np.uint8], b: int, count: int, *, turned: bool = True
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Windows as a camera may read them, and their true rows, columns and turns."""
    rng = np.random.default_rng(7)
    rows = rng.integers(0, field.shape[0] - b + 1, count)
    cols = rng.integers(0, field.shape[1] - b + 1, count)
    turns = rng.integers(0, 4 if turned else 1, count)
    read = [
        np.rot90(field[r : r + b, c : c + b], -t) for r, c, t in zip(rows, cols, turns, strict=True)
    ]
    return np.stack(read).astype(np.int64), rows, cols, turns


def assert_found(places: Places, rows: object, cols: object, turns: object) -> None:
    np.testing.assert_array_equal(places.rows, rows)
    np.testing.assert_array_equal(places.cols, cols)
    np.testing.assert_array_equal(places.turns, turns)


@pytest.mark.parametrize(
    ("window", "levels"), [(5, 2), (3, 5), (2, 16), (8, 2), (8, 16), (12, 2), (16, 36)]
)
def test_every_window_in_every_turn(window: int, levels: int) -> None:
    side = 10 if window == 2 else 40
    spec = FieldSpec(rows=side, cols=side + 5, window=window, levels=levels, distance=1)
    field = generate_field(spec)
    read, rows, cols, turns = windows_at(field, window, 500)
    assert_found(WindowIndex(field, window, levels).lookup(read), rows, cols, turns)


def test_misread_and_unknown_cells_are_not_found(field: NDArray[np.uint8]) -> None:
    read, *_ = windows_at(field, 5, 400)
    rng = np.random.default_rng(0)
    read[np.arange(400), rng.integers(0, 5, 400), rng.integers(0, 5, 400)] ^= 1
    index = WindowIndex(field, 5, 2)
    assert (index.lookup(read).turns == -1).all()
    read[np.arange(400), rng.integers(0, 5, 400), rng.integers(0, 5, 400)] = -1
    assert (index.lookup(read).rows == -1).all()


def test_foreign_windows_are_not_found(field: NDArray[np.uint8]) -> None:
    index = WindowIndex(field, 5, 2)
    read = np.random.default_rng(1).integers(0, 2, (3000, 5, 5))
    held = {w.tobytes() for w in np.lib.stride_tricks.sliding_window_view(field, (5, 5)).reshape(
        -1, 5, 5
    )}  # fmt: skip
    for window, turn in zip(read, index.lookup(read).turns, strict=True):
        turns = [np.rot90(window, k).astype(np.uint8).tobytes() in held for k in range(4)]
        assert (turn >= 0) == any(turns)


def test_two_places_are_no_answer() -> None:
    field = np.zeros((12, 5), np.uint8)
    field[:5] = field[7:] = np.random.default_rng(0).integers(0, 2, (5, 5))
    assert WindowIndex(field, 5, 2).lookup(field[None, :5]).rows.tolist() == [-1]


def test_a_field_unique_as_it_stands_is_indexed_without_turns() -> None:
    field = generate_field(
        FieldSpec(rows=150, cols=60, window=4, unique="plain", distance=1, seed=2)
    )
    read, rows, cols, _ = windows_at(field, 4, 300, turned=False)
    index = WindowIndex(field, 4, 2, rotation=False)
    assert_found(index.lookup(read), rows, cols, np.zeros(300))


def test_it_takes_eight_bytes_a_window(field: NDArray[np.uint8]) -> None:
    assert WindowIndex(field, 5, 2).nbytes == 8 * 46 * 66


def test_bad_arguments_are_refused(field: NDArray[np.uint8]) -> None:
    with pytest.raises(SpecError, match="no 5 x 5 window"):
        WindowIndex(field[:4], 5, 2)
    with pytest.raises(SpecError, match="not below levels"):
        WindowIndex(field + 1, 5, 2)
    with pytest.raises(SpecError, match="out of range"):
        WindowIndex(field, 1, 2)
    with pytest.raises(SpecError, match="must be"):
        WindowIndex(field, 5, 2).lookup(field[:5, :5])
