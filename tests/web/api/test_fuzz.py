"""No request, however odd, brings the server to a fault of its own."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any
from urllib.parse import quote

import fake_analysis
import httpx
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from web_server import PRESET, SMALL_SPEC, running, settings_for

from padstudio.web.schemas.base import PadSpec

ODD = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 12),
    st.integers(),
    st.floats(),
    st.text(max_size=20),
    st.lists(st.integers(0, 3), max_size=3),
)
quick = settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow], database=None
)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    values = settings_for(tmp_path_factory.mktemp("data"), generate_seconds=0.3, max_cells=40)
    with running(values, analyze=fake_analysis.analyze) as client:
        yield client


def _fine(answer: httpx.Response) -> None:
    assert answer.status_code < 500, answer.text
    if answer.status_code >= 400:
        assert set(answer.json()["error"]) == {"code", "message", "detail"}


@quick
@given(changes=st.dictionaries(st.sampled_from([*PadSpec.model_fields, "other"]), ODD, max_size=3))
def test_specs(server: httpx.Client, changes: dict[str, Any]) -> None:
    # The client itself would refuse to write NaN.
    text = json.dumps(SMALL_SPEC | changes)
    headers = {"Content-Type": "application/json"}
    _fine(server.post("/api/v1/pads/preview", content=text, headers=headers))


@quick
@given(
    path=st.sampled_from(["sheets", "coverage", "simulate", "pads/bounds"]),
    body=st.dictionaries(
        st.sampled_from(
            ["pad", "options", "camera", "tilts_deg", "height_mm", "pose", "target_mm", "window"]
        ),
        st.one_of(ODD, st.just(PRESET), st.dictionaries(st.just("layers"), ODD)),
        max_size=4,
    ),
)
def test_plans(server: httpx.Client, path: str, body: dict[str, Any]) -> None:
    headers = {"Content-Type": "application/json"}
    _fine(server.post(f"/api/v1/{path}", content=json.dumps(body), headers=headers))


@quick
@given(
    content=st.binary(max_size=200),
    kind=st.sampled_from(["pads/import", "cameras"]),
    suffix=st.sampled_from(["", ".json", ".csv", ".npy", ".field", ".png"]),
)
def test_files(server: httpx.Client, content: bytes, kind: str, suffix: str) -> None:
    _fine(server.post(f"/api/v1/{kind}", files={"file": (f"a{suffix}", content)}))


@quick
@given(name=st.text(max_size=20), pad=st.text(max_size=10), method=st.text(max_size=6))
def test_forms(server: httpx.Client, name: str, pad: str, method: str) -> None:
    _fine(
        server.post(
            "/api/v1/detect",
            files={"image": (name or "a", b"x")},
            data={"pad": pad, "camera": PRESET, "method": method},
        )
    )


@quick
@given(
    path=st.lists(st.one_of(st.text(max_size=8), st.sampled_from(["pads", "..", "files"]))),
    query=st.dictionaries(st.sampled_from(["limit", "offset", "dpi", "width"]), ODD),
)
def test_addresses(server: httpx.Client, path: list[str], query: dict[str, Any]) -> None:
    address = "/api/v1/" + "/".join(quote(part, safe="") for part in path)
    parameters = {key: str(value).encode("utf-8", "replace") for key, value in query.items()}
    _fine(server.get(address, params=parameters))
