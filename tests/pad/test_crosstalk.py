import json

import numpy as np
import pytest

from padstudio.errors import PadFormatError
from padstudio.pad.crosstalk import check_matrix, separation, separation_warnings
from padstudio.pad.spec import Layer, Pad

MATRIX = ((0.62, 0.14, 0.09), (0.06, 0.70, 0.10), (0.12, 0.17, 0.55))


@pytest.fixture
def pad():
    return Pad(layers=(Layer("red", 10.0, np.eye(6, dtype=np.uint8)),))


def test_the_pad_file_keeps_it_and_forgets_it(pad):
    mixed = pad.with_crosstalk(np.array(MATRIX))
    assert mixed.crosstalk == MATRIX
    assert Pad.loads(mixed.dumps()).crosstalk == MATRIX
    assert mixed.with_crosstalk(None).dumps() == pad.dumps()
    assert "crosstalk" not in pad.to_dict()


@pytest.mark.parametrize(
    "matrix",
    [
        "red",
        {"matrix": 1},
        [[1, 0], [0, 1]],
        [[1, 0, 0], [0, 1, 0], [0, 0]],
        [[None, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[1e300, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[10**400, 0, 0], [0, 1, 0], [0, 0, 1]],
        # Red and blue alike, and a white that no light gives.
        [[0.5, 0, 0.5], [0, 1, 0], [0.5, 0, 0.5]],
        [[1, 0, 3], [0, 1, 0], [0, 0, 1]],
    ],
)
def test_what_cannot_be_undone_is_refused(pad, matrix):
    data = pad.to_dict() | {"crosstalk": matrix}
    with pytest.raises(PadFormatError, match="crosstalk"):
        Pad.loads(json.dumps(data))


def test_separation_is_what_the_layer_gives_less_what_the_other_adds():
    red, blue = separation(check_matrix(MATRIX))
    assert red == pytest.approx(0.62 - 0.09)
    assert blue == pytest.approx(0.55 - 0.12)
    assert separation_warnings(red, blue) == []
    close = [[0.30, 0.05, 0.22], [0.05, 0.70, 0.05], [0.15, 0.05, 0.33]]
    (warning,) = separation_warnings(*separation(check_matrix(close)))
    assert "the red layer stands out by 8% of white" in warning
