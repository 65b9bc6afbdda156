"""The camera in the size of each frame."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

from padstudio.errors import SpecError
from padstudio.geometry.camera import Camera

Record = dict[str, Any]
Size = tuple[int, int]
T = TypeVar("T")


class FrameCameras:
    """A calibration, scaled to the frames of records.

    Parameters
    ----------
    camera : Camera
    frame_px : callable or None
        The size of a record's frame, (width, height), where the record does not say it, as those
        of older versions do not; None where that is not known.
    """

    def __init__(self, camera: Camera, frame_px: Callable[[Record], Size | None] | None) -> None:
        self._camera, self._frame_px = camera, frame_px
        self._by_size: dict[Size, Camera] = {}

    def of(self, record: Record) -> Camera | None:
        """The camera of a record's frame; None of one that could not be read.

        Raises
        ------
        SpecError
            If the frame was read, and nothing tells its size.
        CameraMismatchError
            If the camera is of another aspect.
        """
        told = record.get("frame_px")
        size: Size | None = (told[0], told[1]) if told else None
        if size is None and record.get("stage") != "read":
            size = self._frame_px(record) if self._frame_px else None
            if size is None:
                raise SpecError(
                    f"nothing says how large the frames of {record['source']} are, to which the "
                    "camera has to be scaled: give their size, or the file itself where the poses "
                    "name it",
                    code="frame_size_unknown",
                )
        if size is None:
            return None
        if size not in self._by_size:
            self._by_size[size] = self._camera.for_frame(*size)
        return self._by_size[size]

    def beside(
        self, items: Iterable[T], record_of: Callable[[T], Record]
    ) -> Iterator[tuple[T, Camera]]:
        """Items with their cameras.

        A frame that could not be read has the camera of the one before, the first ones that of the
        first that could; where there is none, it is the calibration's own.
        """
        last: Camera | None = None
        waiting: list[T] = []
        for item in items:
            last = self.of(record_of(item)) or last
            if last is None:
                waiting.append(item)
                continue
            yield from ((early, last) for early in waiting)
            waiting.clear()
            yield item, last
        yield from ((early, self._camera) for early in waiting)
