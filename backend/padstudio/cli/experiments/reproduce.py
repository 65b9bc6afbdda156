"""``padstudio reproduce``: the paper's experiments on the simulator."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from padstudio.cli.support import check_output, note, progress_bar
from padstudio.experiments.reproduction.experiment import reproduce as make
from padstudio.experiments.reproduction.experiment import wanted
from padstudio.experiments.reproduction.plan import MOST_SEEDS, SEEDS, shots_of
from padstudio.experiments.writers import HTML, MARKDOWN, write_page, write_report

_EXAMPLES = (
    "Examples: [bold]padstudio reproduce -o reproduction[/] · "
    "[bold]padstudio reproduce -o tilts --only attitude --seeds 5[/]"
)

Folder = Annotated[Path, typer.Option("-o", "--output", help="Folder to write into.")]
Seeds = Annotated[
    int, typer.Option(min=1, max=MOST_SEEDS, help="Frames of each place, each different.")
]
Only = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME",
        help="An experiment, again for more: stages, ranges, vertical, horizontal, attitude, "
        "landing, continuity. All of them if not given.",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(min=1, max=64, help="Processes; one for each core if not given."),
]
Page = Annotated[
    Path | None,
    typer.Option(help="Also a page of a documentation, its pictures in images/ beside it."),
]
Force = Annotated[bool, typer.Option("--force", help="Write over what is there.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(reproduce)


def reproduce(
    output: Folder,
    seeds: Seeds = SEEDS,
    only: Only = None,
    workers: Workers = None,
    page: Page = None,
    force: Force = False,
) -> None:
    """Make the paper's experiments again on the simulator, with both methods: which claims hold?

    Writes report.md, report.html, a CSV file for each table, and the figures.
    """
    for path in (output, page):
        if path is not None:
            check_output(path, force=force)
    names = wanted(only or ())
    order = {"seeds": seeds, "only": names, "workers": workers or os.cpu_count() or 1}
    frames = len(shots_of(names, seeds))
    with progress_bar("Reading frames", frames) as progress:
        report = make(order, output, lambda done, total: progress(done))
    files = write_report(report, output)
    if page is not None:
        files += write_page(report, page)
    for section in report.sections:
        for claim in section.claims:
            print(claim.text, claim.sentence, claim.because)
    note(f"{output}: {frames} frames; {MARKDOWN}, {HTML} and {len(files) - 2} more files")
