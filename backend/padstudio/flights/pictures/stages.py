"""Pictures of any frame and any of its stages, made when somebody looks, and kept a while."""

from __future__ import annotations

import shutil
import threading
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from padstudio.arrays import Image
from padstudio.errors import ImageError
from padstudio.flights.pictures.shelves import ShelfJob, read
from padstudio.flights.tasks.detectors import Recipe, detector_for
from padstudio.flights.tasks.frames import StillPart, VideoPart, read_still
from padstudio.media.video_frames import VideoPicture
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import STAGES
from padstudio.workers import detection as analysis

Kind = Literal["webp", "png"]
Painted = dict[str, Any]
#: The name of the frame's own picture, and of the one with what was found in it.
FRAME, RESULT = "frame", "result"
# Following does not look for lines.
_OF_A_SEARCH = "lines"


@dataclass(frozen=True)
class PictureJob:
    """A frame to be painted.

    Attributes
    ----------
    recipe : Recipe
    part : VideoPart or StillPart
        The video's last timestamp is the frame's; those before it lead up to it.
    folder : Path
        Empty; for the pictures.
    max_pixels : int
    shelf : ShelfJob or None
        What lies ready of a video's decoded frames.
    """

    recipe: Recipe
    part: VideoPart | StillPart
    folder: Path
    max_pixels: int
    shelf: ShelfJob | None = None


def paint(job: PictureJob) -> Painted:
    """Detect in a frame once more, and paint it and all of its stages.

    Whole pictures are kept as they are: to encode them all would take longer than all the rest,
    and few of them are looked at (`encode`). Thumbnails are there at once.

    Returns
    -------
    dict
        ``image``: width and height; ``stages`` as of `padstudio.workers.detection.analyze`.

    Raises
    ------
    ImageError
        If the decoder gives no picture for the frame.
    StudioError
        If its file cannot be read.
    """
    detection = _detect(job)
    trace = detection.trace
    assert trace is not None
    analysis.save_picture(job.folder, FRAME + analysis.RAW_SUFFIX, trace.image)
    stages = analysis.paint(trace, [detection], job.folder, analysis.RAW_SUFFIX)
    height, width = trace.image.shape[:2]
    return {"image": {"width": width, "height": height}, "stages": stages}


def encode(folder: Path, name: str, kind: Kind) -> bytes:
    """A painted picture, whole, as the bytes of a file; `name` without a suffix."""
    picture = np.load(folder / (name + analysis.RAW_SUFFIX))
    return analysis.encoded(np.asarray(picture, np.uint8), f".{kind}")


def picture_of(job: PictureJob) -> Image:
    """A frame's whole picture, (H, W, 3) uint8; raises as `paint`."""
    if isinstance(job.part, StillPart):
        return read_still(job.part, job.max_pixels)
    return _last(list(read(job.part.last(1), job.shelf, job.max_pixels)), job.part)


def _detect(job: PictureJob) -> Detection:
    detector, part = detector_for(job.recipe), job.part
    if isinstance(part, StillPart):
        return detector.detect(read_still(part, job.max_pixels), trace=True)
    found = [each for each in read(part, job.shelf, job.max_pixels) if each.frame is not None]
    last = _last(found, part)
    # As in the analysis, in planes; only the frame itself is kept with its stages.
    frames = (picture.frame for picture in found if picture.frame is not None)
    *_, followed = detector.track(frames, fuse=False, trace=(len(found) - 1,))
    return _with_all_stages(followed, lambda: detector.detect(last, trace=True))


def _last(found: Sequence[VideoPicture], part: VideoPart) -> Image:
    picture = found[-1].bgr if found and found[-1].pts == part.timestamps[-1] else None
    if picture is None:
        raise ImageError(
            "the decoder gives no picture for this frame: its data are missing or damaged",
            code="frame_lost",
        )
    return picture


def _with_all_stages(followed: Detection, read_still: Callable[[], Detection]) -> Detection:
    """A followed frame with the stages that following passes over, as they are for a still."""
    assert followed.trace is not None
    ran = {record.name for record in followed.trace.records}
    if _OF_A_SEARCH in ran:
        return followed
    still = read_still()
    assert still.trace is not None
    others = tuple(record for record in still.trace.records if record.name not in ran)
    records = sorted(
        (*others, *followed.trace.records), key=lambda record: STAGES.index(record.name)
    )
    return replace(followed, trace=replace(followed.trace, records=tuple(records)))


class PictureCache:
    """Folders of pictures by name; those not looked at for longest go first.

    Parameters
    ----------
    root : Path
        Made where it is missing, and emptied: pictures can always be made again.
    keep_bytes : int
        What all of them may take; the newest stays, however large.
    """

    def __init__(self, root: Path, keep_bytes: int) -> None:
        shutil.rmtree(root, ignore_errors=True)
        root.mkdir(parents=True)
        self._root, self._keep_bytes = root, keep_bytes
        self._sizes: OrderedDict[str, int] = OrderedDict()
        self._painted: dict[str, Painted] = {}
        self._lock = threading.Lock()

    def painted(self, name: str) -> Painted | None:
        """What was kept under a name, which stays for longer now; None where nothing is."""
        with self._lock:
            if name not in self._sizes:
                return None
            self._sizes.move_to_end(name)
            return self._painted[name]

    def path(self, name: str, picture: str) -> Path | None:
        """Where a picture lies; None where there is none of that name."""
        path = self._root / name / picture
        return path if path.is_file() else None

    def add(self, name: str, folder: Path, painted: Painted) -> None:
        """Keep a folder, which is moved from the same file system."""
        size = sum(entry.stat().st_size for entry in folder.iterdir())
        with self._lock:
            target = self._root / name
            shutil.rmtree(target, ignore_errors=True)
            folder.replace(target)
            self._sizes[name], self._painted[name] = size, painted
            self._sizes.move_to_end(name)
            while sum(self._sizes.values()) > self._keep_bytes and len(self._sizes) > 1:
                oldest, _ = self._sizes.popitem(last=False)
                del self._painted[oldest]
                shutil.rmtree(self._root / oldest, ignore_errors=True)
