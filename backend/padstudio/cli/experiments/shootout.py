"""``padstudio shootout``: the pad against other boards of its size."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from padstudio.cli.support import NoDistortion, check_output, note, open_camera, progress_bar
from padstudio.errors import ConflictError
from padstudio.experiments.shootout.boards.catalogue import BOARDS, USUAL
from padstudio.experiments.shootout.contest import Contest, compete
from padstudio.experiments.shootout.entry import title_of
from padstudio.experiments.shootout.order import Shootout
from padstudio.experiments.shootout.report import report_of
from padstudio.experiments.writers import write_report
from padstudio.pad.spec import Pad

_EXAMPLES = (
    "Examples: [bold]padstudio shootout --pad pad.json --camera preset-dji-mini-27k -o out[/] · "
    "[bold]padstudio shootout --pad pad.json --camera camera.yaml --flight edge --from-mm 4000 "
    "--board aruco-board --board apriltag-nested -o edge[/] · "
    "[bold]padstudio shootout --pad pad.json --camera camera.yaml --flight landing --frames 60 "
    "--from-mm 2000 --with vibration=93:0.1 --with readout=20 -o landing[/]"
)

PadFile = Annotated[Path, typer.Option(help="Pad file; all boards are printed at its size.")]
CameraName = Annotated[
    str, typer.Option(help="Camera file, or a preset's id (see: padstudio cameras).")
]
Folder = Annotated[Path, typer.Option("-o", "--output", help="Folder to write the report into.")]
Kind = Annotated[str, typer.Option(help="descent, edge, tilts, hover, landing or gusty.")]
Count = Annotated[int, typer.Option(help="How many frames of each board.")]
FromHeight = Annotated[float, typer.Option(help="Height at the start (tilts: distance), mm.")]
ToHeight = Annotated[float, typer.Option(help="Height at the end, mm.")]
Sway = Annotated[float, typer.Option(help="Scales how the camera wanders and leans.")]
LookName = Annotated[
    str,
    typer.Option(help="Conditions: clear, shadow, dusk, … (padstudio simulate --list-looks)."),
]
With = Annotated[
    list[str] | None,
    typer.Option(
        "--with",
        metavar="NAME=VALUE",
        help="A disturbance, again for more: fog=30, vibration=93:0.1, … (padstudio simulate "
        "--list-disturbances).",
    ),
]
Ground = Annotated[
    str, typer.Option(help="grass, gravel, asphalt, bricks, concrete, sand, snow or plain.")
]
BoardNames = Annotated[
    list[str] | None,
    typer.Option(
        "--board", metavar="NAME", help="A board to compare with, again for more (--list-boards)."
    ),
]
ListBoards = Annotated[
    bool, typer.Option("--list-boards", is_eager=True, callback=lambda on: _list_boards(on))
]
Seed = Annotated[int, typer.Option(help="The same seed gives the same frames.")]
Force = Annotated[bool, typer.Option("--force", help="Write into a folder that is there.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(shootout)


def shootout(
    pad: PadFile,
    camera: CameraName,
    output: Folder,
    no_distortion: NoDistortion = False,
    flight: Kind = "descent",
    frames: Count = 24,
    from_mm: FromHeight = 16_000,
    to_mm: ToHeight = 60,
    sway: Sway = 1,
    look: LookName = "clear",
    with_: With = None,
    ground: Ground = "grass",
    board: BoardNames = None,
    list_boards: ListBoards = False,
    seed: Seed = 1,
    force: Force = False,
) -> None:
    """Compare a pad with other boards of its printed size on the same simulated flight.

    Which frames each reads, how exactly and how fast, and where another board is better: as
    Markdown, HTML and CSV. Readers whose libraries are not installed are named and left out.
    """
    check_output(output, force=force)
    if output.is_file():
        raise ConflictError(f"{output} is a file; name a folder", code="file_exists")
    order = Shootout(
        pad=Pad.load(pad),
        camera=open_camera(camera, no_distortion=no_distortion),
        flight=flight,
        frames=frames,
        from_mm=from_mm,
        to_mm=to_mm,
        sway=sway,
        look=look,
        disturbances=tuple(with_ or ()),
        ground=ground,
        boards=tuple(board or USUAL),
        seed=seed,
    )
    with progress_bar("Shoot-out", 1.0, counted=False) as progress:
        contest = compete(order, lambda done, total: progress(done / total))
    write_report(report_of(contest), output)
    _tell(contest)
    note(f"{output}: report.md, report.html, tables as CSV, pictures")


def _tell(contest: Contest) -> None:
    for name, reason in contest.left_out.items():
        note(f"{title_of(name)} is left out: {reason}")
    for entry in contest.entries:
        for trouble in entry.troubles:
            note(f"{entry.title}, {entry.setting}: {trouble}")
        read = sum(outcome.verdict == "read" for outcome in entry.outcomes)
        name = f"{entry.title}, {entry.setting}"
        note(f"{name:30}{read:4} of {len(entry.outcomes)} read")


def _list_boards(wanted: bool) -> None:
    if wanted:
        for name, board in BOARDS.items():
            missing = f" (not installed: {board.missing})" if board.missing else ""
            print(f"{name:18}{board.note}{missing}")
        raise typer.Exit
