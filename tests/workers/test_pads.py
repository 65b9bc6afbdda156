from __future__ import annotations

import json

import pytest

from padstudio.errors import PadFormatError, SpecError
from padstudio.pad.spec import Pad
from padstudio.workers import pads

SPEC = {"rows": 14, "cols": 11, "ratio": 2, "seed": 5, "name": "a"}


def test_generate_gives_file_summary_and_proof() -> None:
    made = pads.generate(SPEC, 30.0)
    pad = Pad.loads(made.content)
    assert (pad.seed, pad.name) == (5, "a")
    assert made.summary["size_mm"] == [110.0, 140.0]
    assert [layer["rows"] for layer in made.summary["layers"]] == [14, 7]
    assert made.verification is not None
    assert made.verification["windows"] == 10 * 7
    assert made.verification["unique_under_rotation"]
    json.dumps([made.summary, made.verification])
    assert pads.generate(SPEC, 30.0) == made


def test_read_gives_the_file_back_in_its_normal_form() -> None:
    made = pads.generate(SPEC, 30.0)
    again = pads.read(json.dumps(json.loads(made.content)).encode())
    assert (again.content, again.summary, again.verification) == (made.content, made.summary, None)


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(SpecError):
        pads.generate(SPEC | {"ratio": 11}, 30.0)
    with pytest.raises(PadFormatError):
        pads.read(b"{}")


def test_with_the_papers_layers_a_tables_upper_left_part_is_the_blue_layer():
    sizes = pads.TableSizes("table", window=2, cell_mm=3, ratio=2, layers="paper")
    made = pads.read(b"0,0,0,1\n0,1,1,1\n1,1,0,1\n0,0,1,1\n", ".csv", sizes)
    assert made.summary["size_mm"] == [12, 12]
    assert [layer["cell_mm"] for layer in made.summary["layers"]] == [3, 6]
    found = pads.verify_content(made.content)
    assert found["unique"] is (made.summary["unique"] is not None)
