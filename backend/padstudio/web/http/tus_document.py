"""What the OpenAPI document says of uploads: the protocol's headers and bodies.

FastAPI does not see them, as the protocol has statuses of its own for what is wrong with them.
"""

from __future__ import annotations

from typing import Any

from padstudio.store.uploads.files import CHECKSUMS
from padstudio.web.http import tus

_BYTES_COUNT: dict[str, Any] = {"type": "integer", "minimum": 0, "maximum": 2**53}
# Pairs of a name and base64 behind commas, as tus has them.
_METADATA = {
    "type": "string",
    "maxLength": tus.MAX_METADATA,
    "pattern": r"^$|^[a-z0-9]+ ([A-Za-z0-9+/]{4})*$",
}
_CHECKSUM = {
    "type": "string",
    "pattern": rf"^({'|'.join(CHECKSUMS)}) [A-Za-z0-9+/]{{26,43}}={{1,2}}$",
}


def _parameter(
    name: str, schema: dict[str, Any], description: str, *, required: bool = False
) -> dict[str, Any]:
    place = {"name": name, "in": "header", "required": required}
    return {**place, "schema": schema, "description": description}


_RESUMABLE = _parameter(
    "Tus-Resumable",
    {"type": "string", "enum": [tus.VERSION]},
    "The protocol's version.",
    required=True,
)
_SUM = _parameter("Upload-Checksum", _CHECKSUM, "Algorithm and base64 of the body's hash.")


def _bytes_of(*parameters: dict[str, Any], required: bool) -> dict[str, Any]:
    content = {tus.MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}}
    body = {"content": content, "required": required}
    return {"parameters": list(parameters), "requestBody": body}


#: Of the operations, by what they do.
CREATE = _bytes_of(
    _RESUMABLE,
    _parameter("Upload-Length", _BYTES_COUNT, "Bytes of the whole file.", required=True),
    _parameter(
        "Upload-Metadata",
        _METADATA,
        "Names and values in base64, between commas: `filename`, and `sha256` of the whole file.",
    ),
    _SUM,
    required=False,
)
APPEND = _bytes_of(
    _RESUMABLE,
    _parameter("Upload-Offset", _BYTES_COUNT, "Where these bytes begin.", required=True),
    _SUM,
    required=True,
)
ASK = {"parameters": [_RESUMABLE]}
OVERRIDE = _bytes_of(
    _RESUMABLE,
    _parameter(
        "X-HTTP-Method-Override",
        {"type": "string", "enum": ["PATCH", "DELETE"]},
        "What is meant.",
        required=True,
    ),
    _parameter("Upload-Offset", _BYTES_COUNT, "Of PATCH: where these bytes begin."),
    _SUM,
    required=False,
)


def _headers(*names: str, **schemas: dict[str, Any]) -> dict[str, Any]:
    text: dict[str, Any] = {"type": "string"}
    return {name: {"schema": schemas.get(name.replace("-", "_"), text)} for name in names}


#: Headers of answers.
STANDING = _headers(
    *("Tus-Resumable", "Upload-Offset", "Upload-Length", "Upload-Expires", "Upload-Metadata"),
    Upload_Offset=_BYTES_COUNT,
    Upload_Length=_BYTES_COUNT,
)
CREATED = STANDING | _headers("Location")
ABLE = _headers(
    *("Tus-Resumable", "Tus-Version", "Tus-Extension", "Tus-Max-Size", "Tus-Checksum-Algorithm"),
    Tus_Max_Size=_BYTES_COUNT,
)
