"""``padstudio bundle``: one frame with all that its result rests on, in one zip."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from padstudio.cli.support import NoDistortion, check_output, note, open_camera
from padstudio.flights import batch
from padstudio.flights.bundles.contents import Bundle, pack
from padstudio.flights.bundles.making import Beside, RunFrame, Wish, bundle_run, bundle_still
from padstudio.flights.tasks.detectors import Recipe, params_from, params_of_words
from padstudio.flights.tasks.frames import FramesTask, VideoPart
from padstudio.media import images
from padstudio.media.sources import kind_of
from padstudio.pad.spec import Pad

Source = Annotated[
    Path, typer.Argument(help="A still (JPEG, PNG, WebP, TIFF or BMP), or a video with --frame.")
]
PadFiles = Annotated[
    list[Path], typer.Option("--pad", help="Pad file; again for more pads that may be in view.")
]
CameraName = Annotated[str, typer.Option(help="Camera file, or a preset's id.")]
Output = Annotated[Path, typer.Option("-o", "--output", help="The bundle to write, *.zip.")]
FrameNumber = Annotated[
    int | None, typer.Option("--frame", min=0, help="Of a video: the frame's number, from 0.")
]
Stride = Annotated[int, typer.Option(min=1, help="Of a video: as of padstudio detect.")]
Rotation = Annotated[bool, typer.Option(help="Turn a video as its rotation flag says.")]
MethodName = Annotated[Literal["dense", "paper"], typer.Option(help="How it is read.")]
Param = Annotated[
    list[str] | None,
    typer.Option("--param", metavar="NAME=VALUE", help="A detector parameter; again for more."),
]
Force = Annotated[bool, typer.Option("--force", help="Write over an existing file.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(bundle)


def bundle(
    source: Source,
    pad: PadFiles,
    camera: CameraName,
    output: Output,
    no_distortion: NoDistortion = False,
    frame: FrameNumber = None,
    stride: Stride = 1,
    apply_rotation: Rotation = True,
    method: MethodName = "dense",
    param: Param = None,
    force: Force = False,
) -> None:
    """Bundle a frame with all that its result rests on, in one zip.

    That is its pads, camera, parameters, result, stages and versions; of a video's frame, too, the
    frames beside it, and what following the pad knew before it. padstudio replay reads it again,
    on any machine.
    """
    check_output(output, force=force)
    params = params_of_words(param or [])
    params_from(params)
    first, *others = (Pad.load(each).dumps() for each in pad)
    texts = json.dumps(params, sort_keys=True)
    recipe = Recipe(
        first,
        open_camera(camera, no_distortion=no_distortion).to_ros_yaml(),
        method,
        texts,
        tuple(others),
    )
    if kind_of(source) in ("video", "recording"):
        if frame is None:
            raise typer.BadParameter(f"{source.name} is a video: say which frame with --frame")
        pieces = batch.plan([source], recipe, stride=stride, apply_rotation=apply_rotation)
        made = bundle_run(_run_frame(pieces, frame), Wish(method, texts))
    else:
        if frame is not None:
            raise typer.BadParameter(f"{source.name} is a still: leave --frame out")
        made = bundle_still(recipe, images.read_file(source), source.name)
    output.write_bytes(pack(made))
    place = source.name if frame is None else f"{source.name}, frame {frame}"
    note(f"{output}: {place}, {_in_words(made)}")


def _run_frame(pieces: Sequence[batch.Piece], frame: int) -> RunFrame:
    """A frame as padstudio detect reads it, before poses are fused."""
    numbers = [number for piece in pieces for number in piece.numbers]
    if isinstance(pieces[0].task, batch.Unread):
        raise pieces[0].task.error
    if frame not in numbers:
        raise typer.BadParameter(
            f"frame {frame} is not read: frames are {numbers[0]} to {numbers[-1]}"
            + (f", every {pieces[0].numbers.step}" if pieces[0].numbers.step > 1 else "")
        )
    place = numbers.index(frame)
    beside = tuple(
        Beside(offset, _part(pieces, numbers[place + offset], 1)[0])
        for offset in (-1, 1)
        if 0 <= place + offset < len(numbers)
    )
    part, recipe = _part(pieces, frame, None)
    return RunFrame(recipe, part, beside=beside)


def _part(pieces: Sequence[batch.Piece], frame: int, count: int | None) -> tuple[VideoPart, Recipe]:
    """A frame with those before it that are read in one go, or the last `count` of them."""
    piece = next(each for each in pieces if frame in each.numbers)
    assert isinstance(piece.task, FramesTask)
    assert isinstance(piece.task.part, VideoPart)
    end = piece.numbers.index(frame) + 1
    first = 0 if count is None else end - count
    # Bundles go to others: no paths of this machine.
    part = piece.task.part
    return replace(part, name=Path(part.name).name).between(first, end), piece.task.recipe


def _in_words(made: Bundle) -> str:
    """What the frame gave; of a video's, followed and by itself."""
    words = _outcome(made.result)
    return words if made.alone is None else f"{words}; by itself {_outcome(made.alone.result)}"


def _outcome(result: dict[str, Any]) -> str:
    return "pose" if result["status"] == "ok" else f"{result['stage']}: {result['reason']}"
