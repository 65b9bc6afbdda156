"""``padstudio simulate``: pictures of a pad with their truth."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from padstudio.cli_support import check_output, load_camera, load_pad, note, progress_bar
from padstudio.errors import ConflictError

_EXAMPLES = (
    "Examples: [bold]padstudio simulate --pad pad.json --camera preset-dji-mini-27k -o sim[/] · "
    "[bold]padstudio simulate --pad pad.json --camera camera.yaml --flight landing --frames 150 "
    "--look drone-shadow -o landing[/] · "
    "[bold]padstudio simulate --pad pad.json --camera camera.yaml --flight tilts --from-mm 500 "
    "--frames 8 --ground gravel -o tilts[/]"
)
_VIDEOS = ("hover", "landing", "gusty")


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(simulate)


def simulate(
    camera: Annotated[
        str, typer.Option(help="Camera file, or a preset's id (see: padstudio cameras).")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder to write into.")],
    pad: Annotated[
        Path | None, typer.Option(help="Pad file; without one the ground is bare.")
    ] = None,
    flight: Annotated[
        str, typer.Option(help="descent, hover, landing, gusty or tilts.")
    ] = "descent",
    frames: Annotated[int, typer.Option(help="How many frames.")] = 24,
    from_mm: Annotated[
        float, typer.Option(help="Height at the start (tilts: distance), mm.")
    ] = 3000,
    to_mm: Annotated[float, typer.Option(help="Height at the end, mm.")] = 100,
    fps: Annotated[float, typer.Option(help="Frames a second of a video.")] = 30,
    sway: Annotated[float, typer.Option(help="Scales how the camera wanders and leans.")] = 1,
    look: Annotated[
        str, typer.Option(help="Conditions: clear, shadow, dusk, glare, … (--list-looks).")
    ] = "clear",
    ground: Annotated[
        str, typer.Option(help="grass, gravel, asphalt, bricks, concrete, sand, snow or plain.")
    ] = "grass",
    quiet_mm: Annotated[
        float | None, typer.Option(help="White margin round the pad; the pad's own if not given.")
    ] = None,
    stills: Annotated[
        bool, typer.Option("--stills", help="Stills where a video is usual.")
    ] = False,
    codec: Annotated[str, typer.Option(help="h264 or h265.")] = "h264",
    seed: Annotated[int, typer.Option(help="The same seed gives the same pictures.")] = 1,
    list_looks: Annotated[
        bool, typer.Option("--list-looks", is_eager=True, callback=lambda on: _list_looks(on))
    ] = False,
    force: Annotated[
        bool, typer.Option("--force", help="Write into a folder that is there.")
    ] = False,
) -> None:
    """Simulate flights over a pad: pictures as a real camera takes them, and the true poses.

    Writes stills/ or flights/ with a truth file, and the pad and the camera beside them.
    """
    from padstudio.simulate import flights, looks, writer
    from padstudio.simulate.scene import Scene

    if output.exists() and not force:
        raise ConflictError(
            f"{output} exists; give another name, or --force to write into it", code="file_exists"
        )
    check_output(output, force=True)
    course = flights.plan(
        flight,  # type: ignore[arg-type]  # plan() names the choices itself
        frames=frames,
        from_mm=from_mm,
        to_mm=to_mm,
        fps=fps,
        seed=seed,
        sway=sway,
    )
    scene = Scene(
        pad=load_pad(pad) if pad else None,
        quiet_mm=quiet_mm,
        ground=ground,  # type: ignore[arg-type]  # Scene names the choices itself
        ground_seed=seed,
    )
    dressed, imaging = looks.dress(scene, look, seed=seed)
    the_camera = load_camera(camera)
    with progress_bar() as progress:
        task = progress.add_task("Rendering", total=len(course))
        truth = writer.write_flight(
            output,
            course,
            dressed,
            the_camera,
            imaging,
            video=flight in _VIDEOS and not stills,
            codec=codec,  # type: ignore[arg-type]  # VideoWriter names the choices itself
            seed=seed,
            progress=lambda done: progress.update(task, completed=done),
        )
    note(f"{output}: {len(course)} frames, the true poses in {truth.relative_to(output)}")


def _list_looks(wanted: bool) -> None:
    if wanted:
        from padstudio.simulate.looks import LOOKS

        for name, look in LOOKS.items():
            print(f"{name:14}{look.note}")
        raise typer.Exit
