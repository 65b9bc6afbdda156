"""The REST documentation says what the program does, and leaves nothing out."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from places import DOCS

from padstudio import errors

PAGE = DOCS / "rest.md"
METHODS = ("get", "post", "put", "patch", "delete", "head", "options")


@pytest.fixture(scope="module")
def openapi(studio: httpx.Client) -> dict[str, Any]:
    return dict(studio.get("/api/v1/openapi.json").raise_for_status().json())


def _operations(openapi: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    for path, item in openapi["paths"].items():
        for method in METHODS:
            if method in item:
                yield method.upper(), path, item[method]


def _has_example(openapi: dict[str, Any], content: dict[str, Any]) -> bool:
    for media in content.values():
        reference = media.get("schema", {}).get("$ref", "")
        schema = openapi["components"]["schemas"].get(reference.rsplit("/", 1)[-1], {})
        if media.get("example") or media.get("examples") or schema.get("examples"):
            return True
    return False


def test_every_route_stands_in_the_table_under_its_name(openapi: dict[str, Any]) -> None:
    rows = re.findall(r"^\| `(\w+) (/\S+)` \| `(\w+)` \| .+ \|$", PAGE.read_text(), re.MULTILINE)
    routes = [(method, path, op["operationId"]) for method, path, op in _operations(openapi)]
    assert sorted(rows) == sorted(routes)


def test_operation_ids_are_short_and_unique(openapi: dict[str, Any]) -> None:
    ids = [operation["operationId"] for _, _, operation in _operations(openapi)]
    assert len(set(ids)) == len(ids)
    assert all(re.fullmatch(r"[a-z]+([A-Z][a-z]+)+", name) and len(name) <= 24 for name in ids)


def test_every_route_has_a_summary_an_example_and_the_error_shape(openapi: dict[str, Any]) -> None:
    for method, path, operation in _operations(openapi):
        place = f"{method} {path}"
        assert operation["summary"], place
        if method == "HEAD":
            assert not any("content" in answer for answer in operation["responses"].values())
            continue
        good = [code for code in operation["responses"] if code.startswith("2")]
        contents = [operation["responses"][code].get("content", {}) for code in good]
        assert good == ["204"] or any(_has_example(openapi, c) for c in contents), place
        for code in set(operation["responses"]) - {*good, "304"}:
            schema = operation["responses"][code]["content"]["application/json"]["schema"]
            assert schema["$ref"].endswith("/ErrorBody"), place
        # What stands in front of every route, or can befall it.
        everywhere = {"400", "401", "403", "405", "413", "422", "500", "503", "507"}
        assert everywhere <= set(operation["responses"]), place


def test_every_json_body_has_an_example(openapi: dict[str, Any]) -> None:
    for method, path, operation in _operations(openapi):
        content = operation.get("requestBody", {}).get("content", {})
        if "application/json" in content:
            assert _has_example(openapi, content), f"{method} {path}"


def test_examples_of_bodies_are_accepted(studio: httpx.Client, openapi: dict[str, Any]) -> None:
    example = openapi["components"]["schemas"]["PadSpec"]["examples"][0]
    assert studio.post("/api/v1/pads/preview", json=example).status_code == 200


def test_error_codes_of_the_table_exist() -> None:
    table = PAGE.read_text().split("## Errors")[1].split("## ")[0]
    documented = {
        (int(status), code)
        for status, codes in re.findall(r"^\| (\d{3}) \| (.+?) \|", table, re.MULTILINE)
        for code in re.findall(r"`(\w+)`", codes)
    }
    own = [kind for kind in vars(errors).values() if isinstance(kind, type)]
    known = {(kind.status, kind.code) for kind in own if issubclass(kind, errors.StudioError)}
    for kind in (errors.PadFormatError, errors.LimitError, errors.BusyError, errors.SpecError):
        assert (kind.status, kind.code) in documented
    source = "".join(
        path.read_text() for path in Path(errors.__file__).parent.rglob("*.py") if path.is_file()
    )
    for status, code in documented - known:
        by_http = {400: "bad_request", 405: "method_not_allowed"}.get(status) == code
        assert by_http or f'"{code}"' in source, code


def test_no_address_of_another_host(openapi: dict[str, Any]) -> None:
    assert "://" not in str(openapi["paths"])
    assert "servers" not in openapi


def test_fastapis_own_pages_are_off(studio: httpx.Client) -> None:
    for path in ("/docs", "/redoc", "/openapi.json", "/docs/oauth2-redirect"):
        assert studio.get(path).status_code == 404
