"""The OpenAPI document: what FastAPI says of the routes, made good for generators of clients."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from fastapi import FastAPI, Request
from fastapi.responses import JSONResponse
from starlette.responses import Response

from padstudio.web.server.settings import Settings

_SCHEMES: dict[str, Any] = {
    "bearer": {"type": "http", "scheme": "bearer", "description": "The server's token."},
    "query": {
        "type": "apiKey",
        "in": "query",
        "name": "token",
        "description": "The same in the address.",
    },
}
# How JSON Schema says "bytes", and how clients' generators know it.
_MEDIA, _ANY_BYTES = "contentMediaType", "application/octet-stream"


class DescribedApp(FastAPI):
    """A FastAPI application with a complete OpenAPI document."""

    def __init__(self, **options: Any) -> None:
        self._making = threading.Lock()
        self._document: bytes | None = None
        super().__init__(**options)

    def setup(self) -> None:
        """Serve the document; FastAPI's own route would make it in the event loop."""
        if self.openapi_url:
            self.add_route(self.openapi_url, self._serve_document, include_in_schema=False)

    def _serve_document(self, _: Request) -> Response:
        with self._making:
            if self._document is None:
                self._document = bytes(JSONResponse(self.openapi()).body)
        return Response(self._document, media_type="application/json")

    def openapi(self) -> dict[str, Any]:
        """The document; made once."""
        if self.openapi_schema is None:
            document = super().openapi()
            schemas = document["components"]["schemas"]
            for made_good in (_say_binary, _say_whole, _say_alike):
                _everywhere(document, made_good)
            _leave_null_out(document["paths"], schemas)
            _leave_bodies_out(document["paths"])
            document["components"]["securitySchemes"] = _SCHEMES
            document["security"] = _security(self.state.settings)
        return super().openapi()


def _security(settings: Settings) -> list[dict[str, list[str]]]:
    asked: list[dict[str, list[str]]] = [{name: []} for name in _SCHEMES]
    return asked if settings.token is not None else [*asked, {}]


def _leave_bodies_out(paths: dict[str, Any]) -> None:
    """Answers to HEAD have none."""
    for item in paths.values():
        for answer in item.get("head", {}).get("responses", {}).values():
            answer.pop("content", None)


def _leave_null_out(paths: dict[str, Any], schemas: dict[str, Any]) -> None:
    """Addresses, headers and forms have no null: what is not given is left out."""
    operations = [each for item in paths.values() for each in item.values()]
    parameters = [each for operation in operations for each in operation.get("parameters", ())]
    for parameter in parameters:
        parameter["schema"] = _without_null(parameter["schema"])
    for operation in operations:
        form = operation.get("requestBody", {}).get("content", {}).get("multipart/form-data")
        if form is not None:
            fields = schemas[form["schema"]["$ref"].rpartition("/")[2]]["properties"]
            for name, schema in fields.items():
                fields[name] = _without_null(schema)


def _without_null(schema: dict[str, Any]) -> dict[str, Any]:
    kinds = [kind for kind in schema.get("anyOf", ()) if kind != {"type": "null"}]
    if len(kinds) != 1:
        return schema
    return {**{key: value for key, value in schema.items() if key != "anyOf"}, **kinds[0]}


def _everywhere(node: Any, made_good: Callable[[dict[str, Any]], None]) -> None:
    if isinstance(node, dict):
        made_good(node)
        for value in node.values():
            _everywhere(value, made_good)
    elif isinstance(node, list):
        for value in node:
            _everywhere(value, made_good)


def _say_binary(schema: dict[str, Any]) -> None:
    """Call files what they are called in OpenAPI."""
    if schema.get(_MEDIA) == _ANY_BYTES:
        del schema[_MEDIA]
        schema["format"] = "binary"


def _say_alike(schema: dict[str, Any]) -> None:
    """Pairs and triples are lists of so many of one kind; few generators know tuples."""
    kinds = schema.get("prefixItems")
    if isinstance(kinds, list) and kinds and all(kind == kinds[0] for kind in kinds):
        del schema["prefixItems"]
        schema["items"] = kinds[0]


def _say_whole(schema: dict[str, Any]) -> None:
    """Bounds of whole numbers are whole, too."""
    if schema.get("type") == "integer":
        for bound in ("minimum", "maximum"):
            if isinstance(schema.get(bound), float):
                schema[bound] = int(schema[bound])
