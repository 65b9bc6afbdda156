"""Reads frames in a process of its own with a given number of threads, and takes the time."""

from __future__ import annotations

import multiprocessing
import os
import statistics
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from shootout_readers import READERS, Image

from padstudio import Camera, Pad, Pose

#: Files of pictures, or a video's path.
Source = list[bytes] | Path

_THREAD_SETTINGS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS")
# So many frames, evenly over the source, are read before the clock counts.
_WARM_UP = 6


@dataclass(frozen=True)
class Reading:
    """What a reader made of a frame.

    Attributes
    ----------
    pose : Pose or None
    wall_ms : float
        As a clock on the wall shows.
    cpu_ms : float
        Of all the process's threads: less disturbed by what else the machine does.
    """

    pose: Pose | None
    wall_ms: float
    cpu_ms: float


def readings(reader: str, pad: Pad, camera: Camera, source: Source, threads: int) -> list[Reading]:
    """Read a source's frames in a new process."""
    # The libraries read these when they are loaded.
    before = {name: os.environ.get(name) for name in _THREAD_SETTINGS}
    os.environ.update(dict.fromkeys(_THREAD_SETTINGS, str(threads)))
    try:
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            return pool.apply(_read, (reader, pad, camera, source, threads))
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _read(reader: str, pad: Pad, camera: Camera, source: Source, threads: int) -> list[Reading]:
    cv2.setNumThreads(threads)
    cv2.setRNGSeed(1)
    read_all = READERS[reader].make(pad, camera)
    for _ in read_all(_warm_up(source)):
        pass
    started: list[tuple[float, float]] = []

    def clocked(images: Iterable[Image]) -> Iterator[Image]:
        for image in images:
            started.append((time.perf_counter(), time.process_time()))
            yield image

    out = []
    for pose in read_all(clocked(_decoded(source))):
        wall, cpu = started[-1]
        spent = 1000 * (time.perf_counter() - wall), 1000 * (time.process_time() - cpu)
        out.append(Reading(pose, *spent))
    return out


def _warm_up(source: Source) -> Iterator[Image]:
    if isinstance(source, Path):
        for _, image in zip(range(_WARM_UP), _decoded(source), strict=False):
            yield image
    else:
        yield from _decoded(source[:: max(len(source) // _WARM_UP, 1)])


def _decoded(source: Source) -> Iterator[Image]:
    if isinstance(source, Path):
        video = cv2.VideoCapture(str(source))
        found, image = video.read()
        while found:
            yield np.asarray(image, np.uint8)
            found, image = video.read()
        return
    for file in source:
        yield np.asarray(cv2.imdecode(np.frombuffer(file, np.uint8), cv2.IMREAD_COLOR), np.uint8)


def times(found: list[Reading]) -> dict[str, Any]:
    """Milliseconds a frame: median and 95th percentile of both clocks."""
    out: dict[str, Any] = {"frames": len(found)}
    for clock in ("wall_ms", "cpu_ms"):
        values = [getattr(reading, clock) for reading in found]
        out[clock] = {
            "median": statistics.median(values),
            "p95": float(np.percentile(values, 95)),
            "worst": max(values),
        }
    return out
