import numpy as np
import pytest

from padstudio.errors import PadFormatError
from padstudio.pad.spec import Layer, Pad

FIELD = np.array([[0, 1, 0], [1, 1, 0]])


def pad(**values):
    layers = (Layer("red", 10, FIELD), Layer("blue", 50, FIELD[:, :2]))
    return Pad(**{"layers": layers, "window": 2} | values)


def test_sizes():
    made = pad(quiet_mm=7, scale=(1.1, 0.9))
    assert (made.layers[0].rows, made.layers[0].cols) == (2, 3)
    assert (made.layers[0].width_mm, made.layers[0].height_mm) == (30, 20)
    assert (made.width_mm, made.height_mm) == (100, 100)
    assert made.size_mm == pytest.approx((110, 90))


def test_layers_by_channel():
    made = pad()
    assert made.layer("blue") is made.layers[1]
    assert made.layer("green") is None


def test_a_field_is_a_copy_that_cannot_be_changed():
    source = FIELD.astype(np.uint8)
    layer = Layer("red", 10, source)
    source[0, 0] = 1
    assert layer.field[0, 0] == 0
    with pytest.raises(ValueError, match="read-only"):
        layer.field[0, 0] = 1


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"channel": "magenta"}, "unknown channel 'magenta'; use red, green, blue"),
        ({"cell_mm": 0}, "cell_mm is 0"),
        ({"cell_mm": float("nan")}, "cell_mm is nan"),
        ({"cell_mm": 10_001}, "0.01 … 10000 mm"),
        ({"field": np.zeros(5)}, "rows and columns"),
        ({"field": np.zeros((0, 5))}, "rows and columns"),
        ({"field": np.zeros((4001, 5))}, "4001 x 5 cells; the limit is 4000 a side"),
    ],
)
def test_impossible_layers_are_refused(values, message):
    with pytest.raises(PadFormatError, match=message):
        Layer(**{"channel": "red", "cell_mm": 10, "field": FIELD} | values)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"layers": ()}, "has no layers"),
        ({"layers": [Layer("red", 1, FIELD)] * 2}, "two layers share a channel"),
        ({"window": 1}, "window is 1; it must be 2 … 16"),
        ({"window": 17}, "window is 17"),
        ({"window": 3}, "red layer: 2 x 3 cells hold no 3 x 3 window"),
        ({"levels": 1}, "levels is 1; it must be 2 … 36"),
        ({"levels": 37}, "levels is 37"),
        ({"layers": [Layer("red", 1, 2 * FIELD)]}, "row 0, column 1: level 2 is not below"),
        ({"quiet_mm": -1}, "quiet_mm is -1"),
        ({"quiet_mm": float("inf")}, "quiet_mm is inf"),
        ({"scale": (1, 2.5)}, r"scale is \(1, 2.5\)"),
        ({"scale": (float("nan"), 1)}, "scale is"),
    ],
)
def test_impossible_pads_are_refused(values, message):
    with pytest.raises(PadFormatError, match=message):
        pad(**values)
