"""Orders a flight once: pads and cameras by file or name, the order under a key of its content."""

from __future__ import annotations

import hashlib
import json
import uuid
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from padstudio.cli.remote.sending import LocalFile
from padstudio.cli.remote.server import API, Server
from padstudio.cli.support import note, open_camera
from padstudio.errors import ConflictError, NotFoundError
from padstudio.geometry.presets import file_and_choice
from padstudio.pad.spec import Pad

_PAGE = 1000
_FILES = {"pads": "pad.json", "cameras": "camera.yaml"}

Flight = dict[str, Any]
Kind = Literal["pads", "cameras"]


def pad_on(server: Server, given: str) -> str:
    """Id of a pad on the server: of a pad file, which is stored there, or of one there by name.

    Raises
    ------
    StudioError
        If the file is no pad, or there is none of that name, or several.
    """
    if not Path(given).is_file():
        return _of_name(server, "pads", given)
    text = Pad.load(given).dumps()
    return _stored(server, "/pads/import", "pad.json", text)


def camera_on(server: Server, given: str, *, no_distortion: bool = False) -> str:
    """Id of a camera on the server, as of `pad_on`; tells of one that is nominal."""
    if Path(file_and_choice(given)[0]).is_file():
        text = open_camera(given, no_distortion=no_distortion).to_ros_yaml()
        found = _stored(server, "/cameras", "camera.yaml", text)
    else:
        found = _of_name(server, "cameras", given)
    camera = server.json("GET", f"/cameras/{found}")
    if camera["nominal"]:
        note(f"camera {camera['name']}: nominal, calibrate for accuracy")
    return found


def order(
    server: Server,
    files: Sequence[LocalFile],
    uploads: Sequence[str],
    request: Mapping[str, Any],
    *,
    version: str,
    anew: bool = False,
) -> tuple[Flight, bool]:
    """Order a flight; the very same that was ordered before is the answer.

    Parameters
    ----------
    server : Server
    files : sequence of LocalFile
    uploads : sequence of str
        Their ids.
    request : mapping
        The order, without its uploads.
    version : str
        Of the server: another one may read frames otherwise.
    anew : bool
        Order it even if it was ordered before.

    Returns
    -------
    flight : dict
    known : bool
        It was there already.
    """
    content = {
        "version": version,
        "files": [file.sha256 for file in files],
        # What a pad or camera of that id holds may have changed.
        "pads": [_text(server, "pads", pad) for pad in request["pad"]],
        "camera": _text(server, "cameras", request["camera"]) if "camera" in request else None,
        "request": dict(request),
        "anew": uuid.uuid4().hex if anew else "",
    }
    key = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
    answer = server.ask(
        "POST",
        f"{API}/flights",
        json={**request, "uploads": list(uploads)},
        headers={"Idempotency-Key": key},
    )
    flight: Flight = answer.json()
    known = answer.status_code == 200
    if known and flight["state"] in ("failed", "cancelled"):
        flight = server.json("POST", f"/flights/{flight['id']}/retry")
    return flight, known


def _stored(server: Server, address: str, name: str, text: str) -> str:
    answer = server.json("POST", address, files={"file": (name, text.encode())})
    return str(answer["id"])


def _of_name(server: Server, kind: Kind, given: str) -> str:
    """Id of what is stored under an id or a name."""
    word, item = kind[:-1], None
    presets = server.json("GET", "/cameras/presets")["items"] if kind == "cameras" else []
    found = [*_every(server, kind), *presets]
    by_id = [item for item in found if item["id"] == given]
    named = by_id or [item for item in found if item["name"] == given]
    if not named:
        raise NotFoundError(
            f"{given}: no such {word} file here, and no {word} of that id or name on the server"
        )
    if len(named) > 1:
        raise ConflictError(
            f"several {word}s on the server are called {given!r}; give the id of one: "
            + ", ".join(str(item["id"]) for item in named),
            code="ambiguous_name",
        )
    [item] = named
    return str(item["id"])


def _every(server: Server, kind: Kind) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = []
    while True:
        page = server.json("GET", f"/{kind}", params={"limit": _PAGE, "offset": len(found)})
        found += page["items"]
        if not page["items"] or len(found) >= page["total"]:
            return found


def _text(server: Server, kind: Kind, item_id: str) -> str:
    return str(server.ask("GET", f"{API}/{kind}/{item_id}/files/{_FILES[kind]}").text)
