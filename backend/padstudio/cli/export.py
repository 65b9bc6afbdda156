"""``padstudio export``: a poses file in other programs' forms."""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import typer

from padstudio.autopilot.vehicle import Mount, VehicleTrack
from padstudio.bounded_files import open_regular
from padstudio.cli.support import (
    Down,
    Forward,
    NoDistortion,
    Right,
    Turned,
    check_output,
    finite,
    note,
    open_camera,
)
from padstudio.flights.exports.forms import FULL_POSES_ONLY
from padstudio.flights.exports.from_file import PosesFile, export_file
from padstudio.flights.exports.options import ExportChoices
from padstudio.media import content
from padstudio.media.telemetry.reading import read
from padstudio.pad.spec import Pad

_EXAMPLES = (
    "Examples: [bold]padstudio export poses.jsonl --form tum -o flight.tum.txt[/] · "
    "[bold]padstudio export poses.jsonl --form mcap --camera camera.yaml --pad pad.json --images "
    "-o flight.mcap[/]"
)

_LEFT_OUT = {"bearing": "quality bearing", "unknown": "unknown quality"}


Poses = Annotated[Path, typer.Argument(help="Poses file (*.jsonl).")]
FormName = Annotated[
    Literal["csv", "jsonl", "tum", "colmap", "mcap", "ros2", "ardupilot", "px4"],
    typer.Option(help="The form to write."),
]
Output = Annotated[str, typer.Option("-o", "--output", help="File to write; - is stdout.")]
CameraName = Annotated[
    str | None,
    typer.Option(help="Camera file or a preset's id; for colmap and mcap."),
]
PadFile = Annotated[
    Path | None, typer.Option(help="Pad file; its size is drawn in mcap and said in MAVLink.")
]
PadId = Annotated[
    str | None, typer.Option(help="Of poses of several pads, those of this one (see pad_id).")
]
Images = Annotated[
    bool, typer.Option("--images", help="Put the frames into mcap; sources must be there.")
]
FrameSize = Annotated[
    str | None,
    typer.Option(help="Of poses files that do not say it: width x height, as 1920x1080."),
]
# Bounds as in REST.
Start = Annotated[
    float,
    typer.Option(min=0, max=2**33, callback=finite, help="Unix time of the flight's time 0, s."),
]
Vehicle = Annotated[
    Path | None,
    typer.Option(help="Where the vehicle was, for px4: its log, or a CSV; see docs/exports.md."),
]
Force = Annotated[bool, typer.Option("--force", help="Write over an existing file.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(export)


def export(
    poses: Poses,
    form: FormName,
    output: Output = "-",
    camera: CameraName = None,
    no_distortion: NoDistortion = False,
    pad: PadFile = None,
    pad_id: PadId = None,
    images: Images = False,
    frame_size: FrameSize = None,
    start_unix_s: Start = 0.0,
    vehicle: Vehicle = None,
    turned_deg: Turned = 0.0,
    forward_m: Forward = 0.0,
    right_m: Right = 0.0,
    down_m: Down = 0.0,
    force: Force = False,
) -> None:
    """Write a poses file in the form of another program."""
    if output != "-":
        check_output(Path(output), force=force)
    choices = ExportChoices(
        form=form,
        pad_id=pad_id,
        images=images,
        start_unix_s=start_unix_s,
        mount=Mount.downward(turned_deg, np.array([forward_m, right_m, down_m])),
        **({} if vehicle is None else _vehicle(vehicle)),
    )
    file = PosesFile(
        path=poses,
        camera=None if camera is None else open_camera(camera, no_distortion=no_distortion),
        pad=None if pad is None else Pad.load(pad),
        frame_px=None if frame_size is None else _size(frame_size),
    )
    found = export_file(file, choices)
    _write(found.blocks, output)
    if output != "-":
        note(f"{output}: {found.survey.qualities.total()} frames as {form}")
    _say_left_out(form, found.survey.qualities)
    for source in found.survey.begin_again:
        note(f"the times of {source} begin again: taken to follow on the source before it")
    if found.files.missing:
        note(f"{found.files.missing} frames are without a picture: their files are not there")


def _write(blocks: Iterator[bytes], output: str) -> None:
    """Write what comes; a file that a fault leaves half written is taken away."""
    if output == "-":
        for block in blocks:
            sys.stdout.buffer.write(block)
        return
    path = Path(output)
    try:
        with path.open("wb") as file:
            file.writelines(blocks)
    except BaseException:
        path.unlink()
        raise


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    if found is None or 0 in (size := (int(found[1]), int(found[2]))):
        raise typer.BadParameter("--frame-size is width x height, as 1920x1080")
    return size


def _say_left_out(form: str, qualities: Counter[str]) -> None:
    for quality, name in _LEFT_OUT.items() if form in FULL_POSES_ONLY else ():
        count = qualities[quality]
        if count:
            poses = f"1 pose of {name} is" if count == 1 else f"{count} poses of {name} are"
            note(f"{poses} left out, as {form} holds full poses only")


def _vehicle(path: Path) -> dict[str, Any]:
    """What `ExportChoices` has of a file of the vehicle's: a table's track, or a log."""
    with open_regular(path) as file:
        is_log = content.is_log(file.read(content.HEAD_BYTES))
    if is_log:
        return {"log": read(str(path))}
    with path.open(encoding="utf-8-sig") as lines:
        return {"vehicle": VehicleTrack.from_csv(lines)}
