"""``padstudio export``: a poses file in other programs' forms."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import typer

from padstudio.cli.support import check_output, note
from padstudio.flights.exports import forms
from padstudio.flights.exports.forms import FULL_POSES_ONLY
from padstudio.flights.exports.options import ExportOptions
from padstudio.flights.exports.pads import check_pad, of_pad
from padstudio.flights.exports.sources import FilePictures
from padstudio.flights.exports.vehicle import Mount, VehicleTrack
from padstudio.flights.results.poses_file import read_poses
from padstudio.geometry.presets import load_camera
from padstudio.pad.spec import Pad

_EXAMPLES = (
    "Examples: [bold]padstudio export poses.jsonl --form tum -o flight.tum.txt[/] · "
    "[bold]padstudio export poses.jsonl --form mcap --camera camera.yaml --pad pad.json --images "
    "-o flight.mcap[/]"
)

_LEFT_OUT = ("quality bearing", "unknown quality")

PosesFile = Annotated[Path, typer.Argument(help="Poses file (*.jsonl).")]
FormName = Annotated[
    Literal["csv", "jsonl", "tum", "colmap", "mcap", "ardupilot", "px4"],
    typer.Option(help="The form to write."),
]
Output = Annotated[str, typer.Option("-o", "--output", help="File to write; - is stdout.")]
CameraName = Annotated[
    str | None,
    typer.Option(help="Camera file or a preset's id, of the frames; for colmap and mcap."),
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
Start = Annotated[float, typer.Option(min=0, help="Unix time of the flight's time 0, s.")]
Vehicle = Annotated[
    Path | None, typer.Option(help="Poses of the vehicle for px4, CSV; see docs/exports.md.")
]
Turned = Annotated[
    float, typer.Option(help="Of MAVLink: camera turned clockwise; at 0 its up is forward.")
]
Forward = Annotated[float, typer.Option(help="Camera ahead of the vehicle's centre.")]
Right = Annotated[float, typer.Option(help="Camera to the right of it.")]
Down = Annotated[float, typer.Option(help="Camera below it.")]
Force = Annotated[bool, typer.Option("--force", help="Write over an existing file.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(export)


def export(
    poses: PosesFile,
    form: FormName,
    output: Output = "-",
    camera: CameraName = None,
    pad: PadFile = None,
    pad_id: PadId = None,
    images: Images = False,
    start_unix_s: Start = 0.0,
    vehicle: Vehicle = None,
    turned_deg: Turned = 0.0,
    forward_m: Forward = 0.0,
    right_m: Right = 0.0,
    down_m: Down = 0.0,
    force: Force = False,
) -> None:
    """Write a poses file in the form of another program."""
    options = ExportOptions(
        camera=None if camera is None else load_camera(camera),
        pad_size_mm=None if pad is None else Pad.load(pad).size_mm,
        picture=FilePictures(Path()) if images else None,
        start_unix_s=start_unix_s,
        mount=Mount.downward(turned_deg, np.array([forward_m, right_m, down_m])),
        vehicle=None if vehicle is None else _track(vehicle),
    )
    # Read once in advance, so that a fault in the last line leaves no file behind.
    pads = {record["pad_id"] for record in read_poses(poses) if "pad_id" in record}
    check_pad(form, pads, pad_id)
    qualities = Counter(_quality(record) for record in of_pad(read_poses(poses), pad_id))
    blocks = forms.export(form, of_pad(read_poses(poses), pad_id), options)
    if output == "-":
        for block in blocks:
            sys.stdout.buffer.write(block)
        _say_left_out(form, qualities)
        return
    path = Path(output)
    check_output(path, force=force)
    with path.open("wb") as file:
        file.writelines(blocks)
    note(f"{path}: {qualities.total()} frames as {form}")
    _say_left_out(form, qualities)


def _say_left_out(form: str, qualities: Counter[str]) -> None:
    for quality in _LEFT_OUT if form in FULL_POSES_ONLY else ():
        count = qualities[quality]
        if count:
            poses = f"1 pose of {quality} is" if count == 1 else f"{count} poses of {quality} are"
            note(f"{poses} left out, as {form} holds full poses only")


def _quality(record: dict[str, Any]) -> str:
    """What `_say_left_out` calls it; of a failed frame nothing."""
    names = {"bearing": "quality bearing", None: "unknown quality"}
    return names.get(record.get("quality"), "") if record["status"] == "ok" else ""


def _track(path: Path) -> VehicleTrack:
    with path.open(encoding="utf-8-sig") as file:
        return VehicleTrack.from_csv(file)
