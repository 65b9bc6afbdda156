"""Headers of the tus 1.0 protocol for resumable uploads: reading and writing them.

The protocol: https://tus.io/protocols/resumable-upload
"""

from __future__ import annotations

import base64
import binascii
from collections.abc import Mapping
from email.utils import format_datetime

from padstudio.errors import StudioError
from padstudio.store.uploads.files import CHECKSUMS, Checksum
from padstudio.store.uploads.rows import Upload

VERSION = "1.0.0"
EXTENSIONS = "creation,creation-with-upload,checksum,expiration,termination"
#: Where uploads are.
PATH = "/api/v1/uploads"
MEDIA_TYPE = "application/offset+octet-stream"
#: On every answer under the address of uploads, errors among them.
EVERYWHERE = {"Tus-Resumable": VERSION, "Tus-Version": VERSION}

#: Characters; a name of 200 takes 1100 in base64.
MAX_METADATA = 4000


class TusHeaderError(StudioError):
    """A header of the protocol is missing or ill-formed."""

    code = "invalid_tus_header"
    status = 400


class TusVersionError(StudioError):
    """The client speaks another version."""

    code = "tus_version"
    status = 412


class TusMediaTypeError(StudioError):
    """Bytes come under another media type than the protocol's."""

    code = "unsupported_media_type"
    status = 415


def options(max_bytes: int) -> dict[str, str]:
    """What the server can do."""
    return {
        "Tus-Extension": EXTENSIONS,
        "Tus-Max-Size": str(max_bytes),
        "Tus-Checksum-Algorithm": ",".join(CHECKSUMS),
    }


def describe(upload: Upload) -> dict[str, str]:
    """Where an upload stands."""
    headers = {
        "Upload-Offset": str(upload.offset),
        "Upload-Length": str(upload.size_bytes),
    }
    if upload.metadata:
        headers["Upload-Metadata"] = upload.metadata
    if upload.expires_at is not None:
        headers["Upload-Expires"] = format_datetime(upload.expires_at, usegmt=True)
    return headers


def check_version(headers: Mapping[str, str]) -> None:
    """Raise `TusVersionError` where the client does not speak this version."""
    if headers.get("tus-resumable") != VERSION:
        raise TusVersionError(
            f"uploads follow tus {VERSION}: send the header Tus-Resumable: {VERSION}, or use a tus "
            "client"
        )


def carries_bytes(headers: Mapping[str, str]) -> bool:
    """True where the body is declared as bytes of an upload."""
    return headers.get("content-type", "").partition(";")[0].strip() == MEDIA_TYPE


def check_media_type(headers: Mapping[str, str]) -> None:
    """Raise `TusMediaTypeError` where the body is not declared as bytes of an upload."""
    if not carries_bytes(headers):
        raise TusMediaTypeError(f"send the bytes with Content-Type: {MEDIA_TYPE}")


def number(headers: Mapping[str, str], name: str) -> int:
    """A header that is a count of bytes.

    Raises
    ------
    TusHeaderError
        If it is missing or no such number.
    """
    text = headers.get(name.lower(), "")
    if not (text.isascii() and text.isdigit() and len(text) < 20):
        raise TusHeaderError(f"the header {name} must be a number of bytes, not {text[:40]!r}")
    return int(text)


def length(headers: Mapping[str, str]) -> int:
    """How many bytes a new upload will have; raises as `number`."""
    for name, way_out in (
        ("upload-defer-length", "say the length with Upload-Length"),
        ("upload-concat", "send the file as one upload"),
    ):
        if name in headers:
            raise TusHeaderError(f"this server does not know {name.title()}; {way_out}")
    return number(headers, "Upload-Length")


def metadata(headers: Mapping[str, str]) -> dict[str, str]:
    """The names and values that a client gave a new upload.

    Raises
    ------
    TusHeaderError
        If they are not pairs of a name and base64, or too many.
    """
    text = headers.get("upload-metadata", "")
    if len(text) > MAX_METADATA:
        raise TusHeaderError(f"Upload-Metadata is longer than {MAX_METADATA} characters")
    found: dict[str, str] = {}
    for pair in text.split(",") if text.strip() else ():
        name, _, value = pair.strip().partition(" ")
        if not name or name in found:
            raise TusHeaderError("Upload-Metadata has an empty name, or one name twice")
        found[name] = _decode(value, "Upload-Metadata").decode("utf-8", "replace")
    return found


def checksum(headers: Mapping[str, str]) -> Checksum | None:
    """What the request's bytes must hash to; None where it does not say.

    Raises
    ------
    TusHeaderError
        If it is ill-formed or of an unknown algorithm.
    """
    text = headers.get("upload-checksum")
    if text is None:
        return None
    algorithm, _, digest = text.partition(" ")
    if algorithm not in CHECKSUMS:
        raise TusHeaderError(
            f"Upload-Checksum takes {' and '.join(CHECKSUMS)}, not {algorithm[:40]!r}",
            code="unknown_checksum",
        )
    return Checksum(algorithm, _decode(digest, "Upload-Checksum"))


def _decode(text: str, name: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError) as error:
        raise TusHeaderError(f"{name} holds what is not base64: {text[:40]!r}") from error
