"""Coverage and advice through the interface, against the library's own figures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import pytest
from web_server import PRESET, SMALL_SPEC, running, settings_for, store_pad

from padstudio.geometry import presets
from padstudio.pad.coverage.advice import Envelope, advise
from padstudio.pad.coverage.dead_bands import dead_bands
from padstudio.pad.coverage.spans import METHOD_LIMITS, coverage
from padstudio.pad.spec import Pad
from padstudio.simulate.success_map import view_of

PADS = "/api/v1/pads"
Refused = Callable[..., dict[str, Any]]
VIEW = view_of(presets.get(PRESET).camera)
TWO_LAYERS = [
    {"channel": "red", "rows": 60, "cols": 60, "cell_mm": 1.0},
    {"channel": "blue", "rows": 20, "cols": 20, "cell_mm": 60.0},
]


def test_the_chart_is_the_librarys(studio: httpx.Client, pad_id: str) -> None:
    pad = Pad.from_dict(studio.get(f"{PADS}/{pad_id}").json()["pad"])
    tilts = [0.0, 25.0, 60.0]
    chart = (
        studio.get(f"{PADS}/{pad_id}/coverage", params={"camera": PRESET, "tilt_deg": tilts})
        .raise_for_status()
        .json()
    )
    assert [each["method"] for each in chart["methods"]] == list(METHOD_LIMITS)
    for each, limits in zip(chart["methods"], METHOD_LIMITS.values(), strict=True):
        spans = coverage(pad, VIEW, limits, tilts)
        assert [(s["layer"], s["tilt_deg"]) for s in each["spans"]] == [
            (s.layer, s.tilt_deg) for s in spans
        ]
        for shown, span in zip(each["spans"], spans, strict=True):
            if span.reads:
                assert shown["low_mm"] == pytest.approx(span.low_mm)
                assert shown["high_mm"] == pytest.approx(span.high_mm)
            else:
                assert (shown["low_mm"], shown["high_mm"]) == (None, None)


def test_sizes_alone_have_a_chart_and_its_dead_bands(studio: httpx.Client) -> None:
    body = {"pad": {"layers": TWO_LAYERS}, "camera": PRESET, "tilts_deg": [0]}
    chart = studio.post("/api/v1/coverage", json=body).raise_for_status().json()
    paper = next(each for each in chart["methods"] if each["method"] == "paper")
    assert len(paper["dead_bands"]) == 2
    assert "blue cells across" in paper["dead_bands"][0]["message"]
    assert "the sign as a whole" in paper["dead_bands"][1]["message"]
    pad = Pad.from_dict(
        {
            "format": "padstudio.pad",
            "version": 1,
            "window": 5,
            "levels": 2,
            "layers": [
                {"channel": la["channel"], "cell_mm": la["cell_mm"], "codes": ["0" * 20] * 20}
                for la in TWO_LAYERS
            ],
        }
    )
    for band, same in zip(
        paper["dead_bands"], dead_bands(pad, VIEW, METHOD_LIMITS["paper"]), strict=True
    ):
        assert (band["low_mm"], band["high_mm"]) == pytest.approx((same.low_mm, same.high_mm))


def test_advice_is_the_librarys(studio: httpx.Client) -> None:
    query = {"camera": PRESET, "low_mm": 100, "high_mm": 6000, "tilt_deg": 10, "reach_mm": 50}
    told = studio.get("/api/v1/advice", params=query).raise_for_status().json()
    own = advise(VIEW, Envelope(100, 6000, 10, 50), limits=METHOD_LIMITS["dense"])
    assert (told["cell_mm"], told["ratio"], told["cells"]) == (own.cell_mm, own.ratio, own.cells)
    assert told["size_mm"] == own.size_mm
    assert told["notes"] == list(own.notes)
    spec = {"rows": told["cells"], "cols": told["cells"], "ratio": told["ratio"]}
    assert studio.post(f"{PADS}/bounds", json=spec).json()["outlook"] != "impossible"


@pytest.mark.parametrize(
    ("query", "status", "code"),
    [
        ({"low_mm": 500, "high_mm": 100}, 422, "invalid_spec"),
        ({"low_mm": 0, "high_mm": 100}, 422, "invalid_request"),
        ({"low_mm": "nan", "high_mm": 100}, 422, "invalid_request"),
        ({"low_mm": 10, "high_mm": 100, "camera": "preset-none"}, 404, "not_found"),
    ],
)
def test_wishes_that_cannot_be_are_refused(
    studio: httpx.Client, refused: Refused, query: dict[str, Any], status: int, code: str
) -> None:
    answer = studio.get("/api/v1/advice", params={"camera": PRESET} | query)
    refused(answer, status, code)


def test_tilts_beyond_the_horizon_are_refused(
    studio: httpx.Client, pad_id: str, refused: Refused
) -> None:
    query = {"camera": PRESET, "tilt_deg": 95}
    answer = studio.get(f"{PADS}/{pad_id}/coverage", params=query)
    assert "at most 89" in refused(answer, 422, "invalid_request")["message"]


def test_a_simulated_map_reads_where_the_chart_says(tmp_path: Path) -> None:
    yaml = (
        "image_width: 320\nimage_height: 240\ncamera_name: small\n"
        "distortion_model: plumb_bob\n"
        "camera_matrix: {rows: 3, cols: 3, data: [300, 0, 159.5, 0, 300, 119.5, 0, 0, 1]}\n"
        "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n"
    )
    with running(settings_for(tmp_path, generate_seconds=30)) as client:
        made = client.post(PADS, json=SMALL_SPEC | {"rows": 40, "cols": 40, "ratio": 1}).json()
        camera = client.post("/api/v1/cameras", files={"file": ("c.yaml", yaml)}).json()["id"]
        body = {"camera": camera, "heights_mm": [300, 30000], "values": [0], "trials": 2}
        found = client.post(f"{PADS}/{made['id']}/coverage", json=body).raise_for_status().json()
    assert found["success"] == [[1.0], [0.0]]
    assert found["wrong"] == [[0.0], [0.0]]


def test_maps_beyond_the_limit_are_refused_at_once(studio: httpx.Client, refused: Refused) -> None:
    made = store_pad(studio)["id"]
    body = {"camera": PRESET, "heights_mm": [500] * 50, "values": [0, 10, 20]}
    answer = studio.post(f"{PADS}/{made}/coverage", json=body)
    error = refused(answer, 413, "too_many_frames")
    assert error["detail"] == {"frames": 150, "limit": 100}
    body = {"camera": PRESET, "heights_mm": [-5], "values": [0]}
    refused(studio.post(f"{PADS}/{made}/coverage", json=body), 422, "invalid_request")
    body = {"camera": PRESET, "heights_mm": [500], "values": [0]}
    refused(studio.post(f"{PADS}/none/coverage", json=body), 404, "not_found")
