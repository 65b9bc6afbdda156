from __future__ import annotations

import io
import json
import re
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from web_server import SMALL_SPEC, running, settings_for, store_pad

from padstudio.pad.spec import Pad

PADS = "/api/v1/pads"
Refused = Callable[..., dict[str, Any]]


def _file(**changes: Any) -> dict[str, Any]:
    layer = {"channel": "red", "cell_mm": 10.0, "codes": ["001", "011", "110"]}
    base = {"format": "padstudio.pad", "version": 1, "window": 2, "levels": 2, "layers": [layer]}
    return base | changes


def _import(studio: httpx.Client, content: bytes | str) -> httpx.Response:
    return studio.post(f"{PADS}/import", files={"file": ("pad.json", content)})


def test_preview_gives_a_pad_file_and_stores_nothing(studio: httpx.Client) -> None:
    before = studio.get(PADS).json()["total"]
    body = studio.post(f"{PADS}/preview", json=SMALL_SPEC).raise_for_status().json()
    pad = Pad.from_dict(body["pad"])
    assert (pad.name, pad.seed, pad.window) == ("small", 7, 5)
    assert [(layer.rows, layer.cols) for layer in pad.layers] == [(12, 10), (6, 5)]
    assert body["verification"]["windows"] == (12 - 4) * (10 - 4)
    assert (pad.layer_fields, body["verification"]["layers"]) == ("independent", "independent")
    assert studio.get(PADS).json()["total"] == before


def test_same_seed_gives_the_same_pad_and_null_draws_one(studio: httpx.Client) -> None:
    def layers(seed: int | None) -> Any:
        body = studio.post(f"{PADS}/preview", json=SMALL_SPEC | {"seed": seed}).json()
        return body["pad"]["layers"], body["pad"]["seed"]

    assert layers(3) == layers(3)
    assert layers(3)[0] != layers(4)[0]
    drawn = layers(None)
    assert layers(drawn[1]) == drawn


def test_layers_that_share_a_code_are_made_where_asked_for_and_told(studio: httpx.Client) -> None:
    body = studio.post(f"{PADS}/preview", json=SMALL_SPEC | {"layers": "paper"}).json()
    red, blue = Pad.from_dict(body["pad"]).layers
    assert np.array_equal(blue.field, red.field[:6, :5])
    (pair,) = body["verification"]["apart"]
    assert (pair["relation"], pair["is_corner"], pair["shared"]) == ("shared", True, 2)


def test_what_fits_only_with_a_shared_code_is_refused(
    studio: httpx.Client, refused: Refused
) -> None:
    spec = {"rows": 12, "cols": 13, "window": 3, "distance": 1, "ratio": 2}
    error = refused(studio.post(f"{PADS}/preview", json=spec), 422, "impossible_spec")
    assert 'layers="paper"' in error["message"]


def test_create_list_get_delete(studio: httpx.Client, refused: Refused) -> None:
    answer = studio.post(PADS, json=SMALL_SPEC | {"quiet_mm": 4.0, "name": "Höhe 漢 \U0001f681"})
    assert answer.status_code == 201
    made = answer.json()
    assert made["size_mm"] == [100.0, 120.0]
    assert made["layers"][1] == {"channel": "blue", "rows": 6, "cols": 5, "cell_mm": 20.0}
    listed = studio.get(PADS, params={"limit": 1}).json()
    assert listed["items"] == [made]
    full = studio.get(f"{PADS}/{made['id']}").json()
    assert full.pop("pad")["name"] == "Höhe 漢 \U0001f681"
    assert full == made
    assert studio.delete(f"{PADS}/{made['id']}").status_code == 204
    refused(studio.get(f"{PADS}/{made['id']}"), 404, "not_found")
    refused(studio.delete(f"{PADS}/{made['id']}"), 404, "not_found")


def test_list_pages(studio: httpx.Client) -> None:
    specs = [{**SMALL_SPEC, "name": f"page {number}"} for number in range(3)]
    ids = [studio.post(PADS, json=spec).json()["id"] for spec in specs]
    pages = [studio.get(PADS, params={"limit": 2, "offset": offset}).json() for offset in (0, 2)]
    assert [item["id"] for item in pages[0]["items"]] == ids[:0:-1]
    assert pages[1]["items"][0]["id"] == ids[0]


def test_import_keeps_every_property(studio: httpx.Client) -> None:
    data = _file(name="own", scale=[1.002, 0.998], unique="plain", distance=1, seed=10**25)
    made = _import(studio, json.dumps(data)).raise_for_status().json()
    assert (made["seed"], made["unique"]) == (10**25, "plain")
    assert made["size_mm"] == pytest.approx([30.06, 29.94])
    stored = studio.get(f"{PADS}/{made['id']}/files/pad.json")
    assert Pad.from_dict(stored.json()).scale == (1.002, 0.998)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (json.dumps(_file(layers=[_file()["layers"][0] | {"codes": ["001", "01"]}])), "row 0 has"),
        (json.dumps(_file(layers=[_file()["layers"][0] | {"codes": ["002", "011"]}])), "level 2"),
        (json.dumps(_file(format="other")), "no pad file"),
        ("[" * 100_000, "not JSON"),
        (b"\xff\xfe\x00", "not JSON"),
        ("", "not JSON"),
    ],
)
def test_ill_formed_pad_files_are_refused_with_the_place(
    studio: httpx.Client, refused: Refused, content: bytes | str, says: str
) -> None:
    before = studio.get(PADS).json()["total"]
    error = refused(_import(studio, content), 422, "invalid_pad_file")
    assert says in error["message"]
    assert studio.get(PADS).json()["total"] == before


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"window": 40}, "window is 40; it must be at most 16"),
        ({"rows": 10**6, "cols": 10**6}, "rows is 1000000; it must be at most 4000"),
        ({"levels": 1}, "levels is 1; it must be at least 2"),
        ({"cell_mm": 0}, "cell_mm is 0; it must be at least 0.01"),
        ({"unique": "never"}, "unique is 'never'; it must be 'rotation' or 'plain'"),
        ({"windows": 5}, "there is no such field"),
        ({"rows": 7.5}, "it must be a whole number"),
        ({"name": 3}, "it must be a text"),
    ],
)
def test_absurd_specs_are_refused_before_any_work(
    studio: httpx.Client, refused: Refused, changes: dict[str, Any], says: str
) -> None:
    for path in (PADS, f"{PADS}/preview"):
        error = refused(studio.post(path, json=SMALL_SPEC | changes), 422, "invalid_request")
        assert says in error["message"]


@pytest.mark.parametrize("text", ['{"cell_mm": NaN}', '{"cell_mm": 1e999}', '{"seed": 1e400}'])
def test_numbers_that_are_none_are_refused(
    studio: httpx.Client, refused: Refused, text: str
) -> None:
    answer = studio.post(PADS, content=text, headers={"Content-Type": "application/json"})
    refused(answer, 422, "invalid_request")


def test_a_ratio_that_leaves_no_blue_window_is_refused(
    studio: httpx.Client, refused: Refused
) -> None:
    error = refused(studio.post(PADS, json=SMALL_SPEC | {"ratio": 9}), 422, "invalid_spec")
    assert "ratio" in error["message"]


def test_files_are_attachments_named_after_the_pad(studio: httpx.Client) -> None:
    made = studio.post(PADS, json=SMALL_SPEC | {"name": 'a"b/../ü'}).json()
    starts = {"json": b"{", "pdf": b"%PDF-", "svg": b"<", "png": b"\x89PNG"}
    for kind, start in starts.items():
        answer = studio.get(f"{PADS}/{made['id']}/files/pad.{kind}").raise_for_status()
        assert answer.content.startswith(start)
        disposition = answer.headers["content-disposition"]
        plain = re.fullmatch(r"attachment; filename=\"([^\"]*)\"; filename\*=.*", disposition)
        assert plain is not None
        assert plain[1] == f"a_b_____.{kind}"
        assert "sandbox" not in disposition
        assert answer.headers["x-content-type-options"] == "nosniff"


def test_png_is_true_to_scale(studio: httpx.Client, pad_id: str) -> None:
    answer = studio.get(f"{PADS}/{pad_id}/files/pad.png", params={"dpi": 50.8})
    image = cv2.imdecode(np.frombuffer(answer.content, np.uint8), cv2.IMREAD_COLOR)
    assert image.shape == (240, 200, 3)  # 120 mm x 100 mm at 2 pixels a millimetre


def test_a_png_beyond_the_limit_is_refused(tmp_path: Path, refused: Refused) -> None:
    with running(settings_for(tmp_path / "data", max_paint_pixels=10_000)) as client:
        made = store_pad(client)["id"]
        error = refused(
            client.get(f"{PADS}/{made}/files/pad.png", params={"dpi": 400}), 413, "too_many_pixels"
        )
        assert "dpi" in error["message"]
        assert not list((tmp_path / "data" / "work").iterdir())


def test_no_other_files(studio: httpx.Client, pad_id: str, refused: Refused) -> None:
    refused(studio.get(f"{PADS}/{pad_id}/files/pad.exe"), 422, "invalid_request")
    refused(studio.get(f"{PADS}/{pad_id}/files/pad.png?dpi=0"), 422, "invalid_request")
    refused(studio.get(f"{PADS}/..%2f..%2fetc/files/pad.json"), 404, "not_found")
    refused(studio.get(f"{PADS}/a.b"), 422, "invalid_request")


def test_the_server_answers_while_a_pad_is_generated(tmp_path: Path, refused: Refused) -> None:
    # So near the number of windows that there are that no search ends.
    hard = {"window": 4, "rows": 125, "cols": 125, "ratio": 1, "unique": "rotation", "distance": 1}
    settings = settings_for(tmp_path, generate_seconds=2.0, max_waiting=0)
    with running(settings) as client, ThreadPoolExecutor(2) as pool:
        asked = [pool.submit(client.post, f"{PADS}/preview", json=hard) for _ in range(2)]
        while not all(answer.done() for answer in asked):
            client.get("/api/v1/health").raise_for_status()
            time.sleep(0.01)
        # Whichever came first is worked on.
        searched, busy = sorted((a.result() for a in asked), key=lambda a: int(a.status_code))
        refused(searched, 422, "search_exhausted")
        error = refused(busy, 503, "busy")
        assert "again" in error["message"]
        assert busy.headers["retry-after"] == "5"
        assert client.get(PADS).json()["total"] == 0


def test_pads_survive_a_restart(tmp_path: Path) -> None:
    with running(settings_for(tmp_path)) as client:
        made = store_pad(client)
        full = client.get(f"{PADS}/{made['id']}").json()
    with running(settings_for(tmp_path)) as client:
        assert client.get(PADS).json() == {"items": [made], "total": 1}
        assert client.get(f"{PADS}/{made['id']}").json() == full
        assert io.BytesIO(client.get(f"{PADS}/{made['id']}/files/pad.pdf").content).read(4)
