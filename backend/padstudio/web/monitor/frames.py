"""A live session's last frames: their pictures, and every stage of the detector on them."""

from __future__ import annotations

import asyncio
import shutil
import tempfile
from collections import OrderedDict
from pathlib import Path
from typing import Any

import cv2
from starlette.concurrency import run_in_threadpool

from padstudio.arrays import Image, YuvFrame
from padstudio.errors import NotFoundError, StudioError
from padstudio.live.outputs.watch import Watch
from padstudio.live.stream.packet_shelf import PacketShelf
from padstudio.vision.detector import Detector
from padstudio.workers import detection
from padstudio.workers.inside import Limits
from padstudio.workers.pool import WorkerPool

# Of the process that makes traces: behind the session, which shares its cores.
_NICENESS, _MEMORY_BYTES = 15, 2_000_000_000
_TIMEOUT_S, _MOST_WAITING, _MOST_TRACES = 120.0, 3, 8
_MAX_PIXELS = 100_000_000
_JPEG = [cv2.IMWRITE_JPEG_QUALITY, 92]


class LastFrames:
    """Frames are decoded again from the packets that are kept.

    A trace is made by a process of its own, with the least priority, which is started when first
    asked for.

    Parameters
    ----------
    watch : Watch
        Knows the frames' numbers.
    shelf : PacketShelf
    detector : Detector
    """

    def __init__(self, watch: Watch, shelf: PacketShelf, detector: Detector) -> None:
        self._watch, self._shelf = watch, shelf
        self._pads = tuple(pad.dumps() for pad in detector.pads)
        self._camera, self._method = detector.camera.to_ros_yaml(), detector.method
        self._folder = Path(tempfile.mkdtemp(prefix="padstudio-live-"))
        self._traces: OrderedDict[int, dict[str, Any]] = OrderedDict()
        self._pool: WorkerPool | None = None
        self._turn = asyncio.Lock()

    def close(self) -> None:
        """End the process, and forget all traces."""
        if self._pool is not None:
            self._pool.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    async def picture(self, number: int) -> bytes:
        """A frame as JPEG.

        Raises
        ------
        NotFoundError
            If it is not kept.
        """
        return await run_in_threadpool(lambda: _encoded(self._decoded(number), ".jpg", _JPEG))

    async def trace(self, number: int) -> dict[str, Any]:
        """What every stage made of a frame, looked at as a still; in the form of REST.

        Raises
        ------
        NotFoundError
            If the frame is not kept.
        StudioError
            As of `padstudio.workers.detection.analyze`.
        """
        async with self._turn:
            if number not in self._traces:
                self._traces[number] = await self._made(number)
                while len(self._traces) > _MOST_TRACES:
                    old, _ = self._traces.popitem(last=False)
                    shutil.rmtree(self._folder / str(old), ignore_errors=True)
            return self._traces[number]

    def trace_picture(self, number: int, name: str) -> Path:
        """A stage's picture, of a trace that was made.

        Raises
        ------
        NotFoundError
            If there is none.
        """
        path = self._folder / str(number) / name
        if number not in self._traces or not path.is_file():
            raise NotFoundError(f"there is no picture {name} of frame {number}; ask for its trace")
        return path

    async def _made(self, number: int) -> dict[str, Any]:
        png = await run_in_threadpool(lambda: _encoded(self._decoded(number), ".png", []))
        folder = self._folder / str(number)
        folder.mkdir(exist_ok=True)
        if self._pool is None:
            self._pool = WorkerPool(1, Limits(_MEMORY_BYTES, _NICENESS), _MOST_WAITING)
        job = detection.Job(
            image=png,
            source=f"frame {number}",
            pads=self._pads,
            camera=self._camera,
            method=self._method,
            max_pixels=_MAX_PIXELS,
            pictures=folder,
        )
        call = self._pool.submit(detection.analyze, job, timeout_s=_TIMEOUT_S)
        answer = await asyncio.wrap_future(call)
        return {"number": number, "result": answer["results"][0], **answer}

    def _decoded(self, number: int) -> Image:
        frame = self._watch.report(number).frame
        picture = self._shelf.picture(frame.connection, frame.pts_s)
        return picture.bgr if isinstance(picture, YuvFrame) else picture


def _encoded(picture: Image, suffix: str, options: list[int]) -> bytes:
    done, data = cv2.imencode(suffix, picture, options)
    if not done:
        raise StudioError("the frame could not be encoded")
    return data.tobytes()
