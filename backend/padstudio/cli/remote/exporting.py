"""Fetches a flight's poses in other programs' forms, as the server writes them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from padstudio.cli.remote.following import from_the_start, whole_file
from padstudio.cli.remote.server import API, Server
from padstudio.errors import SpecError

_ROUTE = "/flights/{flight_id}/export/{form}"
# The form that is placed by the vehicle's own poses.
_WITH_TRACK = "px4"


@dataclass(frozen=True)
class Exports:
    """What is fetched beside the poses file.

    Attributes
    ----------
    files : mapping of str to str
        Where each form is written.
    options : mapping of str to str
        Of the query, for all of them.
    track : bytes or None
        Where the vehicle was: its log, or a CSV file.
    """

    files: Mapping[str, str] = field(default_factory=dict)
    options: Mapping[str, str] = field(default_factory=dict)
    track: bytes | None = None

    def check(self, server: Server) -> None:
        """Refuse forms and options that the server does not have, before anything is sent.

        Raises
        ------
        SpecError
        """
        if not self.files:
            return
        route = server.json("GET", "/openapi.json")["paths"][API + _ROUTE]["get"]
        known = {each["name"]: each for each in route["parameters"]}
        forms = known.pop("form")["schema"]["enum"]
        known.pop("flight_id")
        for words, there, what in ((self.files, forms, "form"), (self.options, known, "option")):
            for word in words:
                if word not in there:
                    raise SpecError(
                        f"the server has no {what} of exports {word!r}; it has {', '.join(there)}",
                        code="unknown_export",
                    )
        if _WITH_TRACK in self.files and self.track is None:
            raise SpecError(
                f"{_WITH_TRACK} needs the vehicle's own poses: give them with --vehicle",
                code="vehicle_pose_required",
            )

    def fetch(self, server: Server, flight: str) -> None:
        """Write all of them, each whole or not at all; files that are there are written over."""
        for form, path in self.files.items():
            self._fetch(server, f"/flights/{flight}/export/{form}", form, Path(path))

    def _fetch(self, server: Server, address: str, form: str, path: Path) -> None:
        asked: dict[str, Any] = {"params": dict(self.options)}
        method = "GET"
        if form == _WITH_TRACK and self.track is not None:
            method = "POST"
            asked["files"] = {"vehicle": ("vehicle.csv", self.track)}

        def once(file: IO[bytes]) -> None:
            with server.stream(method, address, **asked) as answer:
                for block in answer.iter_bytes():
                    file.write(block)

        with whole_file(path) as temporary, temporary.open("wb") as file:
            server.insist(lambda: from_the_start(file, once))
