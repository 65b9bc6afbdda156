"""``padstudio compare``: what one poses file has otherwise than another."""

from __future__ import annotations

import csv
import itertools
import json
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from padstudio.cli.support import check_output, note
from padstudio.errors import SpecError
from padstudio.flights.results.comparing import (
    columns_of,
    compare_runs,
    kind_of,
    moved_between,
)
from padstudio.flights.results.poses_file import read_poses
from padstudio.flights.results.rows import Record

_Key = Callable[[Record], str]
_EXAMPLES = (
    "Examples: [bold]padstudio compare before.jsonl after.jsonl[/] · "
    "[bold]padstudio compare before.jsonl after.jsonl --least-mm 5 -o changes.csv[/]"
)
_FIELDS = ("source", "frame", "change", "moved_mm", "moved_share", "turned_deg", "reason_before",
           "reason_after")  # fmt: skip

First = Annotated[Path, typer.Argument(help="Poses file (*.jsonl) of the first run.")]
Second = Annotated[Path, typer.Argument(help="Poses file of the second run.")]
Output = Annotated[Path | None, typer.Option("-o", "--output", help="The changed frames, CSV.")]
LeastMm = Annotated[float, typer.Option(min=0, help="A pose has moved where it is so far off, mm.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print the figures as one JSON object.")]
Force = Annotated[bool, typer.Option("--force", help="Write over an existing file.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(compare)


def compare(
    first: First,
    second: Second,
    output: Output = None,
    least_mm: LeastMm = 1.0,
    as_json: AsJson = False,
    force: Force = False,
) -> None:
    """Say which frames a second run won, lost and read otherwise.

    Frames are the same where source and frame number are, and of several pads in one the pad.
    """
    if output is not None:
        check_output(output, force=force)
    runs = [list(read_poses(path)) for path in (first, second)]
    key = _keys(runs)
    changes = compare_runs(*(columns_of(run, key) for run in runs))
    if not len(changes.key):
        raise SpecError(
            "the files have no frame in common: their sources are named otherwise",
            code="no_common_frames",
        )
    figures = changes.summary()
    if figures["moved"]:
        figures["moved"]["worst_frame"] = json.loads(figures["moved"]["worst_frame"])
    typer.echo(json.dumps(figures) if as_json else _words(figures))
    if output is not None:
        count = _write(output, runs, key, least_mm)
        note(f"{output}: {count} changed frames")


def _keys(runs: list[list[Record]]) -> _Key:
    """What makes records of two runs the same; a failed frame names no pad."""

    def place(record: Record) -> tuple[str, int | None]:
        return record["source"], record.get("frame")

    pads = defaultdict(set)
    for record in itertools.chain(*runs):
        pads[place(record)].add(record.get("pad_id"))
    several = {each for each, found in pads.items() if len(found - {None}) > 1}

    def key(record: Record) -> str:
        here = place(record)
        return json.dumps([*here, record.get("pad_id") if here in several else None])

    return key


def _words(figures: dict[str, Any]) -> str:
    lines = [f"{name:<12}{figures[name]}" for name in ("frames", "won", "lost", "both", "neither")]
    lines += [
        f"{name:<12}{figures[name]}" for name in ("only_first", "only_second") if figures[name]
    ]
    moved = figures["moved"]
    if moved:
        source, frame, _ = moved["worst_frame"]
        where = source if frame is None else f"{source}, frame {frame}"
        lines.append(
            f"{'moved':<12}median {moved['median_mm']:g} mm, 95th percentile "
            f"{moved['p95_mm']:g} mm, worst {moved['worst_mm']:g} mm "
            f"({100 * moved['worst_share']:.2g} %): {where}"
        )
    return "\n".join(lines)


def _write(output: Path, runs: list[list[Record]], key: _Key, least_mm: float) -> int:
    before: dict[str, Record] = {}
    for record in runs[0]:
        before.setdefault(key(record), record)
    count = 0
    with output.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, _FIELDS)
        table.writeheader()
        for now in runs[1]:
            was = before.pop(key(now), None)
            if was is None:
                continue
            kind, moved = kind_of(was, now), moved_between(was, now)
            if kind == "both" and (moved["moved_mm"] or 0.0) >= least_mm:
                kind = "moved"
            if kind not in ("won", "lost", "moved"):
                continue
            place = {"source": now["source"], "frame": now.get("frame"), "change": kind}
            reasons = {"reason_before": was.get("reason"), "reason_after": now.get("reason")}
            table.writerow(place | moved | reasons)
            count += 1
    return count
