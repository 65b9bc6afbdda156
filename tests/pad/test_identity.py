from __future__ import annotations

import dataclasses

from measure_print import make_pad

from padstudio.pad.identity import label_text, pad_id


def test_the_label_tells_id_and_spec() -> None:
    pad = make_pad(20, 25, seed=7, quiet_mm=12.5, cell_mm=2.4)
    spec = "b=3;y=2;q=12.5;s=7;red=20x25x2.4;blue=4x5x12"
    assert label_text(pad) == f"padstudio:1;id={pad_id(pad)};{spec}"


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
