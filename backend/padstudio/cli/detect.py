"""``padstudio detect``: poses of stills and videos, as JSON lines."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import logging
import os
import sys
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Annotated, Any, Literal

import typer

from padstudio.cli.outcomes import (
    EXIT_NOTHING_FOUND,
    Figures,
    figures_of,
    show_summary,
    write_record,
)
from padstudio.cli.reading_options import (
    AtRest,
    Fuse,
    MethodName,
    Output,
    Param,
    Quiet,
    Rotation,
    Smooth,
    Stride,
    Topic,
    Unmix,
)
from padstudio.cli.support import (
    NoDistortion,
    check_output,
    check_said,
    note,
    open_camera,
    progress_bar,
)
from padstudio.errors import StudioError
from padstudio.flights import batch
from padstudio.flights.results.fusing import Fusion
from padstudio.flights.results.poses_file import cut_unfinished_line, read_poses
from padstudio.flights.tasks.detectors import (
    Recipe,
    detector_for,
    params_from,
    params_of_words,
)
from padstudio.geometry.camera import Camera
from padstudio.media.sources import find_frames, kind_of
from padstudio.pad.spec import Pad

# Below this many frames a process, starting it costs more than it saves.
_FRAMES_PER_JOB = 4

_EXAMPLES = (
    "Examples: [bold]padstudio detect --pad pad.json --camera camera.yaml frames/ flight.mp4 "
    "-o poses.jsonl --resume[/]"
    " · [bold]padstudio detect --pad pad.json --camera preset-dji-mini-27k 'flight/**/*.jpg' -o - "
    "| jq .position_mm[/]"
)


Frames = Annotated[
    list[str],
    typer.Argument(help="Pictures, videos, ROS bags, MCAP, folders, or patterns such as **/*.jpg."),
]
PadFiles = Annotated[
    list[Path], typer.Option("--pad", help="Pad file; again for more pads that stills may show.")
]
CameraName = Annotated[
    str | None,
    typer.Option(
        help="Camera file, or a preset's id (see: padstudio cameras); recordings may bring theirs."
    ),
]
Jobs = Annotated[
    int,
    typer.Option("-j", "--jobs", min=0, max=256, help="Processes; 0 takes one for every core."),
]
Resume = Annotated[
    bool, typer.Option("--resume", help="Go on with an existing file: read what it lacks.")
]
Force = Annotated[bool, typer.Option("--force", help="Write over an existing file.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(detect)


def detect(
    frames: Frames,
    pad: PadFiles,
    camera: CameraName = None,
    no_distortion: NoDistortion = False,
    output: Output = "-",
    topic: Topic = None,
    method: MethodName = "dense",
    unmix: Unmix = True,
    at_rest: AtRest = False,
    param: Param = None,
    jobs: Jobs = 0,
    stride: Stride = 1,
    apply_rotation: Rotation = True,
    fuse: Fuse = True,
    smooth: Smooth = False,
    resume: Resume = False,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Find the pad in frames and write their poses, one JSON object a line.

    With several pads, each one that a still shows gives a line, and pad_id says which it is.

    A frame that cannot be read is one line with status failed, and one on stderr; the others go on.
    A run that was broken off goes on with --resume and the same arguments. EXIF orientation of
    stills is not applied, as calibrations are of the sensor's own frame.

    The exit code is 0 if at least one frame gave a pose, 1 if none did, 2 for wrong input.
    """
    if not os.environ.get("PADSTUDIO_DEBUG"):
        # A defect is one line like other errors; its traceback is for who looks for it.
        logging.getLogger("padstudio").setLevel(logging.CRITICAL)
    settings = params_of_words(param or [])
    if not unmix:
        settings.setdefault("prepare", {})["unmix"] = False
    if at_rest:
        settings.setdefault("refine", {})["at_rest"] = True
    params_from(settings)
    fusion = _fusion(fuse, smooth)
    paths = find_frames(frames)
    check_said(paths, topic=topic, camera=camera, no_distortion=no_distortion)
    if camera is None:
        the_camera = _recorded_camera(paths, topic)
    else:
        the_camera = open_camera(camera, no_distortion=no_distortion)
    recipe = _recipe(pad, the_camera, method, settings)
    run = _run_of(recipe, fusion, stride, apply_rotation, topic)
    target = _Target(output, run, paths)
    pieces = batch.plan(paths, recipe, stride=stride, apply_rotation=apply_rotation, topic=topic)
    with target.opened(resume=resume, force=force) as (file, earlier):
        _check_same_run(earlier, pieces)
        total = sum(len(piece.numbers) for piece in pieces)
        outcomes, frames_done, last = list(earlier.values()), len(earlier), None
        with progress_bar("Detecting", total) as progress:
            progress(frames_done)
            workers = _jobs(jobs, total, len(pieces))
            for record in batch.detect(pieces, jobs=workers, done=earlier, fusion=fusion):
                outcomes.append(write_record(record | target.about, file))
                place = record["source"], record["frame"]
                frames_done, last = frames_done + (place != last), place
                progress(frames_done)
    if not quiet:
        show_summary(outcomes)
    if not any(figures["ok"] for figures in outcomes):
        raise typer.Exit(EXIT_NOTHING_FOUND)


def _recorded_camera(paths: list[Path], topic: str | None) -> Camera:
    """The calibration that recordings bring along."""
    from padstudio.media.recordings.topics import camera_of, look

    if any(kind_of(path) != "recording" for path in paths):
        raise typer.BadParameter("--camera is missing; only recordings may bring a calibration")
    camera = Camera.loads(camera_of([look(str(path), topic) for path in paths]))
    note(f"camera {camera.name}: the calibration in the recording")
    return camera


def _recipe(
    pads: list[Path],
    the_camera: Camera,
    method: Literal["dense", "paper"],
    params: dict[str, Any],
) -> Recipe:
    if the_camera.nominal:
        note(f"camera {the_camera.name}: nominal, calibrate for accuracy")
    first, *others = (Pad.load(pad).dumps() for pad in pads)
    recipe = Recipe(first, the_camera.to_ros_yaml(), method, json.dumps(params), tuple(others))
    if others:
        # Pads that cannot be told apart are refused before any file is written.
        detector_for(recipe)
    return recipe


def _fusion(fuse: bool, smooth: bool) -> Fusion:
    if smooth and not fuse:
        raise typer.BadParameter("--smooth fuses poses; it excludes --no-fuse")
    return "smooth" if smooth else "filter" if fuse else "none"


def _jobs(asked: int, frames: int, pieces: int) -> int:
    return asked or max(1, min(os.cpu_count() or 1, frames // _FRAMES_PER_JOB, pieces))


def _run_of(recipe: Recipe, *how: object) -> str:
    """A short word for all that decides on the poses of a frame, whatever the run's frames are."""
    told = json.dumps([dataclasses.astuple(recipe), *how])
    return hashlib.sha256(told.encode()).hexdigest()[:16]


@dataclasses.dataclass(frozen=True)
class _Target:
    """Where records go.

    Attributes
    ----------
    output : str
        Of the option.
    run : str
        As of `_run_of`.
    inputs : sequence of Path
        Frames that are read, which it must not be.
    """

    output: str
    run: str
    inputs: Sequence[Path]

    @property
    def about(self) -> dict[str, str]:
        """What records say in a file, with which a run may go on."""
        return {} if self.output == "-" else {"run": self.run}

    @contextmanager
    def opened(
        self, *, resume: bool, force: bool
    ) -> Iterator[tuple[IO[str], dict[tuple[str, int], Figures]]]:
        """The file to write to, and the figures of the frames that it holds already."""
        if resume and (self.output == "-" or force):
            raise typer.BadParameter("--resume goes on with the file of -o; it excludes --force")
        if self.output == "-":
            yield sys.stdout, {}
            return
        path = Path(self.output)
        goes_on = resume and path.exists()
        check_output(path, force=force or goes_on, inputs=self.inputs)
        earlier = self._earlier(path) if goes_on else {}
        with path.open("a" if earlier else "w", encoding="utf-8") as file:
            yield file, earlier

    def _earlier(self, path: Path) -> dict[tuple[str, int], Figures]:
        """What a poses file of this run holds; a last line that was cut off is cut away."""
        found: dict[tuple[str, int], Figures] = {}
        for record in read_poses(path, may_be_cut=True):
            if record.get("run") != self.run:
                raise StudioError(
                    f"{path.name} was made with another camera, pad, method, parameters or other "
                    "options, or by a version that did not note them; --resume takes those of the "
                    "first run, else make the file anew with --force",
                    code="another_run",
                )
            found[record["source"], record["frame"]] = figures_of(record)
        cut_unfinished_line(path)
        return found


def _check_same_run(earlier: Collection[tuple[str, int]], pieces: Sequence[batch.Piece]) -> None:
    """Refuse to go on with a file whose frames are not among those that are asked for."""
    numbers: dict[str, set[int]] = {}
    for piece in pieces:
        numbers.setdefault(piece.source, set()).update(piece.numbers)
    for source, frame in earlier:
        if frame not in numbers.get(source, ()):
            raise StudioError(
                f"the file holds frame {frame} of {source}, which is none of this run's; --resume "
                "takes the arguments of the first run, with which files of older versions, that "
                "number the frames of each source from 0, have to be made anew",
                code="another_run",
            )
