"""Sends files by the tus protocol; what the server has of them is not sent again.

How far a file has come is known to the server alone: whole files by their SHA-256, unfinished ones
by the SHA-256 that was announced with them. So nothing is kept here, and a program that was killed
goes on where it was when it is run again, from any machine that has the file.
"""

from __future__ import annotations

import base64
import hashlib
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from padstudio.bounded_files import open_regular
from padstudio.cli.remote.server import API, Server, ServerError, is_passing

_TUS = {"Tus-Resumable": "1.0.0"}
_BLOCK_BYTES = 1 << 20
# A piece takes about a second: short enough to send twice, long enough to cost nothing.
_FIRST_BYTES, _LEAST_BYTES, _MOST_BYTES = 1 << 20, 1 << 18, 32 << 20
_PIECE_S = 1.0
# Pieces in a row that did not arrive.
_MOST_FAILURES = 8
# What else a refused piece may mean than that it is of no use.
_ELSEWHERE = ("offset_mismatch", "checksum_mismatch", "upload_complete", "disconnected")
_ANEW = ("not_found", "upload_taken_over")


@dataclass(frozen=True)
class LocalFile:
    """A file of this machine.

    Attributes
    ----------
    path : Path
    size_bytes : int
    sha256 : str
        Hexadecimal.
    """

    path: Path
    size_bytes: int
    sha256: str


def look_at(path: Path, progress: Callable[[int], None]) -> LocalFile:
    """Read a file through; `progress` is told how many bytes were read."""
    digest, size = hashlib.sha256(), 0
    with open_regular(path) as file:
        while block := file.read(_BLOCK_BYTES):
            digest.update(block)
            size += len(block)
            progress(len(block))
    return LocalFile(path, size, digest.hexdigest())


def send(
    server: Server, file: LocalFile, taken: Collection[str], progress: Callable[[int], None]
) -> str:
    """Bring a file to the server.

    Parameters
    ----------
    server : Server
    file : LocalFile
    taken : collection of str
        Ids of uploads that are other files of the same flight, maybe of the same bytes.
    progress : callable
        Told how many bytes of it are there.

    Returns
    -------
    str
        Id of the upload.

    Raises
    ------
    ServerError
        If the server refuses it, does not answer any more, or the file has changed meanwhile.
    """
    whole = _found(server, file, taken, sha256=file.sha256)
    if whole:
        progress(file.size_bytes)
        named = [item for item in whole if item["name"] == file.path.name]
        return str((named or whole)[0]["id"])
    try:
        if file.size_bytes <= _FIRST_BYTES:
            progress(file.size_bytes)
            return _send_whole(server, file)
        begun = _found(server, file, taken, announced_sha256=file.sha256)
        farthest = str(max(begun, key=lambda item: item["offset"])["id"]) if begun else None
        upload_id = _send(server, file, farthest, progress)
    except ServerError as error:
        if error.answered in (413, 422):
            error.message = f"{file.path}: {error.message}"
        raise
    return _checked(server, file, server.json("GET", f"/uploads/{upload_id}"))


def _checked(server: Server, file: LocalFile, found: dict[str, Any]) -> str:
    """Id of an upload that is what was to be sent."""
    if found["sha256"] != file.sha256:
        server.ask("DELETE", f"{API}/uploads/{found['id']}")
        raise _changed(file)
    return str(found["id"])


def _send_whole(server: Server, file: LocalFile) -> str:
    """Send a small file with its announcement, as there may be thousands of stills."""
    content = file.path.read_bytes()
    if len(content) != file.size_bytes:
        raise _changed(file)
    headers = _announcement(file) | _headers(0, content)
    del headers["Upload-Offset"]
    answer = server.ask("POST", f"{API}/uploads", headers=headers, content=content)
    return _checked(server, file, answer.json())


def _found(
    server: Server, file: LocalFile, taken: Collection[str], **query: str
) -> list[dict[str, Any]]:
    """Uploads on the server that are, or are going to be, the same bytes."""
    answer = server.json("GET", "/uploads", params=query)
    return [
        item
        for item in answer["items"]
        if item["size_bytes"] == file.size_bytes and item["id"] not in taken
    ]


def _send(
    server: Server, file: LocalFile, upload_id: str | None, progress: Callable[[int], None]
) -> str:
    """Send to an upload that was begun, or to a new one; its id."""
    for _ in range(_MOST_FAILURES):
        is_new = upload_id is None
        upload_id = upload_id or _announce(server, file)
        try:
            _send_rest(server, upload_id, file, progress, 0 if is_new else None)
            return upload_id
        except ServerError as error:
            if error.error_code not in _ANEW:
                raise
            # Gone, or somebody else goes on with it: one of our own, lest both wait for each other.
            upload_id = None
    raise ServerError("others keep sending the same file; try later", code="upload_taken_over")


def _announce(server: Server, file: LocalFile) -> str:
    answer = server.ask("POST", f"{API}/uploads", headers=_announcement(file))
    return str(answer.json()["id"])


def _announcement(file: LocalFile) -> dict[str, str]:
    said = {"filename": file.path.name, "sha256": file.sha256}
    pairs = (f"{name} {base64.b64encode(text.encode()).decode()}" for name, text in said.items())
    told = {"Upload-Length": str(file.size_bytes), "Upload-Metadata": ",".join(pairs)}
    return _TUS | told


def _send_rest(
    server: Server,
    upload_id: str,
    file: LocalFile,
    progress: Callable[[int], None],
    offset: int | None,
) -> None:
    """Send what is missing, and ask how far it came wherever that is not known."""
    address = f"{API}/uploads/{upload_id}"
    size, failures = _FIRST_BYTES, 0
    if offset is None:
        offset = _offset(server.ask("HEAD", address, headers=_TUS))
    with file.path.open("rb") as source:
        while offset < file.size_bytes:
            progress(offset)
            source.seek(offset)
            piece = source.read(min(size, file.size_bytes - offset))
            if not piece:
                raise _changed(file)
            begun = time.monotonic()
            try:
                answer = server.once(
                    "PATCH", address, content=piece, headers=_headers(offset, piece)
                )
                failures = 0
            except ServerError as error:
                failures += 1
                known = is_passing(error) or error.error_code in _ELSEWHERE
                if not known or failures >= _MOST_FAILURES:
                    raise
                answer = server.ask("HEAD", address, headers=_TUS)
            offset, elapsed_s = _offset(answer), time.monotonic() - begun
            size = _next_size(len(piece), elapsed_s)
    progress(file.size_bytes)


def _changed(file: LocalFile) -> ServerError:
    return ServerError(
        f"{file.path} was changed while it was sent; wait until it is whole, and run this again",
        code="file_changed",
    )


def _headers(offset: int, piece: bytes) -> dict[str, str]:
    digest = base64.b64encode(hashlib.sha256(piece).digest()).decode()
    return _TUS | {
        "Content-Type": "application/offset+octet-stream",
        "Upload-Offset": str(offset),
        "Upload-Checksum": f"sha256 {digest}",
    }


def _offset(answer: Any) -> int:
    try:
        return int(answer.headers["Upload-Offset"])
    except (KeyError, ValueError):
        raise ServerError(
            "the server does not say how far an upload is", code="no_studio"
        ) from None


def _next_size(sent: int, elapsed_s: float) -> int:
    """Bytes of the next piece; one quick answer is no proof of a quick line."""
    wanted = sent * _PIECE_S / max(elapsed_s, 1e-3)
    return int(min(max(min(wanted, 2 * sent), _LEAST_BYTES), _MOST_BYTES))
