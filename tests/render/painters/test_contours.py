from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from padstudio.render.painters.contours import iter_contours


@given(
    mask=arrays.arrays(
        bool, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.booleans()
    )
)
def test_contours_wind_once_round_every_cell_of_the_mask(mask: np.ndarray) -> None:
    winding = np.zeros(mask.shape, int)
    for contour in iter_contours(mask):
        for (row0, col0), (row1, col1) in zip(contour, contour[1:] + contour[:1], strict=True):
            assert (row0 == row1) != (col0 == col1)
            # A side up the page adds a turn round all cells to its right, one down takes it away.
            step = 1 if row1 < row0 else -1
            winding[min(row0, row1) : max(row0, row1), col0:] += step if col0 == col1 else 0
    np.testing.assert_array_equal(winding, mask.astype(int))


@given(
    mask=arrays.arrays(
        bool, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.booleans()
    )
)
def test_contours_turn_at_every_corner(mask: np.ndarray) -> None:
    for contour in iter_contours(mask):
        before, after = contour[-1:] + contour[:-1], contour[1:] + contour[:1]
        for (row0, _), (row1, _), (row2, _) in zip(before, contour, after, strict=True):
            assert (row0 == row1) != (row1 == row2)


def test_cells_that_touch_at_a_corner_are_apart() -> None:
    contours = list(iter_contours(np.eye(3, dtype=bool)))
    assert [len(contour) for contour in contours] == [4, 4, 4]


def test_hole_is_a_contour_of_its_own() -> None:
    mask = np.ones((3, 3), bool)
    mask[1, 1] = False
    assert sorted(len(contour) for contour in iter_contours(mask)) == [4, 4]
