"""Detects the pad in many stills, in several processes, in order."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import cv2

from padstudio.errors import StudioError
from padstudio.flights import images
from padstudio.flights.workers import WorkerPool
from padstudio.geometry import camera_files
from padstudio.geometry.camera import Camera
from padstudio.pad import files as pad_files
from padstudio.pad.spec import Pad
from padstudio.vision.pipeline import Detector
from padstudio.vision.types import Method

Record = dict[str, Any]
logger = logging.getLogger(__name__)

#: A frame that takes longer is given up.
FRAME_SECONDS = 120.0
_WORKER_MEMORY_BYTES = 4_000_000_000


def detect_stills(
    paths: Sequence[Path], pad: Pad, camera: Camera, *, method: Method = "dense", jobs: int = 1
) -> Iterator[Record]:
    """Records of a poses file, one a still, in the order of the paths.

    A file that cannot be read, or that costs a worker its life, gives a record too: ``failed`` at
    the stage ``read``, with the error's code as reason; likewise, as ``internal_error``, one that
    brings a defect to light. The rest goes on.

    Parameters
    ----------
    paths : sequence of Path
    pad : Pad
    camera : Camera
    method : {"dense", "paper"}
    jobs : int
        Worker processes; with 1 the work is done in this process.

    Yields
    ------
    dict
        As `padstudio.vision.types.Detection.to_record`.
    """
    key = (pad_files.dumps(pad), camera_files.to_ros_yaml(camera), method)
    if jobs == 1:
        for path in paths:
            yield _result(path, partial(_detect_one, path, *key))
    else:
        yield from _in_processes(paths, key, jobs)


def _in_processes(
    paths: Sequence[Path], key: tuple[str, str, Method], jobs: int
) -> Iterator[Record]:
    ahead = 2 * jobs
    pool = WorkerPool(jobs, _WORKER_MEMORY_BYTES, max_waiting=ahead)
    waiting: deque[tuple[Path, Future[Record]]] = deque()
    try:
        for path in paths:
            future = pool.submit(_detect_alone, path, *key, timeout_s=FRAME_SECONDS)
            waiting.append((path, future))
            if len(waiting) >= ahead:
                yield _first(waiting)
        while waiting:
            yield _first(waiting)
    finally:
        pool.close()


def _first(waiting: deque[tuple[Path, Future[Record]]]) -> Record:
    path, future = waiting.popleft()
    return _result(path, future.result)


def _result(path: Path, run: Callable[[], Record]) -> Record:
    try:
        return run()
    except StudioError as error:
        return _unread(path, error)
    except Exception as error:
        logger.exception("%s brought a defect to light", path)
        defect = StudioError(f"a defect of the program: {error!r}", code="internal_error")
        return _unread(path, defect)


def _detect_alone(path: Path, pad_text: str, camera_text: str, method: Method) -> Record:
    """Detect with one thread, as there is a process for every core."""
    cv2.setNumThreads(1)
    return _detect_one(path, pad_text, camera_text, method)


def _detect_one(path: Path, pad_text: str, camera_text: str, method: Method) -> Record:
    detection = _detector(pad_text, camera_text, method).detect(images.read(path))
    return detection.to_record(path.as_posix())


@lru_cache(maxsize=1)
def _detector(pad_text: str, camera_text: str, method: Method) -> Detector:
    """The process's detector: its tables are built once, not once a frame."""
    return Detector(pad_files.loads(pad_text), camera_files.loads(camera_text), method=method)


def _unread(path: Path, error: StudioError) -> Record:
    return {
        "source": path.as_posix(),
        "frame": 0,
        "time_s": None,
        "status": "failed",
        "stage": "read",
        "reason": error.error_code,
        "detail": error.message,
        "advice": "",
        "elapsed_ms": {},
    }
