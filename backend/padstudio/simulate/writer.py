"""Simulated flights on disk, with their truth beside them."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2

from padstudio.geometry.pose import Pose
from padstudio.simulate.render import Frame
from padstudio.simulate.trajectories import Flight, Setup, check_flight
from padstudio.simulate.video_writer import Codec, VideoWriter, check_size

CAMERA_FILE = "camera.yaml"
PAD_FILE = "pad.json"


def write_flight(
    folder: Path,
    flight: Flight,
    setup: Setup,
    *,
    codec: Codec | None = None,
    progress: Callable[[int], None] | None = None,
) -> Path:
    """Render a flight into a folder.

    Stills go to ``stills/`` with ``stills/truth.json``, a list; a video to ``flights/NAME.mp4``
    with ``flights/NAME.truth.json``, an object with ``frames``. The pad and the camera lie beside.

    Parameters
    ----------
    folder : Path
        Made if it is not there; files of the same names are written over.
    flight : Flight
    setup : Setup
        Its JPEG step is left out for a video.
    codec : {"h264", "h265"}, optional
        Of one MP4; stills where none is given.
    progress : callable, optional
        Called with the number of frames done.

    Returns
    -------
    Path
        The truth file.

    Raises
    ------
    SpecError, LimitError
        As `padstudio.simulate.render.render` and `VideoWriter`.
    """
    check_flight(flight, setup)
    if codec is not None:
        check_size(setup.camera.width, setup.camera.height)
    folder.mkdir(parents=True, exist_ok=True)
    setup.camera.save(folder / CAMERA_FILE)
    if setup.scene.pad is not None:
        setup.scene.pad.save(folder / PAD_FILE)
    report = progress or (lambda done: None)
    if codec is None:
        return _write_stills(folder / "stills", flight, setup, report)
    return _write_video(folder / "flights", flight, setup, codec, report)


def _write_stills(
    folder: Path, flight: Flight, setup: Setup, report: Callable[[int], None]
) -> Path:
    folder.mkdir(exist_ok=True)
    digits = len(str(len(flight) - 1))
    truth = []
    for index, frame in enumerate(flight.frames(setup)):
        suffix = "jpg" if frame.encoded is not None else "png"
        path = folder / f"{flight.name}_{index:0{digits}d}.{suffix}"
        path.write_bytes(frame.encoded or bytes(cv2.imencode(".png", frame.image)[1]))
        truth.append(
            {
                "file": f"{folder.name}/{path.name}",
                "group": flight.groups[index],
                "camera": CAMERA_FILE,
                **_truth_fields(frame),
            }
        )
        report(index + 1)
    return _write_json(folder / "truth.json", truth)


def _write_video(
    folder: Path,
    flight: Flight,
    setup: Setup,
    codec: Codec,
    report: Callable[[int], None],
) -> Path:
    folder.mkdir(exist_ok=True)
    fps = flight.fps or 30.0
    setup = replace(setup, imaging=setup.imaging.with_changes(jpeg_quality=None))
    truth: list[dict[str, Any]] = []
    with VideoWriter(
        folder / f"{flight.name}.mp4",
        width=setup.camera.width,
        height=setup.camera.height,
        fps=fps,
        codec=codec,
    ) as writer:
        for index, frame in enumerate(flight.frames(setup)):
            writer.write(frame.image)
            truth.append({"frame": index, "time_s": index / fps, **_truth_fields(frame)})
            report(index + 1)
    head = {"camera": CAMERA_FILE, "fps": fps, "frames": truth}
    return _write_json(folder / f"{flight.name}.truth.json", head)


def _truth_fields(frame: Frame) -> dict[str, Any]:
    if frame.truth.scene.pad is None:
        # Without a pad in the scene any pose is false: the score's mark of a negative.
        return {}
    fields = _pose_fields(frame.truth.pose)
    also = [_pose_fields(pose) for pose in frame.truth.also_true]
    return fields | ({"also_true": also} if also else {})


def _pose_fields(pose: Pose) -> dict[str, Any]:
    return {"position_mm": pose.position_mm.tolist(), "rotation": pose.rotation.tolist()}


def _write_json(path: Path, data: object) -> Path:
    path.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    return path
