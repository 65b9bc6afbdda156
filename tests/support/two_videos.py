"""A flight of two videos, in frames smaller than the calibration's, the second one damaged.

It is flown twice: by the command line, and by the parts of a server that need no network.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import flight_orders
import numpy as np
from command_line import run

from padstudio.flights.chunks import Chunks
from padstudio.flights.jobs import FlightOrder, Flights
from padstudio.flights.tasks.from_rows import WorkLimits, frames_task, plan_task
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.trajectories import FlightSpec, Setup, plan
from padstudio.simulate.video_writer import VideoWriter
from padstudio.store.database.flight_tables import FlightRow
from padstudio.store.store import Store

WIDTH, HEIGHT = 640, 480
CAMERA = Camera(WIDTH, HEIGHT, np.array([[440.0, 0, 319.5], [0, 440.0, 239.5], [0, 0, 1]]))
#: The same lens as it was calibrated, in pictures of twice the size.
CALIBRATED = Camera(
    2 * WIDTH, 2 * HEIGHT, np.array([[880.0, 0, 639.5], [0, 880.0, 479.5], [0, 0, 1]])
)
FRAMES, FPS = 6, 20.0
NAMES = ("first.mp4", "second.mp4")
#: Of the request: as `padstudio detect` does without options.
REQUEST: dict[str, Any] = flight_orders.REQUEST | {"fuse": True, "smooth": False}


def pad() -> Pad:
    """Sixty cells of 10 mm a side."""
    rng = np.random.default_rng(11)
    fine, coarse = (rng.integers(0, 2, (n, n)).astype(np.uint8) for n in (60, 12))
    return Pad((Layer("red", 10.0, fine), Layer("blue", 50.0, coarse)))


@dataclass(frozen=True)
class TwoVideos:
    """The files of the flight, and its true poses (position, mm) frame by frame."""

    folder: Path
    positions_mm: list[list[float]]

    @classmethod
    def write(cls, folder: Path) -> TwoVideos:
        """Simulate and write them."""
        (folder / "pad.json").write_text(pad().dumps())
        CALIBRATED.save(folder / "camera.yaml")
        found = []
        for name, from_mm in zip(NAMES, (1100.0, 900.0), strict=True):
            spec = FlightSpec(
                kind="landing", frames=FRAMES, from_mm=from_mm, to_mm=0.8 * from_mm, seed=3
            )
            imaging = Imaging(exposure_ms=1.0)
            setup = Setup(scene=Scene(pad=pad()), camera=CAMERA, imaging=imaging, seed=3)
            path = folder / name
            with VideoWriter(
                path, width=WIDTH, height=HEIGHT, fps=FPS, codec="h264", quality=20
            ) as video:
                for shot in plan(spec).frames(setup):
                    video.write(shot.image)
                    found.append(shot.truth.pose.position_mm.tolist())
        _damage(folder / NAMES[1])
        return cls(folder, found)

    def by_command_line(self, poses: str = "poses.jsonl") -> None:
        """Detect from within the folder."""
        arguments = ("--pad", "pad.json", "--camera", "camera.yaml", *NAMES, "-j", "1")
        result = run("detect", *arguments, "-o", poses)
        assert result.exit_code == 0, result.stderr

    def by_server(self, store: Store) -> FlightRow:
        """Upload, order and work off the chunks in this process."""
        uploads = [flight_orders.upload(store, self.folder / name) for name in NAMES]
        camera = (self.folder / "camera.yaml").read_text()
        order = FlightOrder("two", uploads, pad().dumps(), camera, REQUEST)
        flights, chunks = Flights(store.session), Chunks(store.session)
        made = flights.create(order)
        files = [
            (upload, "video", name, self.folder / name)
            for upload, name in zip(uploads, NAMES, strict=True)
        ]
        while claims := chunks.claim(1):
            loaded = chunks.load(claims[0])
            assert loaded is not None
            flight, chunk = loaded
            if claims[0].is_plan:
                task = plan_task(flight, files, str, WorkLimits())
                chunks.finish_plan(claims[0], task.run(_never))
            else:
                chunks.finish(claims[0], frames_task(flight, chunk, WorkLimits()).run(_never))
        return flights.get(made.id, texts=True)


def here(function: Callable[..., Any], *arguments: Any) -> Any:
    """Calls in this process what a server has done in another."""
    return function(*arguments)


def _damage(path: Path) -> None:
    """Overwrite a part of the pictures' data."""
    data = bytearray(path.read_bytes())
    start = data.index(b"mdat") + 4
    place = start + (len(data) - start) // 2
    data[place : place + 400] = bytes(400)
    path.write_bytes(bytes(data))


def _never() -> bool:
    return False
