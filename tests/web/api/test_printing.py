"""Files to print, sheets, measured sizes and the test strip, through the interface."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from strip_photo import strip_photo
from web_server import SMALL_SPEC, store_pad

from padstudio.pad.sheets.tiling import SheetOptions, plan_sheets
from padstudio.pad.spec import Pad

PADS = "/api/v1/pads"
Refused = Callable[..., dict[str, Any]]
SIZES = {
    "window": 5,
    "quiet_mm": 10.0,
    "layers": [
        {"channel": "red", "rows": 60, "cols": 40, "cell_mm": 10.0},
        {"channel": "blue", "rows": 12, "cols": 8, "cell_mm": 50.0},
    ],
}


def test_a_stored_pad_and_its_bare_sizes_plan_alike(studio: httpx.Client) -> None:
    spec = {"rows": 60, "cols": 40, "ratio": 5, "quiet_mm": 10, "distance": 1}
    made = studio.post(PADS, json=spec).raise_for_status().json()
    query = {"paper": "A4", "joint": "overlap", "margin_mm": 8}
    stored = studio.get(f"{PADS}/{made['id']}/sheets", params=query).raise_for_status().json()
    body = {"pad": SIZES, "options": query}
    assert studio.post("/api/v1/sheets", json=body).raise_for_status().json() == stored
    pad = Pad.from_dict(studio.get(f"{PADS}/{made['id']}").json()["pad"])
    plan = plan_sheets(pad, SheetOptions(paper="A4", joint="overlap", margin_mm=8))
    assert stored["count"] == len(plan.sheets) == len(stored["sheets"])
    assert stored["x_seams_mm"] == list(plan.x_seams_mm)
    assert stored["page_mm"] == [420.0, 620.0]


def test_own_size_is_one_bare_page_by_default(studio: httpx.Client) -> None:
    plan = studio.post("/api/v1/sheets", json={"pad": SIZES}).raise_for_status().json()
    assert (plan["count"], plan["paper_mm"]) == (1, [420.0, 620.0])
    assert plan["sheets"][0]["at_mm"] == [0, 0]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"paper": "A9"}, "A9"),
        ({"paper": "A4", "margin_mm": 120}, "take smaller margins"),
        ({"paper": "10x10"}, "10"),
        ({"paper": "A4", "joint": "overlap", "overlap_mm": 190}, "smaller overlap"),
    ],
)
def test_papers_that_do_not_do_are_refused(
    studio: httpx.Client, pad_id: str, refused: Refused, options: dict[str, Any], says: str
) -> None:
    body = {"pad": SIZES, "options": options}
    error = refused(studio.post("/api/v1/sheets", json=body), 422, "invalid_spec")
    assert says in error["message"]
    if says != "smaller overlap":  # a pad of one sheet has no joints
        pdf = studio.get(f"{PADS}/{pad_id}/files/pad.pdf", params=options)
        refused(pdf, 422, "invalid_spec")


def test_sizes_that_are_no_pad_are_refused(studio: httpx.Client, refused: Refused) -> None:
    red = SIZES["layers"][0]  # type: ignore[index]
    for layers in ([red, red], [red | {"rows": 4}]):
        body = {"pad": SIZES | {"layers": layers}}
        refused(studio.post("/api/v1/sheets", json=body), 422, "invalid_spec")
    body = {"pad": SIZES | {"layers": [red | {"cell_mm": 0}]}}
    refused(studio.post("/api/v1/sheets", json=body), 422, "invalid_request")


def test_the_tiled_pdf_has_a_page_a_sheet_and_a_map(studio: httpx.Client) -> None:
    spec = SMALL_SPEC | {"cell_mm": 40.0, "quiet_mm": 12, "name": "tiled"}
    made = studio.post(PADS, json=spec).json()
    query = {"paper": "A4", "header": "north", "ink": "cmyk"}
    count = studio.get(f"{PADS}/{made['id']}/sheets", params=query).json()["count"]
    assert count > 1
    for assembly_map in (True, False):
        answer = studio.get(
            f"{PADS}/{made['id']}/files/pad.pdf", params=query | {"assembly_map": assembly_map}
        ).raise_for_status()
        assert answer.headers["content-type"] == "application/pdf"
        assert answer.content.startswith(b"%PDF-")
        assert f"/Count {count + assembly_map}".encode() in answer.content


def test_every_form_is_named_after_the_pad(studio: httpx.Client, pad_id: str) -> None:
    forms = {"dxf": b"  0", "csv": b"PK", "npy": b"PK", "strip.pdf": b"%PDF"}
    for kind, start in forms.items():
        answer = studio.get(f"{PADS}/{pad_id}/files/pad.{kind}").raise_for_status()
        assert answer.content.lstrip()[: len(start.lstrip())] == start.lstrip(), kind
        suffix = {"csv": ".zip", "npy": ".zip", "strip.pdf": "-strip.pdf", "dxf": ".dxf"}[kind]
        name = answer.headers["content-disposition"].split('"')[1]
        assert name == f"small{suffix}"


def test_tables_of_one_layer_or_of_all(studio: httpx.Client, pad_id: str) -> None:
    pad = Pad.from_dict(studio.get(f"{PADS}/{pad_id}").json()["pad"])
    address = f"{PADS}/{pad_id}/files/pad.npy"
    one = studio.get(address, params={"channel": "blue"}).raise_for_status()
    assert np.array_equal(np.load(io.BytesIO(one.content)), pad.layers[1].field)
    both = zipfile.ZipFile(io.BytesIO(studio.get(address).content))
    assert len(both.namelist()) == 2


def test_a_layer_that_is_not_there_is_refused(
    studio: httpx.Client, pad_id: str, refused: Refused
) -> None:
    answer = studio.get(f"{PADS}/{pad_id}/files/pad.csv", params={"channel": "green"})
    assert "no green layer" in refused(answer, 422, "invalid_spec")["message"]


def test_a_measured_size_changes_the_scale_and_not_the_id(studio: httpx.Client) -> None:
    made = store_pad(studio)
    address = f"{PADS}/{made['id']}"
    size = {"x_mm": 199.2, "y_mm": 200.4}
    scaled = studio.put(f"{address}/scale", json=size).raise_for_status().json()
    assert scaled["id"] == made["id"]
    assert scaled["created_at"] == made["created_at"]
    assert scaled["scale"] == pytest.approx([0.996, 1.002])
    assert scaled["size_mm"] == pytest.approx([30 * 0.996, 30 * 1.002])
    full = studio.get(address).json()
    assert full["pad"]["scale"] == pytest.approx([0.996, 1.002])
    assert scaled in studio.get(PADS).json()["items"]
    back = studio.put(f"{address}/scale", json={"x_mm": 200, "y_mm": 200}).json()
    assert back == made


def test_a_measured_size_that_cannot_be_is_refused(studio: httpx.Client, refused: Refused) -> None:
    made = store_pad(studio)
    address = f"{PADS}/{made['id']}/scale"
    error = refused(studio.put(address, json={"x_mm": 20, "y_mm": 200}), 422, "invalid_spec")
    assert "ruler" in error["message"]
    refused(studio.put(address, json={"x_mm": 0, "y_mm": 200}), 422, "invalid_request")
    missing = studio.put(f"{PADS}/none/scale", json={"x_mm": 199, "y_mm": 200})
    refused(missing, 404, "not_found")
    assert studio.get(f"{PADS}/{made['id']}").json()["scale"] == [1, 1]


MIXTURE = [[0.6, 0.02, 0.38], [0.02, 0.9, 0.08], [0.36, 0.04, 0.6]]


def test_a_photo_of_the_strip_is_kept_with_the_pad(studio: httpx.Client, refused: Refused) -> None:
    address = f"{PADS}/{store_pad(studio)['id']}"
    image = {"image": ("strip.png", strip_photo(MIXTURE))}
    only_read = studio.post(f"{address}/crosstalk", files=image, data={"keep": "false"}).json()
    assert not only_read["kept"]
    assert studio.get(address).json()["crosstalk"] is None
    found = studio.post(f"{address}/crosstalk", files=image).raise_for_status().json()
    assert found["kept"]
    assert np.allclose(found["matrix"], MIXTURE, atol=0.02)
    assert found["red_separation"] == pytest.approx(0.6 - 0.38, abs=0.02)
    assert found["warnings"] == []
    stored = studio.get(address).json()
    assert stored["crosstalk"]["matrix"] == stored["pad"]["crosstalk"] == found["matrix"]
    assert stored["crosstalk"]["red_separation"] == pytest.approx(found["red_separation"], abs=0.01)
    back = studio.delete(f"{address}/crosstalk").raise_for_status().json()
    assert back["crosstalk"] is None
    assert "crosstalk" not in studio.get(address).json()["pad"]
    refused(studio.delete(f"{PADS}/none/crosstalk"), 404, "not_found")


@pytest.mark.parametrize(
    ("mixture", "light", "warning"),
    [
        (np.eye(3), 255.0, "overexposed"),
        ([[0.5, 0, 0.5], [0, 1, 0], [0.49, 0, 0.51]], 235.0, "cannot be told apart"),
    ],
)
def test_a_photo_that_is_of_no_use_is_not_kept(
    studio: httpx.Client, mixture: Any, light: float, warning: str
) -> None:
    address = f"{PADS}/{store_pad(studio)['id']}"
    image = {"image": ("strip.png", strip_photo(mixture, light=light))}
    found = studio.post(f"{address}/crosstalk", files=image).raise_for_status().json()
    assert not found["kept"]
    assert any(warning in text for text in found["warnings"])
    assert studio.get(address).json()["crosstalk"] is None


def test_close_colours_are_warned_of_wherever_the_pad_is_shown(studio: httpx.Client) -> None:
    address = f"{PADS}/{store_pad(studio)['id']}"
    close = [[0.55, 0, 0.45], [0, 1, 0], [0.45, 0, 0.55]]
    image = {"image": ("strip.png", strip_photo(close))}
    found = studio.post(f"{address}/crosstalk", files=image).raise_for_status().json()
    assert found["kept"]
    (warning,) = found["warnings"]
    assert "too close: the red layer stands out by 10% of white in its channel and the" in warning
    (stored,) = studio.get(address).json()["crosstalk"]["warnings"]
    assert "too close" in stored


def test_a_picture_without_the_strip_is_refused(
    studio: httpx.Client, pad_id: str, refused: Refused
) -> None:
    blank = cv2.imencode(".png", np.full((100, 100, 3), 200, np.uint8))[1].tobytes()
    answer = studio.post(f"{PADS}/{pad_id}/crosstalk", files={"image": ("a.png", blank)})
    refused(answer, 422, "no_test_strip")
    image = {"image": ("strip.png", strip_photo())}
    refused(studio.post(f"{PADS}/none/crosstalk", files=image), 404, "not_found")
