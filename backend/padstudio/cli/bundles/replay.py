"""``padstudio replay``: a bundle's frame read again, and what is otherwise."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from padstudio.bounded_files import read_whole
from padstudio.cli.outcomes import EXIT_NOTHING_FOUND
from padstudio.errors import LimitError, NotFoundError
from padstudio.flights.bundles.members import MAX_BYTES
from padstudio.flights.bundles.reading import unpack
from padstudio.flights.bundles.replay import replay as read_again

BundleFile = Annotated[Path, typer.Argument(help="A bundle, *.zip.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print all as one JSON object.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(replay)


def replay(bundle: BundleFile, as_json: AsJson = False) -> None:
    """Read a bundle's frame again, and say what is otherwise.

    The exit code is 0 if the result is the very same, 1 if not, 2 for wrong input.
    """
    try:
        data = read_whole(bundle, MAX_BYTES)
    except OSError as error:
        raise NotFoundError(f"cannot read {bundle.name}: {error.strerror}") from error
    if len(data) > MAX_BYTES:
        raise LimitError(
            f"{bundle.name} is larger than {MAX_BYTES // 1_000_000} MB, as no bundle is",
            code="bundle_too_large",
        )
    found = read_again(unpack(data))
    typer.echo(json.dumps(found) if as_json else _words(found))
    if not found["same"]:
        raise typer.Exit(EXIT_NOTHING_FOUND)


def _words(found: dict[str, Any]) -> str:
    lines = ["the very same result" if found["same"] else "the result differs"]
    parts = [("", "differences"), ("by itself, ", "alone_differences"),
             ("of the run, ", "recorded_differences")]  # fmt: skip
    lines += [
        f"{which}{each['field']}: {each['then']} then, {each['now']} now"
        for which, name in parts
        for each in found[name]
    ]
    lines += [f"version of {each['name']}: {each['then']} then, {each['now']} now"
              for each in found["versions"]]  # fmt: skip
    return "\n".join(lines)
