"""``padstudio readout``: how long a camera's shutter rolls, from a clip in which it shakes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from padstudio.arrays import Image, YuvFrame
from padstudio.cli.support import NoDistortion, check_output, note, open_camera, progress_bar
from padstudio.geometry.camera import Camera
from padstudio.media.video_frames import read_frames
from padstudio.media.video_index import read_index
from padstudio.pad.spec import Pad
from padstudio.vision.readout import MOST_FRAMES, Readout, estimate_readout

_EXAMPLES = (
    "Example: [bold]padstudio readout shaken.mp4 --pad pad.json --camera camera.yaml "
    "-o camera.yaml --force[/]"
)


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(readout)


def readout(
    clip: Annotated[Path, typer.Argument(help="Video of the pad, the camera shaken.")],
    pad: Annotated[Path, typer.Option(help="Pad file.")],
    camera: Annotated[
        str, typer.Option(help="Camera file, or a preset's id (see: padstudio cameras).")
    ],
    no_distortion: NoDistortion = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Camera file to write, with the readout time in it."),
    ] = None,
    frames: Annotated[
        int, typer.Option(min=20, help="Most frames to read, from the first one.")
    ] = MOST_FRAMES,
    force: Annotated[bool, typer.Option("--force", help="Write over an existing file.")] = False,
) -> None:
    """Estimate how long a camera's shutter rolls, from a clip in which it shakes.

    Hold the pad in view for some seconds and shake the camera by some degrees, two or three times a
    second, without stabilisation.
    """
    if output is not None:
        check_output(output, force=force)
    the_camera = open_camera(camera, no_distortion=no_distortion)
    found = _estimate(clip, Pad.load(pad), replace(the_camera, readout_ms=None), frames)
    typer.echo(f"{found.readout_ms:.2f} ms ± {found.sigma_ms:.2f} ms, from {found.frames} frames")
    if output is not None:
        told = replace(the_camera, readout_ms=round(found.readout_ms, 2))
        output.write_text(told.to_ros_yaml(), encoding="utf-8")
        note(f"{output}: readout_ms: {told.readout_ms:g}")


def _estimate(clip: Path, pad: Pad, camera: Camera, most: int) -> Readout:
    index = read_index(clip.as_posix())
    pts, every = index.pts[:most].tolist(), index.times_s()[:most].tolist()
    times_s: list[float] = []

    def pictures() -> Iterator[Image | YuvFrame]:
        with progress_bar("Reading", len(pts)) as progress:
            shown = read_frames(clip.as_posix(), pts, is_counted=index.is_counted)
            for place, (picture, time_s) in enumerate(zip(shown, every, strict=False)):
                progress(place + 1)
                if picture.frame is not None:
                    times_s.append(time_s)
                    yield picture.frame

    return estimate_readout(pad, camera, pictures(), times_s)
