"""Simulates a flight in a worker process, into a folder that the server watches."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from padstudio.errors import ConflictError
from padstudio.geometry.camera import Camera
from padstudio.simulate import trajectories, writer
from padstudio.simulate.disturbances import vibrations_of
from padstudio.workers.frames import check_pixels, dressed_scene
from padstudio.workers.inside import checkpoint

#: In the folder: pictures, truth, pad and camera; the footage alone; frames done; asked to stop.
ARCHIVE, FOOTAGE, DONE, STOP = "flight.zip", "footage", "done", "stop"


def check_flight(spec: Mapping[str, Any], pad: str | None, camera: str, max_pixels: int) -> None:
    """Refuse what cannot be simulated, before anything is rendered.

    Raises
    ------
    SpecError, LimitError
        As `padstudio.simulate.trajectories.plan` and `check_flight`.
    """
    the_camera = Camera.loads(camera)
    check_pixels(the_camera, max_pixels)
    trajectories.check_flight(_course(spec), _setup(spec, pad, the_camera))


def simulate_flight(
    spec: Mapping[str, Any], pad: str | None, camera: str, video: bool, folder: Path
) -> None:
    """Render a flight.

    Parameters
    ----------
    spec : mapping
        Fields of `padstudio.web.schemas.simulations.SimulationSpec`.
    pad, camera : str
        The content of a pad file, None for bare ground, and of a camera file.
    video : bool
        One MP4 rather than a zip of stills.
    folder : Path
        Takes `ARCHIVE`, `FOOTAGE` and, while frames are rendered, `DONE`.

    Raises
    ------
    ConflictError
        Where `STOP` appears in the folder.
    SpecError, LimitError
        As `padstudio.simulate.writer.write_flight`.
    """
    written = folder / "flight"
    setup = _setup(spec, pad, Camera.loads(camera))
    writer.write_flight(
        written,
        _course(spec),
        setup,
        codec=spec["codec"] if video else None,
        progress=_reporter(folder),
    )
    _pack(written, folder / ARCHIVE, "*")
    if video:
        next(written.glob("flights/*.mp4")).replace(folder / FOOTAGE)
    else:
        _pack(written / "stills", folder / FOOTAGE, "*.[jp][pn]g")
    shutil.rmtree(written)


def frames_done(folder: Path) -> int:
    """How many frames a folder's flight has."""
    try:
        return int((folder / DONE).read_text() or 0)
    except FileNotFoundError:
        return 0


def _setup(spec: Mapping[str, Any], pad: str | None, camera: Camera) -> trajectories.Setup:
    scene, imaging = dressed_scene(spec, pad)
    return trajectories.Setup(scene=scene, camera=camera, imaging=imaging, seed=spec["seed"])


def _course(spec: Mapping[str, Any]) -> trajectories.Flight:
    names = ("frames", "from_mm", "to_mm", "fps", "seed", "sway")
    asked = trajectories.FlightSpec(
        kind=spec["flight"],
        vibrations=vibrations_of(spec["disturbances"], seed=spec["seed"]),
        **{name: spec[name] for name in names},
    )
    return trajectories.plan(asked)


def _reporter(folder: Path) -> Callable[[int], None]:
    def report(done: int) -> None:
        if (folder / STOP).exists():
            raise ConflictError("the simulation was stopped", code="cancelled")
        (folder / DONE).write_text(str(done))
        checkpoint()

    return report


def _pack(folder: Path, archive: Path, pattern: str) -> None:
    # Pictures and videos are compressed as they are.
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as pack:
        for path in sorted(folder.rglob(pattern)):
            if path.is_file():
                pack.write(path, path.relative_to(folder))
