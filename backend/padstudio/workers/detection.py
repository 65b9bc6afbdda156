"""One picture through the detector, in a worker process: the answer and the stage pictures."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, get_args

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.errors import ImageError
from padstudio.geometry.camera import Camera
from padstudio.media import images
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.detector import Detector
from padstudio.vision.overlays import stages as overlays
from padstudio.vision.stage.detection import Detection, Method
from padstudio.vision.stage.params import DetectorParams, PrepareParams, RefineParams
from padstudio.vision.stage.trace import StageRecord, Trace

METHODS: tuple[Method, ...] = get_args(Method)
RESULT = "result"
RESULT_PICTURE = f"{RESULT}.png"
THUMBNAIL_PREFIX = "small-"
#: Pages show thumbnails smaller still.
THUMBNAIL_WIDTH_PX = 480
_THIN_STAGES = ("edges",)
_ENCODING = {
    ".png": [cv2.IMWRITE_PNG_COMPRESSION, 1],
    ".webp": [cv2.IMWRITE_WEBP_QUALITY, 85],
}


@dataclass(frozen=True)
class Job:
    """One picture and how to read it.

    Attributes
    ----------
    image : bytes
        The picture's file.
    source : str
        Its name, for the record.
    pad, camera : str
        The content of a pad file and of a camera file.
    method : {"dense", "paper"}
    max_pixels : int
        Limit on the picture.
    unmix : bool
        Un-mix the colours where the pad knows their mixture.
    at_rest : bool
        The camera stood still.
    pictures : Path or None
        An empty folder for the stage pictures; None where no trace is wanted.
    """

    image: bytes
    source: str
    pad: str
    camera: str
    method: Method
    max_pixels: int
    unmix: bool = True
    at_rest: bool = False
    pictures: Path | None = None


def analyze(job: Job) -> dict[str, Any]:
    """Decode, detect, and paint the stages where asked.

    Returns
    -------
    dict
        ``result`` (a line of a poses file), ``image`` (width, height), ``camera_scale``, and
        ``stages``: None, or a list of name, channel, elapsed_ms, failure, and ``picture``, the
        name of a file in the folder or None.

    Raises
    ------
    ImageError, LimitError
        If the picture cannot be read.
    CameraMismatchError
        If it is not of the camera's aspect.
    """
    image = images.decode(job.image, job.max_pixels)
    height, width = image.shape[:2]
    detector = _detector(job.pad, job.camera, job.method, (job.unmix, job.at_rest))
    camera = detector.camera.for_frame(width, height)
    detection = detector.detect(image, trace=job.pictures is not None)
    stages = None
    if job.pictures is not None and detection.trace is not None:
        stages = paint(detection.trace, detection, job.pictures)
    return {
        "result": detection.to_record(job.source),
        "image": {"width": width, "height": height},
        "camera_scale": camera.scale,
        "stages": stages,
    }


# The index of a large pad takes longer to build than a picture to read.
@lru_cache(maxsize=4)
def _detector(pad: str, camera: str, method: Method, switches: tuple[bool, bool]) -> Detector:
    unmix, at_rest = switches
    params = DetectorParams(
        prepare=PrepareParams(unmix=unmix), refine=RefineParams(at_rest=at_rest)
    )
    return Detector(Pad.loads(pad), Camera.loads(camera), method=method, params=params)


def paint(
    trace: Trace, detection: Detection, folder: Path, suffix: str = ".png"
) -> list[dict[str, Any]]:
    """Paint the result and every stage, each with a thumbnail.

    Parameters
    ----------
    trace : Trace
    detection : Detection
        The trace's.
    folder : Path
        Empty.
    suffix : {".png", ".webp"}

    Returns
    -------
    list of dict
        As ``stages`` of `analyze`.
    """
    records = list(_last_runs(trace.records).values())
    # OpenCV lets go of the interpreter while it encodes.
    with ThreadPoolExecutor(2) as threads:
        result = threads.submit(_save, folder, RESULT + suffix, trace, detection)
        painted = threads.map(lambda record: _save_stage(folder, trace, record, suffix), records)
        stages = [
            {
                "name": record.name,
                "channel": record.channel,
                "elapsed_ms": round(record.elapsed_ms, 3),
                "failure": _failure(record),
                "picture": picture,
            }
            for record, picture in zip(records, painted, strict=True)
        ]
        result.result()
    return stages


def _last_runs(records: tuple[StageRecord, ...]) -> dict[tuple[str, Channel | None], StageRecord]:
    """A detector may run a stage again; the last run is shown, in the first one's place."""
    return {(record.name, record.channel): record for record in records}


def _failure(record: StageRecord) -> dict[str, str] | None:
    failure = record.failure
    if failure is None:
        return None
    return {
        "stage": failure.stage,
        "reason": str(failure.reason),
        "detail": failure.detail,
        "advice": failure.advice,
    }


def _save_stage(folder: Path, trace: Trace, record: StageRecord, suffix: str) -> str | None:
    picture = overlays.stage_picture(trace, record.name, record.channel)
    if picture is None:
        return None
    name = f"{record.channel}-{record.name}" if record.channel else record.name
    name += suffix
    save_picture(folder, name, picture, is_thin=record.name in _THIN_STAGES)
    return name


def _save(folder: Path, name: str, trace: Trace, detection: Detection) -> None:
    save_picture(folder, name, overlays.result_picture(trace, detection))


def save_picture(folder: Path, name: str, picture: Image, *, is_thin: bool = False) -> None:
    """Write a picture and its thumbnail, in the form that its name ends in.

    Parameters
    ----------
    folder : Path
    name : str
    picture : (h, w, 3) uint8
    is_thin : bool
        Bright lines on black, which a mean over pixels would darken: they are made wider.
    """
    if picture.ndim == 3 and not np.ptp(picture[::7, ::7].astype(np.int16), axis=2).any():
        # Most stages are grey in three channels; one is a third of the work.
        grey = picture[:, :, 0]
        if all(np.array_equal(grey, picture[:, :, plane]) for plane in (1, 2)):
            picture = np.ascontiguousarray(grey)
    _encode(folder / name, picture)
    height, width = picture.shape[:2]
    if width > THUMBNAIL_WIDTH_PX:
        size = (THUMBNAIL_WIDTH_PX, max(1, round(height * THUMBNAIL_WIDTH_PX / width)))
        if is_thin:
            # Pages show thumbnails smaller still, so lines are two pixels of them wide.
            reach = 2 * -(-width // THUMBNAIL_WIDTH_PX)
            picture = np.asarray(cv2.dilate(picture, np.ones((reach, reach), np.uint8)), np.uint8)
        picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)
    _encode(folder / (THUMBNAIL_PREFIX + name), picture)


def _encode(path: Path, picture: Image) -> None:
    done, data = cv2.imencode(path.suffix, picture, _ENCODING[path.suffix])
    if not done:
        raise ImageError(f"a stage's picture could not be encoded as {path.suffix}")
    path.write_bytes(data.tobytes())
