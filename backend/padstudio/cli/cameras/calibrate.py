"""``padstudio calibrate``: a camera's intrinsics and lens from pictures of a pad."""

from __future__ import annotations

import json
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from padstudio.calibration.advice import findings, verdicts
from padstudio.calibration.calibrate import calibrate as calibrate_camera
from padstudio.calibration.record import record
from padstudio.calibration.results import Calibration
from padstudio.calibration.sources import DecodedInTurn, NamedPicture, read_pictures
from padstudio.cli.support import check_output, note, progress_bar, show_table
from padstudio.geometry.camera_files.parts.fields import LensModel
from padstudio.media.sources import find_frames
from padstudio.pad.spec import Pad

_EXAMPLES = (
    "Examples: [bold]padstudio calibrate stills/*.jpg --pad pad.json -o camera.yaml[/] · "
    "[bold]padstudio calibrate clip.mp4 --pad pad.json -o camera.yaml --report report.json[/]"
)


class LensChoice(StrEnum):
    """Lens models to choose from."""

    AUTO = "auto"
    RADTAN = "radtan"
    FISHEYE = "fisheye"


_MODELS: dict[LensChoice, tuple[LensModel, ...]] = {
    LensChoice.AUTO: ("radtan", "fisheye"),
    LensChoice.RADTAN: ("radtan",),
    LensChoice.FISHEYE: ("fisheye",),
}


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(calibrate)


def calibrate(
    pictures: Annotated[
        list[str], typer.Argument(help="Stills, folders, patterns, or a clip of the pad.")
    ],
    pad: Annotated[Path, typer.Option(help="Pad file of the print in the pictures.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Camera file to write.")],
    lens: Annotated[
        LensChoice, typer.Option(help="Lens model; auto takes the one that explains most.")
    ] = LensChoice.AUTO,
    report: Annotated[
        Path | None, typer.Option(help="Also write all figures as JSON, picture by picture.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Write over existing files.")] = False,
) -> None:
    """Calibrate a camera: intrinsics and lens, from a dozen pictures of a pad or a short clip.

    Lay the pad flat, keep zoom and focus, hold still, and take it from straight above and from
    20 to 45 degrees aside, large, and once in every corner of the picture.
    """
    paths = find_frames(pictures)
    for path in (output, report):
        if path is not None:
            check_output(path, force=force, inputs=paths)
    the_pad = Pad.load(pad)
    shown = read_pictures([(path.name, path) for path in paths])
    found = _calibrated(the_pad, shown, lens)
    _show(found, shown)
    camera = replace(found.camera, name=output.stem)
    output.write_text(camera.to_ros_yaml(), encoding="utf-8")
    if report is not None:
        said = record(found, [each.name for each in shown])
        report.write_text(json.dumps(said, indent=1), encoding="utf-8")
    note(f"{output}: {camera.width} x {camera.height}, {camera.model}")


def _calibrated(pad: Pad, shown: list[NamedPicture], lens: LensChoice) -> Calibration:
    with progress_bar("Calibrating", 100) as progress:
        return calibrate_camera(
            pad,
            DecodedInTurn(shown),
            models=_MODELS[lens],
            progress=lambda done, total: progress(100 * done // total),
        )


def _show(found: Calibration, shown: list[NamedPicture]) -> None:
    said = record(found, [each.name for each in shown])
    show_table(
        ("parameter", "value", "one sigma"),
        [
            (each["name"], f"{each['value']:.6g}", f"± {each['sigma']:.2g}")
            for each in (*said["intrinsics"], *said["distortion"])
        ],
    )
    note(f"residuals {found.rms_px:.3f} px; {len(found.used)} of {len(found.views)} pictures used")
    for picture, verdict in zip(shown, verdicts(found), strict=True):
        if verdict.message:
            note(f"{picture.name}: {verdict.message}")
    for finding in findings(found):
        note(f"warning: {finding.message}")
