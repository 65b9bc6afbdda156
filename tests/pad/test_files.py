import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from places import FOOTAGE
from plain_texts import plain_texts

from padstudio.errors import PadFormatError
from padstudio.pad import files
from padstudio.pad.spec import CHANNELS, Layer, Pad

FOOTAGE_PAD = FOOTAGE / "pad_a.json"


@st.composite
def pads(draw):
    levels = draw(st.integers(2, 36))
    channels = draw(st.lists(st.sampled_from(CHANNELS), min_size=1, unique=True))
    layers = []
    for channel in channels:
        shape = draw(st.tuples(st.integers(2, 6), st.integers(2, 6)))
        cells = st.integers(0, levels - 1)
        field = [[draw(cells) for _ in range(shape[1])] for _ in range(shape[0])]
        layers.append(Layer(channel, draw(st.floats(0.01, 10_000)), np.array(field)))
    return Pad(
        tuple(layers),
        window=2,
        levels=levels,
        quiet_mm=draw(st.floats(0, 100)),
        name=draw(plain_texts(200)),
        seed=draw(st.none() | st.integers(0, 2**63)),
        method=draw(st.none() | st.just("growth")),
        unique=draw(st.sampled_from([None, "rotation", "plain"])),
        distance=draw(st.none() | st.integers(1, 4)),
        visible_lines=draw(st.booleans()),
        layer_fields=draw(st.sampled_from([None, "independent", "paper"])),
        scale=draw(st.tuples(st.floats(0.5, 2), st.floats(0.5, 2))),
    )


@given(pads())
def test_what_is_written_is_read_back(pad):
    text = pad.dumps()
    back = Pad.loads(text)
    assert back.dumps() == text
    for key in ("window", "levels", "quiet_mm", "name", "seed", "method", "unique", "distance"):
        assert getattr(back, key) == getattr(pad, key)
    assert back.visible_lines == pad.visible_lines
    assert back.layer_fields == pad.layer_fields
    assert back.scale == pad.scale
    for one, other in zip(back.layers, pad.layers, strict=True):
        assert (one.channel, one.cell_mm) == (other.channel, other.cell_mm)
        np.testing.assert_array_equal(one.field, other.field)


def test_save_and_load(tmp_path):
    pad = Pad.load(FOOTAGE_PAD)
    assert (pad.width_mm, pad.height_mm, pad.window, pad.levels) == (1250, 1250, 5, 2)
    pad.save(tmp_path / "pad.json")
    assert Pad.load(tmp_path / "pad.json").dumps() == pad.dumps()


def test_the_blue_layer_of_the_footage_is_the_reds_corner_magnified():
    pad = Pad.load(FOOTAGE_PAD)
    red, blue = pad.layers
    assert blue.cell_mm == 5 * red.cell_mm
    np.testing.assert_array_equal(blue.field, red.field[:25, :25])


def test_digits_of_either_case_are_read():
    np.testing.assert_array_equal(files.from_codes(["0aZ"], "x"), [[0, 10, 35]])


def test_a_scale_for_both_directions():
    assert Pad.from_dict(content(scale=1.01)).scale == (1.01, 1.01)


def content(**values):
    layers = [{"channel": "red", "cell_mm": 10, "codes": ["011", "100", "110"]}]
    return {
        "format": "padstudio.pad",
        "version": 1,
        "window": 2,
        "levels": 2,
        "layers": layers,
    } | values


def layer(**values):
    return {"layers": [content()["layers"][0] | values]}


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"format": "other"}, "format is 'other', not 'padstudio.pad'"),
        ({"version": 2}, "version is 2; this program reads version 1"),
        ({"layers": None}, "layers is missing"),
        ({"layers": [5]}, r"layers\[0\] is no object"),
        ({"window": "5"}, "window is '5'; it must be a whole number"),
        ({"window": True}, "window is True"),
        ({"levels": None}, "levels is None"),
        ({"name": 7}, "name must be a text"),
        ({"name": "x" * 201}, "at most 200 characters"),
        ({"quiet_mm": "wide"}, "quiet_mm is 'wide'; it must be a number"),
        ({"quiet_mm": 10**400}, "quiet_mm is too large"),
        ({"unique": "maybe"}, "unique is 'maybe'"),
        ({"visible_lines": "yes"}, "visible_lines is 'yes'; it must be true or false"),
        ({"scale": [1]}, "scale must be a number, or two"),
        ({"scale": ["1", "1"]}, "scale must be a number, or two"),
        (layer(channel="pink"), "unknown channel 'pink'"),
        (layer(cell_mm=None), r"layers\[0\].cell_mm is None; it must be a number"),
        (layer(codes="011"), r"layers\[0\].codes is missing or no list"),
        (layer(codes=["011", 100]), r"layers\[0\].codes\[1\] is no row of digits"),
        (layer(codes=["011", "10"]), r"layers\[0\].codes\[1\] has 2 cells, row 0 has 3"),
        (layer(codes=["011", "1-0", "110"]), r"codes\[1\], column 1: '-' is no base-36 digit"),
        (layer(codes=["011", "1é0", "110"]), r"codes\[1\] is no row of digits"),
        (layer(codes=["011", "120", "110"]), "row 1, column 1: level 2 is not below levels = 2"),
    ],
)
def test_ill_formed_pads_are_refused_with_the_place(values, message):
    with pytest.raises(PadFormatError, match=message):
        Pad.loads(json.dumps(content(**values)))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "not JSON"),
        (b"\xff\xfe\x00", "not JSON"),
        (b"[" * 200_000, "not JSON"),
        (b"[]", "must hold a JSON object"),
    ],
)
def test_what_is_no_json_object_is_refused(text, message):
    with pytest.raises(PadFormatError, match=message):
        Pad.loads(text)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(PadFormatError, match=r"cannot read gone.json: No such file"):
        Pad.load(tmp_path / "gone.json")


def test_a_file_beyond_the_limit_is_not_read(tmp_path):
    path = tmp_path / "huge.json"
    with path.open("wb") as file:
        file.truncate(files.MAX_BYTES + 1)
    with pytest.raises(PadFormatError, match=r"huge.json: larger than"):
        Pad.load(path)
