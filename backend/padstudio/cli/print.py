"""``padstudio print``: a pad on paper."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Literal, cast

import typer

from padstudio.cli.support import check_output, note
from padstudio.pad.print_scale import print_scale
from padstudio.pad.sheets.tiling import SheetOptions, SheetPlan, plan_sheets
from padstudio.pad.spec import Pad
from padstudio.render import documents
from padstudio.render.documents import Form
from padstudio.render.painters.options import PrintOptions

_EXAMPLES = (
    "Examples: [bold]padstudio print pad.json -o pad.pdf[/] (one page of the pad's own size) · "
    "[bold]padstudio print pad.json --paper A4 -o sheets.pdf[/] · "
    "[bold]padstudio print pad.json --dpi 300 -o pad.png[/] · "
    "[bold]padstudio print pad.json --form strip --paper A4 -o strip.pdf[/]"
)
PadFile = Annotated[Path, typer.Argument(help="Pad file.")]
Output = Annotated[
    Path,
    typer.Option("-o", "--output", help="File to write: .pdf .svg .png .dxf .csv .npy .zip."),
]
FormName = Annotated[
    str, typer.Option(help="pdf, svg, png, dxf, csv, npy or strip (a colour test strip).")
]
PaperName = Annotated[
    str, typer.Option(help="A4 … A0, Letter, Legal, Tabloid, WIDTHxHEIGHT in mm, or own.")
]
Turned = Annotated[
    Literal["auto", "portrait", "landscape"], typer.Option(help="auto: fewer sheets.")
]
Margin = Annotated[float, typer.Option(help="What the printer leaves blank.")]
JointKind = Annotated[
    Literal["butt", "overlap"], typer.Option(help="Sheets edge to edge, or over each other.")
]
Overlap = Annotated[float, typer.Option(help="Strip under the next sheet.")]
SeamsKind = Annotated[
    Literal["cells", "anywhere"], typer.Option(help="cells: never cut a cell needlessly.")
]
Furniture = Annotated[
    bool | None,
    typer.Option(
        "--furniture/--bare", help="Rulers, labels, cut marks; bare for --paper own if unsaid."
    ),
]
InkKind = Annotated[Literal["rgb", "cmyk"], typer.Option(help="How colours are given.")]
Outline = Annotated[float, typer.Option(help="Line round the quiet margin.")]
Header = Annotated[str, typer.Option(help="Text in the quiet margin above the pad.")]
Footer = Annotated[str, typer.Option(help="Text in the quiet margin below the pad.")]
Code = Annotated[bool, typer.Option(help="Print the pad's id and QR code.")]
AssemblyMap = Annotated[bool, typer.Option(help="Begin with a map of the sheets.")]
Resolution = Annotated[float, typer.Option(help="Resolution of a PNG.")]
Readings = Annotated[
    str,
    typer.Option(
        metavar="X,Y", help="What an earlier print's 200 mm rulers read; corrects this print."
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Write over an existing file.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command("print", epilog=_EXAMPLES)(print_pad)


def print_pad(
    pad: PadFile,
    output: Output,
    form: FormName = "",
    paper: PaperName = "own",
    orientation: Turned = "auto",
    margin_mm: Margin = 5.0,
    joint: JointKind = "butt",
    overlap_mm: Overlap = 10.0,
    seams: SeamsKind = "cells",
    furniture: Furniture = None,
    ink: InkKind = "rgb",
    outline_mm: Outline = 0.0,
    header: Header = "",
    footer: Footer = "",
    qr: Code = True,
    assembly_map: AssemblyMap = True,
    dpi: Resolution = 150.0,
    read: Readings = "",
    force: Force = False,
) -> None:
    """Print a pad: a PDF at true size on any paper, or another form by the file's suffix."""
    check_output(output, force=force)
    # A page of the pad's own size has nothing beside the pad if unsaid.
    own = paper.strip().lower() == "own"
    beside = not own if furniture is None else furniture
    options = PrintOptions(
        sheets=SheetOptions(
            paper=paper,
            orientation=orientation,
            margin_mm=margin_mm if beside or not own else 0.0,
            joint=joint,
            overlap_mm=overlap_mm,
            seams=seams,
            furniture=beside,
        ),
        ink=ink,
        outline_mm=outline_mm,
        header=header,
        footer=footer,
        qr=qr,
        assembly_map=assembly_map,
        dpi=dpi,
        measured=_measured(read),
    )
    chosen = cast(Form, form or output.suffix.lstrip(".").lower().replace("zip", "csv"))
    design = Pad.load(pad)
    pieces, _media_type, _name = documents.make(design, chosen, options)
    with output.open("wb") as file:
        file.writelines(pieces)
    told = _describe(plan_sheets(design, options.sheets)) if chosen == "pdf" else chosen
    note(f"{output}: {told}")


def _measured(read: str) -> tuple[float, float]:
    """Size of prints over nominal size, from two ruler readings; 1 where there are none."""
    if not read:
        return 1.0, 1.0
    found = re.fullmatch(r"(\d+(?:\.\d+)?),(\d+(?:\.\d+)?)", read.replace(" ", ""))
    if found is None:
        raise typer.BadParameter(
            f"{read!r} is not two readings in mm such as 199.2,200.4", param_hint="--read"
        )
    return print_scale(200.0, float(found[1])), print_scale(200.0, float(found[2]))


def _describe(plan: SheetPlan) -> str:
    paper = plan.paper
    size = f"{paper.width_mm:g} x {paper.height_mm:g} mm"
    if len(plan.sheets) == 1:
        return f"1 page, {paper.name}, {size}"
    cells = "on cell edges" if plan.on_cells else "through cells, as they are larger than a sheet"
    if plan.options.seams == "anywhere":
        cells = "anywhere"
    return (
        f"{len(plan.sheets)} sheets {paper.name} {paper.orientation}, {plan.rows} rows x "
        f"{plan.cols} columns, {plan.paper_m2:.2f} m² of paper, seams {cells}"
    )
