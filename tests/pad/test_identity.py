from __future__ import annotations

import dataclasses

import pytest
from measure_print import make_pad

from padstudio.errors import PadFormatError
from padstudio.pad.identity import label_text, pad_id, parse_label


def test_label_round_trip() -> None:
    pad = make_pad(20, 25, seed=7, quiet_mm=12.5, cell_mm=2.4)
    label = parse_label(label_text(pad))
    assert label.pad_id == pad_id(pad)
    assert (label.window, label.levels, label.quiet_mm, label.seed) == (3, 2, 12.5, 7)
    assert label.layers == {"red": (20, 25, 2.4), "blue": (4, 5, 12.0)}


def test_id_follows_the_print_alone() -> None:
    pad = make_pad()
    renamed = dataclasses.replace(pad, name="other", quiet_mm=9.0, scale=(0.99, 1.01))
    assert pad_id(renamed) == pad_id(pad)
    field = pad.layers[0].field.copy()
    field[3, 4] ^= 1
    changed = dataclasses.replace(pad.layers[0], field=field)
    assert pad_id(dataclasses.replace(pad, layers=(changed, pad.layers[1]))) != pad_id(pad)
    larger = dataclasses.replace(pad.layers[0], cell_mm=9.0)
    assert pad_id(dataclasses.replace(pad, layers=(larger,))) != pad_id(pad)


@pytest.mark.parametrize(
    "text", ["", "https://example.org", "padstudio:1", "padstudio:1;id=A;b=x;y=2;q=0"]
)
def test_other_codes_are_refused(text: str) -> None:
    with pytest.raises(PadFormatError, match="QR code"):
        parse_label(text)
