"""The pictures that records name as their source: files of stills, frames of videos."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from padstudio.errors import StudioError
from padstudio.flights.exports.options import Record
from padstudio.flights.exports.sources import to_jpeg
from padstudio.media import images
from padstudio.media.video_frames import read_frames
from padstudio.media.video_index import read_index


class FilePictures:
    """Frames as JPEG files, for records of a poses file in its order.

    Parameters
    ----------
    folder : Path
        To which sources are relative.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._video: tuple[str, Iterator[tuple[int, bytes | None]]] | None = None

    def __call__(self, record: Record) -> bytes | None:
        source, frame = record["source"], record["frame"]
        try:
            if record.get("time_s") is None:
                return to_jpeg(images.read(self._folder / source))
            if self._video is None or self._video[0] != source:
                self._video = source, _frames(self._folder / source)
            # Videos are decoded once, forward; frames that were left out are passed over.
            found = (data for number, data in self._video[1] if number >= frame)
            return next(found, None)
        except StudioError:
            return None


def _frames(path: Path) -> Iterator[tuple[int, bytes | None]]:
    index = read_index(str(path))
    for number, picture in enumerate(read_frames(str(path), index.pts.tolist())):
        yield number, None if picture.bgr is None else to_jpeg(picture.bgr)
