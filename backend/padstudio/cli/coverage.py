"""``padstudio coverage``: what a pad's sizes can do."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from padstudio.cli.support import NoDistortion, note, open_camera, progress_bar
from padstudio.geometry.camera import Camera
from padstudio.pad.coverage.dead_bands import DeadBand, dead_bands
from padstudio.pad.coverage.spans import METHOD_LIMITS, Span
from padstudio.pad.coverage.spans import coverage as spans_of
from padstudio.pad.spec import Pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.success_map import MapGrid, SuccessMap, success_map, view_of
from padstudio.vision.detector import Detector

Spans = tuple[Span, ...]
Bands = list[tuple[float, DeadBand]]

_EXAMPLES = (
    "Examples: [bold]padstudio coverage --pad pad.json --camera preset-dji-mini-27k[/] · "
    "[bold]padstudio coverage --pad pad.json --camera camera.yaml --tilts 0,30,60 --json[/] · "
    "[bold]padstudio coverage --pad pad.json --camera camera.yaml --simulate "
    "--heights 100,300,1000,3000 --blurs 0,4,8[/]"
)

PadFile = Annotated[Path, typer.Option(help="Pad file.")]
CameraName = Annotated[
    str, typer.Option(help="Camera file, or a preset's id (see: padstudio cameras).")
]
MethodName = Annotated[
    Literal["dense", "paper"],
    typer.Option(help="dense: all that is in the picture; paper: the published method."),
]
Tilts = Annotated[str, typer.Option(help="Degrees off straight down, with commas.")]
Switch = Annotated[
    float | None, typer.Option(help="Height above which the fine layer is not looked at.")
]
Simulate = Annotated[
    bool, typer.Option("--simulate", help="Also render frames and have them read.")
]
Heights = Annotated[str, typer.Option(help="Heights to simulate, mm, with commas.")]
Blurs = Annotated[str, typer.Option(help="Simulate these blurs in pixels rather than the tilts.")]
Trials = Annotated[int, typer.Option(help="Simulated frames at each place.")]
Seed = Annotated[int, typer.Option(help="The same seed gives the same pictures.")]
AsJson = Annotated[bool, typer.Option("--json", help="Figures for programs.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(coverage)


def coverage(
    pad: PadFile,
    camera: CameraName,
    no_distortion: NoDistortion = False,
    method: MethodName = "dense",
    tilts: Tilts = "0,30,60",
    switch_mm: Switch = None,
    simulate: Simulate = False,
    heights: Heights = "100,200,400,800,1600,3200",
    blurs: Blurs = "",
    trials: Trials = 3,
    seed: Seed = 1,
    as_json: AsJson = False,
) -> None:
    """Show the heights and tilts at which each layer of a pad, and the sign as a whole, reads.

    From geometry at once; with --simulate from rendered frames too. Warns of heights between those
    that read, at which nothing does.
    """
    the_pad, the_camera = Pad.load(pad), open_camera(camera, no_distortion=no_distortion)
    view, limits = view_of(the_camera), METHOD_LIMITS[method]
    angles = _numbers(tilts, "--tilts")
    spans = spans_of(the_pad, view, limits, angles)
    bands = [
        (tilt, band)
        for tilt in angles
        for band in dead_bands(the_pad, view, limits, tilt, switch_mm=switch_mm)
    ]
    found = None
    if simulate:
        grid = MapGrid(
            heights_mm=_numbers(heights, "--heights"),
            axis="blur_px" if blurs else "tilt_deg",
            values=_numbers(blurs, "--blurs") if blurs else angles,
            trials=trials,
            seed=seed,
        )
        found = _simulated(the_pad, the_camera, method, grid)
    (_print_json if as_json else _print_text)(spans, bands, found)


def _simulated(pad: Pad, camera: Camera, method: str, grid: MapGrid) -> SuccessMap:
    detector = Detector(pad, camera, method=method)  # type: ignore[arg-type]
    with progress_bar("Simulating", grid.frames) as progress:
        return success_map(
            Scene(pad=pad),
            camera,
            lambda bgr: detector.detect(bgr).pose,
            grid,
            progress=progress,
        )


def _print_json(spans: Spans, bands: Bands, found: SuccessMap | None) -> None:
    data: dict[str, Any] = {
        "spans": [vars(span) | {"reads": span.reads} for span in spans],
        "dead_bands": [{"tilt_deg": tilt} | vars(band) for tilt, band in bands],
    }
    if found is not None:
        data["simulated"] = found.as_dict()
    json.dump(data, sys.stdout, indent=1)
    print()


def _print_text(spans: Spans, bands: Bands, found: SuccessMap | None) -> None:
    print("layer       tilt   from      to")
    for span in spans:
        reach = f"{span.low_mm:6.0f}  {span.high_mm:6.0f} mm" if span.reads else "reads nowhere"
        name = "whole sign" if span.layer == "outline" else span.layer
        print(f"{name:10}  {span.tilt_deg:3.0f}°  {reach}")
    for tilt, band in bands:
        note(f"warning: at {tilt:g}° {band.message}")
    if found is not None:
        _print_map(found)


def _print_map(found: SuccessMap) -> None:
    unit = "°" if found.axis == "tilt_deg" else " px"
    print(f"\nread in {found.trials} simulated frames each")
    print("height mm " + "".join(f"{value:g}{unit}".rjust(9) for value in found.values))
    for height, row in zip(found.heights_mm, found.share, strict=True):
        print(f"{height:9g} " + "".join(f"{share:9.0%}" for share in row))


def _numbers(text: str, option: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"{text!r} is no list of numbers", param_hint=option) from None
