"""What is told of a pad beforehand, and fields that come as tables."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from web_server import SMALL_SPEC, running, settings_for
from windows import least_apart

from padstudio.pad.coding.generate import FieldSpec, generate_field
from padstudio.pad.coding.verify import verify_field
from padstudio.pad.spec import Pad

PADS = "/api/v1/pads"
Refused = Callable[..., dict[str, Any]]


def _npy(field: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, field)
    return buffer.getvalue()


def _table(studio: httpx.Client, name: str, content: bytes, **form: Any) -> httpx.Response:
    return studio.post(f"{PADS}/import", files={"file": (name, content)}, data=form)


def test_bounds_of_the_default_pad(studio: httpx.Client) -> None:
    found = studio.post(f"{PADS}/bounds", json={}).raise_for_status().json()
    assert found["windows_needed"] == 121 * 121 + 21 * 21
    paper = studio.post(f"{PADS}/bounds", json={"layers": "paper"}).raise_for_status().json()
    assert paper["windows_needed"] == 121 * 121
    assert found["log10_possible"] == pytest.approx(25 * np.log10(2))
    # A ball of one misread cell holds 26 windows, and each comes in four turns.
    assert 10 ** found["log10_at_most"] == pytest.approx(2**25 // 26 // 4, rel=1e-9)
    assert found["outlook"] == "easy"


def test_bounds_beyond_what_numbers_hold(studio: httpx.Client) -> None:
    spec = {"window": 16, "levels": 36, "rows": 200, "cols": 200, "ratio": 1}
    found = studio.post(f"{PADS}/bounds", json=spec).raise_for_status().json()
    assert found["log10_possible"] == pytest.approx(256 * np.log10(36))
    spec = {"window": 2, "distance": 4, "rows": 9, "cols": 9, "ratio": 1}
    found = studio.post(f"{PADS}/bounds", json=spec).raise_for_status().json()
    assert (found["outlook"], found["log10_at_most"], found["share"]) == ("impossible", None, None)


def test_impossible_pads_are_refused_without_a_worker(tmp_path: Any, refused: Refused) -> None:
    with running(settings_for(tmp_path)) as client:
        error = refused(client.post(PADS, json={"window": 3}), 422, "impossible_spec")
        assert "take at most" in error["message"]
        assert error["detail"]["windows_needed"] == 123 * 123 + 23 * 23
        assert client.get(PADS).json()["total"] == 0


def test_the_default_pad_has_distance_three(studio: httpx.Client) -> None:
    body = studio.post(f"{PADS}/preview", json={"rows": 40, "cols": 40}).raise_for_status().json()
    pad = Pad.from_dict(body["pad"])
    found = verify_field(pad.layers[0].field, 5, 2, distance_limit=3)
    assert (pad.unique, pad.distance) == ("rotation", 3)
    assert found.min_distance_under_rotation >= 3
    assert body["verification"]["channel"] == "red"
    assert body["verification"]["min_distance_under_rotation"] >= 3


@pytest.mark.parametrize("form", ["csv", "npy", "png", "field"])
def test_fields_come_in_from_tables_and_pictures(studio: httpx.Client, form: str) -> None:
    made = studio.post(PADS, json=SMALL_SPEC | {"ratio": 1}).json()
    stored = studio.get(f"{PADS}/{made['id']}/files/pad.json").json()
    field = Pad.from_dict(stored).layers[0].field
    content = {
        "csv": "\n".join(";".join(map(str, row)) for row in field).encode(),
        "npy": _npy(field),
        "png": cv2.imencode(".png", field * 255)[1].tobytes(),
        "field": f"{field.shape[0]} {field.shape[1]}\n".encode()
        + " ".join(map(str, field.ravel())).encode(),
    }[form]
    sizes = {"ratio": 2, "cell_mm": 4, "quiet_mm": 3}
    answer = _table(studio, f"my field.{form}", content, layers="paper", **sizes)
    taken = answer.raise_for_status().json()
    assert (taken["name"], taken["unique"]) == ("my field", "rotation")
    assert taken["distance"] >= 3
    assert [layer["cell_mm"] for layer in taken["layers"]] == [4, 8]
    again = Pad.from_dict(studio.get(f"{PADS}/{taken['id']}").json()["pad"])
    assert np.array_equal(again.layers[0].field, field)
    assert np.array_equal(again.layers[1].field, field[:6, :5])
    assert (taken["layer_fields"], again.layer_fields) == ("paper", "paper")


def test_a_table_gets_a_blue_layer_that_is_independent(studio: httpx.Client) -> None:
    field = generate_field(FieldSpec(rows=30, cols=28, distance=2, seed=9))
    taken = _table(studio, "red.npy", _npy(field), ratio=4, levels=2).raise_for_status().json()
    assert (taken["layer_fields"], taken["unique"]) == ("independent", "rotation")
    red, blue = Pad.from_dict(studio.get(f"{PADS}/{taken['id']}").json()["pad"]).layers
    assert np.array_equal(red.field, field)
    assert blue.field.shape == (7, 7)
    assert least_apart(red.field, blue.field, 5) >= taken["distance"] >= 2
    found = studio.get(f"{PADS}/{taken['id']}/verification").raise_for_status().json()
    assert found["verification"]["layers"] == "independent"
    assert found["verification"]["broken"] == []


def test_a_table_too_small_for_its_ratio_is_refused(studio: httpx.Client, refused: Refused) -> None:
    field = generate_field(FieldSpec(rows=30, cols=28))
    answer = _table(studio, "red.npy", _npy(field), ratio=7, levels=2)
    assert "less than one 5 x 5 window" in refused(answer, 422, "invalid_spec")["message"]


def test_a_field_with_equal_windows_says_so(studio: httpx.Client) -> None:
    taken = _table(studio, "flat.npy", _npy(np.zeros((8, 8), np.uint8)), levels=2).json()
    assert (taken["unique"], taken["distance"]) == (None, None)
    found = studio.get(f"{PADS}/{taken['id']}/verification").raise_for_status().json()
    assert found["verification"]["unique"] is False
    assert found["verification"]["min_distance"] == 0


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.csv", b"0,1\n0", "row 1 has 1 cells"),
        ("a.npy", b"no array", "no NPY array"),
        ("a.png", b"\x89PNG", "no picture"),
        ("a.field", b"2 2 0 1 2 0", "not filled"),
        ("a.exe", b"0", "no field is read from .exe"),
        ("a.csv", b"0,1\n1,0", "hold no 5 x 5 window"),
    ],
)
def test_ill_formed_tables_are_refused_with_the_place(
    studio: httpx.Client, refused: Refused, name: str, content: bytes, says: str
) -> None:
    error = refused(_table(studio, name, content), 422, "invalid_pad_file")
    assert says in error["message"]


def test_weakest_windows_of_a_stored_pad(studio: httpx.Client, pad_id: str) -> None:
    found = studio.get(f"{PADS}/{pad_id}/verification").raise_for_status().json()["verification"]
    assert sum(found["histogram_under_rotation"]) == found["windows"] == 8 * 6
    assert sum(found["level_counts"]) == 12 * 10
    for pair in found["weakest"]:
        assert pair["distance"] >= found["min_distance_under_rotation"] >= 3
