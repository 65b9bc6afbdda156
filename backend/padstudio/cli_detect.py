"""``padstudio detect``: poses of many frames, as JSON lines; ``padstudio cameras``."""

from __future__ import annotations

import json
import logging
import os
import statistics
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Annotated, Any, Literal

import typer

from padstudio.cli_support import (
    check_output,
    load_camera,
    load_pad,
    note,
    progress_bar,
    show_error,
)

EXIT_NOTHING_FOUND = 1
# Below this many frames a process, starting it costs more than it saves.
_FRAMES_PER_JOB = 4

_EXAMPLES = (
    "Examples: [bold]padstudio detect --pad pad.json --camera camera.yaml frames/ -o poses.jsonl[/]"
    " · [bold]padstudio detect --pad pad.json --camera preset-dji-mini-27k 'flight/**/*.jpg' -o - "
    "| jq .position_mm[/]"
)


def register(app: typer.Typer) -> None:
    """Add the commands to the program."""
    app.command(epilog=_EXAMPLES)(detect)
    app.command()(cameras)


def detect(
    frames: Annotated[
        list[str],
        typer.Argument(help="Pictures, folders of pictures, or patterns such as **/*.jpg."),
    ],
    pad: Annotated[Path, typer.Option(help="Pad file.")],
    camera: Annotated[
        str, typer.Option(help="Camera file, or a preset's id (see: padstudio cameras).")
    ],
    output: Annotated[
        str, typer.Option("-o", "--output", help="Poses file to write; - is stdout.")
    ] = "-",
    method: Annotated[
        Literal["dense", "paper"],
        typer.Option(help="dense: all that is in the picture; paper: the published method."),
    ] = "dense",
    jobs: Annotated[
        int,
        typer.Option("-j", "--jobs", min=0, max=256, help="Processes; 0 takes one for every core."),
    ] = 0,
    force: Annotated[bool, typer.Option("--force", help="Write over an existing file.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="No summary.")] = False,
) -> None:
    """Find the pad in frames and write their poses, one JSON object a line.

    A frame that cannot be read is one line with status failed, and one on stderr; the others go on.
    EXIF orientation is not applied, as calibrations are of the sensor's own frame.

    The exit code is 0 if at least one frame gave a pose, 1 if none did, 2 for wrong input.
    """
    from padstudio.flights.batch import detect_stills
    from padstudio.flights.sources import find_stills

    if not os.environ.get("PADSTUDIO_DEBUG"):
        # A defect is one line like other errors; its traceback is for who looks for it.
        logging.getLogger("padstudio").setLevel(logging.CRITICAL)
    the_pad, the_camera = load_pad(pad), load_camera(camera)
    paths = find_stills(frames)
    if the_camera.nominal:
        note(f"camera {the_camera.name}: nominal, calibrate for accuracy")
    records = []
    with _writer(output, force=force) as file, progress_bar() as progress:
        task = progress.add_task("Detecting", total=len(paths))
        for record in detect_stills(
            paths, the_pad, the_camera, method=method, jobs=_jobs(jobs, len(paths))
        ):
            file.write(json.dumps(record, ensure_ascii=False) + "\n")
            file.flush()
            if record.get("stage") == "read":
                show_error(f"{record['source']}: {record['detail']}", record["reason"])
            records.append(_figures(record))
            progress.advance(task)
    if not quiet:
        _show_summary(records)
    if not any(figures["ok"] for figures in records):
        raise typer.Exit(EXIT_NOTHING_FOUND)


def _jobs(asked: int, frames: int) -> int:
    return asked or max(1, min(os.cpu_count() or 1, frames // _FRAMES_PER_JOB))


@contextmanager
def _writer(output: str, *, force: bool) -> Iterator[IO[str]]:
    if output == "-":
        yield sys.stdout
        return
    path = Path(output)
    check_output(path, force=force)
    with path.open("w", encoding="utf-8") as file:
        yield file


def _figures(record: dict[str, Any]) -> dict[str, Any]:
    """What the summary needs of a record, so that a long run does not keep them all."""
    ok = record["status"] == "ok"
    outcome = f"pose by {record['layer']}" if ok else f"failed at {record['stage']}"
    why = "" if ok else record["reason"]
    return {"ok": ok, "outcome": (outcome, why), "ms": record["elapsed_ms"].get("total")}


def _show_summary(records: list[dict[str, Any]]) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table("outcome", "reason", "frames", "share")
    table.columns[2].justify = table.columns[3].justify = "right"
    counts = Counter(figures["outcome"] for figures in records)
    for (outcome, why), count in sorted(counts.items(), key=lambda item: (-item[1], item[0])):
        table.add_row(outcome, why, str(count), f"{100 * count / len(records):.1f} %")
    times = [figures["ms"] for figures in records if figures["ms"] is not None]
    if times:
        table.caption = f"median {statistics.median(times):.0f} ms a frame, picture decoded"
    Console(stderr=True).print(table)


def cameras() -> None:
    """List the nominal cameras that --camera takes in place of a file."""
    from rich.console import Console
    from rich.table import Table

    from padstudio.geometry import presets

    table = Table("camera", "size", "focal length", caption=presets.NOTE)
    # Never shortened, as it is there to be copied.
    table.add_column("id", no_wrap=True, min_width=max(map(len, presets.PRESETS)))
    for preset in presets.PRESETS.values():
        camera = preset.camera
        size = f"{camera.width} x {camera.height}"
        table.add_row(camera.name, size, f"{camera.focal_px:.0f} px", preset.id)
    Console().print(table)
