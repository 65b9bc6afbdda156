"""One picture through the detector, in a worker process: the answer and the stage pictures."""

from __future__ import annotations

from collections.abc import Sequence
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
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.detector import Detector
from padstudio.vision.overlays.result import result_picture
from padstudio.vision.overlays.stages import stage_picture
from padstudio.vision.stage.detection import Detection, Method
from padstudio.vision.stage.params import DetectorParams, PrepareParams, RefineParams
from padstudio.vision.stage.trace import StageRecord, Trace

METHODS: tuple[Method, ...] = get_args(Method)
RESULT = "result"
#: The picture itself, beside its trace.
FRAME_FILE = "frame"
RESULT_PICTURE = f"{RESULT}.png"
THUMBNAIL_PREFIX = "small-"
#: As wide as pages show them on fine screens.
THUMBNAIL_WIDTH_PX = 320
THUMBNAIL_SUFFIX = ".webp"
#: Of pictures that are kept as they are, to be encoded when somebody looks.
RAW_SUFFIX = ".npy"
_THIN_STAGES = ("edges",)
_ENCODING = {
    ".png": [cv2.IMWRITE_PNG_COMPRESSION, 1],
    ".webp": [cv2.IMWRITE_WEBP_QUALITY, 85],
}
_THUMBNAIL_QUALITY = [cv2.IMWRITE_WEBP_QUALITY, 70]


@dataclass(frozen=True)
class Job:
    """One picture and how to read it.

    Attributes
    ----------
    image : bytes
        The picture's file.
    source : str
        Its name, for the record.
    pads : tuple of str
        The content of pad files.
    camera : str
        The content of a camera file.
    method : {"dense", "paper"}
    max_pixels : int
        Limit on the picture.
    unmix : bool
        Un-mix the colours where the pad knows their mixture.
    at_rest : bool
        The camera stood still.
    pictures : Path or None
        An empty folder for the stage pictures; None where no trace is wanted.
    paint : bool
        Paint the stages; who looks at them on the workbench needs none.
    """

    image: bytes
    source: str
    pads: tuple[str, ...]
    camera: str
    method: Method
    max_pixels: int
    unmix: bool = True
    at_rest: bool = False
    pictures: Path | None = None
    paint: bool = True


def analyze(job: Job) -> dict[str, Any]:
    """Decode, detect, and paint the stages where asked.

    Returns
    -------
    dict
        ``results`` (lines of a poses file, one for each pad that was found, or the failure),
        ``pad_ids`` (identities of all pads, in their order), ``image`` (width, height),
        ``camera_scale``, and ``stages``: None, or a list of name, channel, elapsed_ms, failure, and
        ``picture``, the name of a file in the folder or None.

    Raises
    ------
    ImageError, LimitError
        If the picture cannot be read.
    CameraMismatchError
        If it is not of the camera's aspect.
    SpecError
        As of `padstudio.vision.detector.check_pads`.
    """
    image = images.decode(job.image, job.max_pixels)
    height, width = image.shape[:2]
    detector = _detector(job.pads, job.camera, job.method, (job.unmix, job.at_rest))
    camera = detector.camera.for_frame(width, height)
    # Who wants to see every stage wants to know all that is wrong.
    reasons = job.pictures is not None
    found = detector.detect_all(image, trace=reasons and job.paint, reasons=reasons)
    stages = None
    if job.pictures is not None:
        trace = found[0].trace
        stages = [] if trace is None else paint(trace, found, job.pictures)
    return {
        "results": [detection.to_record(job.source) for detection in found],
        "pad_ids": [pad_id(pad) for pad in detector.pads],
        "image": {"width": width, "height": height},
        "camera_scale": camera.scale,
        "stages": stages,
    }


# The index of a large pad takes longer to build than a picture to read.
@lru_cache(maxsize=4)
def _detector(
    pads: tuple[str, ...], camera: str, method: Method, switches: tuple[bool, bool]
) -> Detector:
    unmix, at_rest = switches
    params = DetectorParams(
        prepare=PrepareParams(unmix=unmix), refine=RefineParams(at_rest=at_rest)
    )
    known = [Pad.loads(pad) for pad in pads]
    return Detector(known, Camera.loads(camera), method=method, params=params)


def paint(
    trace: Trace, found: Sequence[Detection], folder: Path, suffix: str = ".png"
) -> list[dict[str, Any]]:
    """Paint the result and every stage, each with a thumbnail.

    Parameters
    ----------
    trace : Trace
    found : sequence of Detection
        The trace's.
    folder : Path
        Empty.
    suffix : {".png", ".webp", ".npy"}

    Returns
    -------
    list of dict
        As ``stages`` of `analyze`.
    """
    records = list(_last_runs(trace.records).values())
    # OpenCV lets go of the interpreter while it encodes.
    with ThreadPoolExecutor(2) as threads:
        result = threads.submit(_save, folder, RESULT + suffix, trace, found)
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
    picture = stage_picture(trace, record.name, record.channel)
    if picture is None:
        return None
    name = f"{record.channel}-{record.name}" if record.channel else record.name
    name += suffix
    save_picture(folder, name, picture, is_thin=record.name in _THIN_STAGES)
    return name


def _save(folder: Path, name: str, trace: Trace, found: Sequence[Detection]) -> None:
    save_picture(folder, name, result_picture(trace, found))


def save_picture(folder: Path, name: str, picture: Image, *, is_thin: bool = False) -> None:
    """Write a picture in the form that its name ends in, and its thumbnail as WebP.

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
    if name.endswith(RAW_SUFFIX):
        np.save(folder / name, picture)
    else:
        (folder / name).write_bytes(encoded(picture, Path(name).suffix))
    height, width = picture.shape[:2]
    if width > THUMBNAIL_WIDTH_PX:
        size = (THUMBNAIL_WIDTH_PX, max(1, round(height * THUMBNAIL_WIDTH_PX / width)))
        if is_thin:
            # Pages show thumbnails smaller still, so lines are two pixels of them wide.
            reach = 2 * -(-width // THUMBNAIL_WIDTH_PX)
            picture = np.asarray(cv2.dilate(picture, np.ones((reach, reach), np.uint8)), np.uint8)
        picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)
    small = encoded(picture, THUMBNAIL_SUFFIX, _THUMBNAIL_QUALITY)
    (folder / thumbnail_of(name)).write_bytes(small)


def thumbnail_of(name: str) -> str:
    """The file of a picture's thumbnail."""
    return THUMBNAIL_PREFIX + Path(name).with_suffix(THUMBNAIL_SUFFIX).name


def encoded(picture: Image, suffix: str, options: list[int] | None = None) -> bytes:
    """A stage's picture as the bytes of a file.

    Raises
    ------
    ImageError
        If that cannot be.
    """
    done, data = cv2.imencode(suffix, picture, options or _ENCODING[suffix])
    if not done:
        raise ImageError(f"a stage's picture could not be encoded as {suffix}")
    return data.tobytes()
