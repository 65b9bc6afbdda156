"""``padstudio remote``: as ``padstudio detect``, by a server."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Annotated, Any

import typer

from padstudio.bounded_files import read_whole
from padstudio.cli.outcomes import EXIT_NOTHING_FOUND, Figures, show_summary, write_record
from padstudio.cli.reading_options import (
    AtRest,
    Fuse,
    MethodName,
    Output,
    Param,
    Quiet,
    Rotation,
    Smooth,
    Stride,
    Topic,
    Unmix,
)
from padstudio.cli.remote.exporting import Exports
from padstudio.cli.remote.following import follow, frames_of, whole_file
from padstudio.cli.remote.lines import lines_of
from padstudio.cli.remote.ordering import camera_on, order, pad_on
from padstudio.cli.remote.sending import LocalFile, look_at, send
from padstudio.cli.remote.server import TOKEN, Server
from padstudio.cli.support import NoDistortion, check_output, check_said, note, progress_bar
from padstudio.errors import SpecError
from padstudio.flights.results.fusing import Fusion
from padstudio.flights.tasks.detectors import params_from, params_of_words
from padstudio.media.sources import find_frames, kind_of

_EXAMPLES = (
    "Examples: [bold]padstudio remote --server https://studio.example --pad pad.json --camera "
    "camera.yaml flight.mp4 -o poses.jsonl --export tum=flight.tum.txt[/]"
    " · [bold]padstudio remote --server http://127.0.0.1:8000 --pad 'roof pad' --camera "
    "preset-dji-mini-27k stills/ | jq .position_mm[/]"
)

Frames = Annotated[
    list[str],
    typer.Argument(help="Pictures, videos or recordings of one flight: files, folders, patterns."),
]
Address = Annotated[str, typer.Option("--server", metavar="URL", help="The server's address.")]
PadNames = Annotated[
    list[str],
    typer.Option("--pad", help="Pad file, or a pad on the server by name or id; again for more."),
]
CameraName = Annotated[
    str | None,
    typer.Option(
        help="Camera file, or a camera on the server by name or id; recordings may bring theirs."
    ),
]
ExportWords = Annotated[
    list[str] | None,
    typer.Option(
        "--export", metavar="FORM=FILE", help="Also write the poses in a form; again for more."
    ),
]
ExportOption = Annotated[
    list[str] | None,
    typer.Option(
        "--export-option",
        metavar="NAME=VALUE",
        help="Of exports, as images=true; see docs/rest.md.",
    ),
]
Vehicle = Annotated[
    Path | None,
    typer.Option(help="Where the vehicle was, for px4: its log, or a CSV; see docs/exports.md."),
]
Name = Annotated[str | None, typer.Option(help="What the flight is called on the server.")]
Callback = Annotated[
    str | None, typer.Option(metavar="URL", help="Have the server call there when it has ended.")
]
Anew = Annotated[
    bool, typer.Option("--anew", help="Analyse again what the server has analysed before.")
]
Patience = Annotated[
    float, typer.Option(min=0, help="Give up after so long without an answer of the server, s.")
]
Force = Annotated[bool, typer.Option("--force", help="Write over existing files.")]

# As of a server's own limit on telemetry.
_MOST_VEHICLE_BYTES = 64_000_000


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(remote)


def remote(
    frames: Frames,
    server: Address,
    pad: PadNames,
    camera: CameraName = None,
    no_distortion: NoDistortion = False,
    output: Output = "-",
    topic: Topic = None,
    export: ExportWords = None,
    export_option: ExportOption = None,
    vehicle: Vehicle = None,
    method: MethodName = "dense",
    unmix: Unmix = True,
    at_rest: AtRest = False,
    param: Param = None,
    stride: Stride = 1,
    apply_rotation: Rotation = True,
    fuse: Fuse = True,
    smooth: Smooth = False,
    name: Name = None,
    callback: Callback = None,
    anew: Anew = False,
    patience_s: Patience = 300.0,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Have a server find the pad in frames, and write their poses as detect does.

    Files are sent, the flight is ordered, followed and fetched. Run again after whatever broke, it
    goes on where it was: files that the server has are not sent, and a flight that was ordered is
    not ordered twice. The token is read from PADSTUDIO_TOKEN.

    The exit code is 0 if at least one frame gave a pose, 1 if none did, 2 for wrong input, also
    where the server cannot be reached.
    """
    settings = params_of_words(param or [])
    if not unmix:
        settings.setdefault("prepare", {})["unmix"] = False
    if at_rest:
        settings.setdefault("refine", {})["at_rest"] = True
    params_from(settings)
    if smooth and not fuse:
        raise typer.BadParameter("--smooth fuses poses; it excludes --no-fuse")
    exports = Exports(
        _pairs("--export", export or []),
        _pairs("--export-option", export_option or []),
        None if vehicle is None else read_whole(vehicle, _MOST_VEHICLE_BYTES),
    )
    outputs = [] if output == "-" else [output]
    paths = find_frames(frames)
    _check_outputs([*outputs, *exports.files.values()], paths, force=force)
    _check_kinds(paths)
    check_said(paths, topic=topic, camera=camera, no_distortion=no_distortion)
    studio = Server(server, os.environ.get(TOKEN), patience_s=patience_s, tell=note)
    try:
        version = studio.greet()
        exports.check(studio)
        chosen = {
            "camera": None
            if camera is None
            else camera_on(studio, camera, no_distortion=no_distortion),
            "topic": topic,
            "name": name,
            "callback": callback,
        }
        request: dict[str, Any] = {
            "pad": [pad_on(studio, each) for each in pad],
            "method": method,
            "params": settings,
            "stride": stride,
            "apply_rotation": apply_rotation,
            "fuse": fuse,
            "smooth": smooth,
            **{key: value for key, value in chosen.items() if value is not None},
        }
        files, uploads = _sent(studio, paths)
        flight, known = order(studio, files, uploads, request, version=version, anew=anew)
        what = "was ordered before" if known else "ordered"
        note(f"flight {flight['id']} {what}: {studio.address}/flights/{flight['id']}")
        flight = follow(studio, flight)
        names = {upload: path.as_posix() for upload, path in zip(uploads, paths, strict=True)}
        fusion: Fusion = "smooth" if smooth else "filter" if fuse else "none"
        outcomes = _write_poses(studio, flight, names, fusion, output)
        exports.fetch(studio, flight["id"])
    finally:
        studio.close()
    if not quiet:
        show_summary(outcomes)
    if not any(figures["ok"] for figures in outcomes):
        raise typer.Exit(EXIT_NOTHING_FOUND)


def _pairs(option: str, words: Sequence[str]) -> dict[str, str]:
    """Names and values of ``NAME=VALUE``."""
    found: dict[str, str] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not (name and equals and value) or name in found:
            raise typer.BadParameter(f"{option} {word}: give NAME=VALUE, each name once")
        found[name] = value
    return found


def _check_outputs(outputs: Sequence[str], inputs: Sequence[Path], *, force: bool) -> None:
    """Refuse what could not be written, before anything is sent."""
    if len(set(outputs)) < len(outputs):
        raise typer.BadParameter("two outputs have one name; give each its own")
    for path in outputs:
        check_output(Path(path), force=force, inputs=inputs)


def _sent(server: Server, paths: Sequence[Path]) -> tuple[list[LocalFile], list[str]]:
    """The files, and the ids of their uploads."""
    total = sum(path.stat().st_size for path in paths)
    with progress_bar("Reading files", total, counted=False) as progress:
        read = 0

        def more(count: int) -> None:
            nonlocal read
            read += count
            progress(read)

        files = [look_at(path, more) for path in paths]
    uploads: list[str] = []
    before = 0
    with progress_bar("Sending", total, counted=False) as progress:

        def there(count: int) -> None:
            progress(before + count)

        for file in files:
            uploads.append(send(server, file, uploads, there))
            before += file.size_bytes
    return files, uploads


def _check_kinds(paths: Sequence[Path]) -> None:
    """Refuse what would make no flight, before anything is sent."""
    for path in paths:
        if path.is_dir():
            raise SpecError(
                f"{path}: a bag's folder is sent as one file; zip it, or give the .mcap or .db3 "
                "in it",
                code="bag_folder",
            )
    kinds = {kind_of(path) for path in paths}
    if kinds & {"still", "stills"} and kinds & {"video", "recording"}:
        raise SpecError(
            "videos and stills do not go into one flight; give them in two calls",
            code="mixed_uploads",
        )


def _write_poses(
    server: Server, flight: Mapping[str, Any], names: Mapping[str, str], fusion: Fusion, output: str
) -> list[Figures]:
    """Write the poses file, whole or not at all; the figures of its lines."""
    sources = flight["sources"]
    called = [names[source["upload"]] for source in sources]
    with frames_of(server, dict(flight)) as export, _opened(output) as file:
        return [write_record(each, file) for each in lines_of(export, sources, called, fusion)]


@contextmanager
def _opened(output: str) -> Iterator[IO[str]]:
    if output == "-":
        yield sys.stdout
        return
    with whole_file(Path(output)) as temporary, temporary.open("w", encoding="utf-8") as file:
        yield file
