"""``padstudio budget``: how much of a pose's error comes from what."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Literal

import typer

from padstudio.cli.support import (
    NoDistortion,
    check_output,
    note,
    open_camera,
    progress_bar,
    show_table,
)
from padstudio.errors import ConflictError
from padstudio.experiments.budget.conditions import QUANTITIES, Conditions, parsed
from padstudio.experiments.budget.order import USUAL_FRAMES, BudgetOrder
from padstudio.experiments.budget.run import budget as budget_of
from padstudio.experiments.budget.sections import report_of
from padstudio.experiments.report import Report, Table
from padstudio.experiments.writers import write_report
from padstudio.pad.spec import Pad

_EXAMPLES = (
    "Examples: [bold]padstudio budget --pad pad.json --camera camera.yaml --height-mm 1300[/] · "
    "[bold]padstudio budget --pad pad.json --camera camera.yaml --height-mm 450 --with "
    "readout_ms=0 --with waves_mm=3 --frames 16 -o budget[/]"
)
PadFile = Annotated[Path, typer.Option(help="Pad file.")]
CameraName = Annotated[
    str, typer.Option(help="Camera file, or a preset's id (see: padstudio cameras).")
]
Height = Annotated[float, typer.Option(help="Height of the camera over the pad, mm.")]
With = Annotated[
    list[str] | None,
    typer.Option(
        "--with",
        metavar="NAME=VALUE",
        help="Size of a quantity, again for more: exposure_ms=2, waves_mm=3, … "
        "(--list-quantities).",
    ),
]
CodecName = Annotated[Literal["h264", "h265"], typer.Option(help="Of the stream.")]
Frames = Annotated[int, typer.Option(help="Simulated frames in each case; best a multiple of 8.")]
Seed = Annotated[int, typer.Option(help="The same seed gives the same budget.")]
Bend = Annotated[
    bool,
    typer.Option(help="Ask of each frame whether the paper is bent, as in stills; takes longer."),
]
Check = Annotated[
    bool, typer.Option("--check", help="Simulate all sources once more after the best change.")
]
Workers = Annotated[
    int | None, typer.Option(min=1, help="Processes; the result is the same. All cores by default.")
]
Folder = Annotated[
    Path | None, typer.Option("-o", "--output", help="Folder for Markdown, HTML, CSV and bars.")
]
Force = Annotated[bool, typer.Option("--force", help="Write into a folder that is there.")]
ListQuantities = Annotated[
    bool,
    typer.Option(
        "--list-quantities", is_eager=True, callback=lambda on: _list(on), help="And their sizes."
    ),
]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(budget)


def budget(
    pad: PadFile,
    camera: CameraName,
    height_mm: Height,
    no_distortion: NoDistortion = False,
    with_: With = None,
    codec: CodecName = "h264",
    frames: Frames = USUAL_FRAMES,
    seed: Seed = 1,
    bend: Bend = False,
    check: Check = False,
    workers: Workers = None,
    output: Folder = None,
    force: Force = False,
    list_quantities: ListQuantities = False,
) -> None:
    """Say how much of a pose's error comes from what, and which change would help most.

    Pixels and noise, blur, rolling shutter, print scale, paper flatness, calibration and stream
    compression are simulated one by one, and all together.
    """
    if output is not None:
        _check_folder(output, force)
    the_camera = open_camera(camera, no_distortion=no_distortion)
    order = BudgetOrder(
        pad=Pad.load(pad),
        camera=the_camera,
        height_mm=height_mm,
        conditions=Conditions.of(the_camera, parsed(with_ or ())),
        codec=codec,
        frames=frames,
        seed=seed,
        fits_bends=bend,
        is_checked=check,
    )
    with progress_bar("Simulating", 1, counted=False) as bar:
        found = budget_of(
            order, lambda done, all_: bar(done / all_), workers or os.cpu_count() or 1
        )
    report = report_of(found)
    _show(report)
    if output is not None:
        files = write_report(report, output)
        note(f"{output}: {', '.join(path.name for path in files)}")


def _check_folder(output: Path, force: bool) -> None:
    if output.exists() and not (force and output.is_dir()):
        raise ConflictError(
            f"{output} exists; give another name, or --force to write into a folder",
            code="file_exists",
        )
    check_output(output, force=True)


def _show(report: Report) -> None:
    tables = {table.name: table for table in report.tables}
    _show_sources(tables["sources"])
    _show_changes(tables["changes"])
    for words in report.words:
        print(words)
    for section in report.sections:
        for claim in section.claims:
            print(f"{claim.text} {claim.verdict.capitalize()}: {claim.because}")


def _show_sources(table: Table) -> None:
    # Short ones: a terminal of 80 columns shows all figures whole.
    heads = ("source", "mm", "95 %", "%", "height", "across", "°")
    parts = "%: of the height; height and across: parts of the position, mm; °: of the attitude"
    rows = []
    for source, _, position, low, high, share, height, across, attitude, told, _ in table.shown:
        size = position if told != "no" else f"≤ {high}"
        rows.append((source, size, f"{low} … {high}", share, height, across, attitude))
    caption = f"{table.caption}; {parts}"
    show_table(heads, rows, caption=caption, right=heads[1:], whole=heads[1:])


def _show_changes(table: Table) -> None:
    heads = ("change", "mm after", "gain mm", "95 %")
    rows = [
        (change, after, gain, f"{low} … {high}")
        for change, _, after, gain, low, high, _ in table.shown
    ]
    show_table(heads, rows, caption=table.caption, right=heads[1:], whole=heads[1:])


def _list(wanted: bool) -> None:
    if wanted:
        for name, each in QUANTITIES.items():
            print(f"{name:18}{each.default:>8g} {each.unit:10}{each.meaning}")
            print(f"{'':37}default: {each.reason}")
        raise typer.Exit
