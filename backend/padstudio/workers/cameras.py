"""Cameras in a worker process: read from files, calibrated in a folder that the server watches."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import cv2

from padstudio.calibration.calibrate import calibrate
from padstudio.calibration.pictures import residual_picture
from padstudio.calibration.record import record
from padstudio.calibration.sources import DecodedInTurn, read_pictures
from padstudio.geometry.camera import Camera
from padstudio.geometry.camera_files.parts.fields import LensModel
from padstudio.pad.spec import Pad
from padstudio.workers.inside import checkpoint
from padstudio.workers.steps import reporter

_QUALITY = 80


def read(data: bytes, name: str, no_distortion: bool, which: str | None) -> Camera:
    """A camera from a file's content, which may cost any time and memory.

    Parameters and errors are those of `Camera.loads`.
    """
    return Camera.loads(data, name, no_distortion=no_distortion, which=which)


class Calibrated(NamedTuple):
    """What comes of a calibration: a camera file, and a record of it."""

    camera_yaml: str
    record: dict[str, Any]


def calibrate_pictures(
    pad: str,
    files: Sequence[tuple[str, Path]],
    models: Sequence[LensModel],
    max_pixels: int,
    folder: Path,
) -> Calibrated:
    """Calibrate a camera from stills, zips of stills and clips.

    Parameters
    ----------
    pad : str
        The content of a pad file.
    files : sequence of (name, path)
    models : sequence of {"radtan", "fisheye"}
    max_pixels : int
        Of one picture.
    folder : Path
        Takes how far it is, and a picture of each still's residuals (`picture_file`).

    Raises
    ------
    ConflictError
        Where `STOP` appears in the folder, or the folder is gone.
    CalibrationError, ImageError, VideoError, LimitError
        As `padstudio.calibration.sources.read_pictures` and `calibrate`.
    """

    report = reporter(folder, "calibration")

    def read() -> None:
        report(0, 0)

    shown = read_pictures(files, max_pixels=max_pixels, read=read)
    found = calibrate(Pad.loads(pad), DecodedInTurn(shown), models=models, progress=report)
    for number, (picture, view) in enumerate(zip(shown, found.views, strict=True)):
        drawn = residual_picture(picture.image, view)
        _, data = cv2.imencode(".webp", drawn, [cv2.IMWRITE_WEBP_QUALITY, _QUALITY])
        picture_file(folder, number).write_bytes(data.tobytes())
        checkpoint()
    return Calibrated(found.camera.to_ros_yaml(), record(found, [each.name for each in shown]))


def picture_file(folder: Path, number: int) -> Path:
    """Where a still's picture lies."""
    return folder / f"{number}.webp"
