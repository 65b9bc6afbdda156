"""Follows a flight to its end, and fetches what came out."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from padstudio.cli.remote.ordering import Flight
from padstudio.cli.remote.server import Server, ServerError, error_of
from padstudio.cli.support import note, progress_bar

_FIRST_LOOK_S, _LONGEST_LOOK_S = 0.1, 2.0


def follow(server: Server, flight: Flight) -> Flight:
    """Wait until a flight is done; shows how far it is.

    Raises
    ------
    ServerError
        If it fails or is cancelled, with the flight's own error; or the server is gone for longer
        than its patience.
    """
    looks, told = _looks(server, flight["id"]), None
    for flight in looks:
        told = _tell(flight, told)
        if flight["frames_total"] is not None or _over(flight):
            break
    if not _over(flight):
        with progress_bar("Detecting", flight["frames_total"]) as progress:
            progress(flight["frames_done"])
            for flight in looks:
                told = _tell(flight, told)
                progress(flight["frames_done"])
                if _over(flight):
                    break
    if flight["state"] != "done":
        message, code = error_of(flight["error"])
        if flight["state"] == "cancelled":
            message, code = "it was cancelled on the server", "cancelled"
        raise ServerError(
            f"flight {flight['id']}: {message}; run this again to try what is missing", code=code
        )
    return flight


@contextmanager
def frames_of(server: Server, flight: Flight) -> Iterator[Iterator[bytes]]:
    """The lines of a flight's export ``jsonl``, all of them.

    Raises
    ------
    ServerError
        If they are not as many as the flight has frames.
    """
    with tempfile.TemporaryFile() as file:

        def once(file: IO[bytes]) -> None:
            with server.stream("GET", f"/flights/{flight['id']}/export/jsonl") as answer:
                for block in answer.iter_bytes():
                    file.write(block)

        server.insist(lambda: from_the_start(file, once))
        file.seek(0)
        count = sum(1 for _ in file)
        if count != flight["frames_done"]:
            raise ServerError(
                f"flight {flight['id']} has {flight['frames_done']} frames, and {count} came; run "
                "this again",
                code="incomplete",
            )
        file.seek(0)
        yield iter(file)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A file to be written beside another one, whose place it takes in the end."""
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        # As others would have made it: temporary files are their owner's alone.
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def from_the_start(file: IO[bytes], write: Callable[[IO[bytes]], None]) -> None:
    """Write a file that may have been begun before."""
    file.seek(0)
    file.truncate()
    write(file)
    file.flush()


def _looks(server: Server, flight_id: str) -> Iterator[Flight]:
    """The flight, looked at less and less often."""
    wait_s = _FIRST_LOOK_S
    while True:
        yield server.json("GET", f"/flights/{flight_id}")
        time.sleep(wait_s)
        wait_s = min(1.3 * wait_s, _LONGEST_LOOK_S)


def _over(flight: Flight) -> bool:
    return flight["state"] not in ("queued", "running")


def _tell(flight: Flight, told: str | None) -> str | None:
    """Say why the work does not go on, once."""
    notice: str | None = flight.get("notice")
    if notice and notice != told:
        note(notice)
    return notice
