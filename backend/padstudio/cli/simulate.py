"""``padstudio simulate``: pictures of a pad with their truth."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from padstudio.cli.support import NoDistortion, check_output, note, open_camera, progress_bar
from padstudio.errors import ConflictError
from padstudio.pad.spec import Pad
from padstudio.simulate import disturbances, looks, trajectories, writer
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.trajectories import Flight, Setup

_EXAMPLES = (
    "Examples: [bold]padstudio simulate --pad pad.json --camera preset-dji-mini-27k -o sim[/] · "
    "[bold]padstudio simulate --pad pad.json --camera camera.yaml --flight landing --frames 150 "
    "--look drone-shadow --with vibration=93:0.1 --with readout=20 -o landing[/] · "
    "[bold]padstudio simulate --pad pad.json --camera camera.yaml --flight tilts --from-mm 500 "
    "--frames 8 --ground gravel -o tilts[/]"
)

CameraName = Annotated[
    str, typer.Option(help="Camera file, or a preset's id (see: padstudio cameras).")
]
Folder = Annotated[Path, typer.Option("-o", "--output", help="Folder to write into.")]
PadFile = Annotated[Path | None, typer.Option(help="Pad file; without one the ground is bare.")]
Kind = Annotated[str, typer.Option(help="descent, hover, landing, gusty or tilts.")]
Count = Annotated[int, typer.Option(help="How many frames.")]
FromHeight = Annotated[float, typer.Option(help="Height at the start (tilts: distance), mm.")]
ToHeight = Annotated[float, typer.Option(help="Height at the end, mm.")]
Rate = Annotated[float, typer.Option(help="Frames a second of a video.")]
Sway = Annotated[float, typer.Option(help="Scales how the camera wanders and leans.")]
LookName = Annotated[
    str, typer.Option(help="Conditions: clear, shadow, dusk, glare, … (--list-looks).")
]
With = Annotated[
    list[str] | None,
    typer.Option(
        "--with",
        metavar="NAME=VALUE",
        help="A disturbance, again for more: fog=30, leaves=0.4, vibration=93:0.1, sensor=mono, "
        "waves=2:300, tiles=6x5, … (--list-disturbances).",
    ),
]
Ground = Annotated[
    str, typer.Option(help="grass, gravel, asphalt, bricks, concrete, sand, snow or plain.")
]
Quiet = Annotated[
    float | None, typer.Option(help="White margin round the pad; the pad's own if not given.")
]
Stills = Annotated[bool, typer.Option("--stills", help="Stills where a video is usual.")]
CodecName = Annotated[str, typer.Option(help="h264 or h265.")]
Seed = Annotated[int, typer.Option(help="The same seed gives the same pictures.")]
ListLooks = Annotated[
    bool, typer.Option("--list-looks", is_eager=True, callback=lambda on: _list_looks(on))
]
ListWords = Annotated[
    bool, typer.Option("--list-disturbances", is_eager=True, callback=lambda on: _list_words(on))
]
Force = Annotated[bool, typer.Option("--force", help="Write into a folder that is there.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(simulate)


def simulate(
    camera: CameraName,
    output: Folder,
    no_distortion: NoDistortion = False,
    pad: PadFile = None,
    flight: Kind = "descent",
    frames: Count = 24,
    from_mm: FromHeight = 3000,
    to_mm: ToHeight = 100,
    fps: Rate = 30,
    sway: Sway = 1,
    look: LookName = "clear",
    with_: With = None,
    ground: Ground = "grass",
    quiet_mm: Quiet = None,
    stills: Stills = False,
    codec: CodecName = "h264",
    seed: Seed = 1,
    list_looks: ListLooks = False,
    list_disturbances: ListWords = False,
    force: Force = False,
) -> None:
    """Simulate flights over a pad: pictures as a real camera takes them, and the true poses.

    Writes stills/ or flights/ with a truth file, and the pad and the camera beside them.
    """
    if output.exists() and not force:
        raise ConflictError(
            f"{output} exists; give another name, or --force to write into it", code="file_exists"
        )
    check_output(output, force=True)
    for each in (pad, camera.rpartition("#")[0] or camera):
        if each and Path(each).is_file() and output.resolve() in Path(each).resolve().parents:
            raise ConflictError(
                f"{each} lies in {output}, which is written over; name another folder",
                code="output_is_input",
            )
    spec = trajectories.FlightSpec(
        kind=flight,  # type: ignore[arg-type]  # FlightSpec names the choices itself
        frames=frames,
        from_mm=from_mm,
        to_mm=to_mm,
        fps=fps,
        seed=seed,
        sway=sway,
        vibrations=disturbances.vibrations_of(with_ or (), seed=seed),
    )
    course = trajectories.plan(spec)
    scene = Scene(
        pad=Pad.load(pad) if pad else None,
        quiet_mm=quiet_mm,
        ground=ground,  # type: ignore[arg-type]  # Scene names the choices itself
        ground_seed=seed,
    )
    dressed, imaging = looks.dress(scene, look, seed=seed, words=with_ or ())
    setup = Setup(
        scene=dressed,
        camera=open_camera(camera, no_distortion=no_distortion),
        imaging=imaging,
        seed=seed,
    )
    film = codec if flight in trajectories.VIDEO_KINDS and not stills else None
    truth = _write(output, course, setup, film)
    note(f"{output}: {len(course)} frames, the true poses in {truth.relative_to(output)}")


def _write(output: Path, course: Flight, setup: Setup, codec: str | None) -> Path:
    """Render into a folder under a progress bar; stills where there is no codec."""
    with progress_bar("Rendering", len(course)) as progress:
        return writer.write_flight(
            output,
            course,
            setup,
            codec=codec,  # type: ignore[arg-type]  # VideoWriter names the choices itself
            progress=progress,
        )


def _list_looks(wanted: bool) -> None:
    if wanted:
        for name, look in looks.LOOKS.items():
            print(f"{name:14}{look.note}")
        raise typer.Exit


def _list_words(wanted: bool) -> None:
    if wanted:
        for name, word in disturbances.WORDS.items():
            print(f"{name + '=' + word.form:22}{word.note}")
        raise typer.Exit
