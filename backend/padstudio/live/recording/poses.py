"""The poses beside a segment, a line a frame, in the frames' order."""

from __future__ import annotations

import bisect
import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from padstudio.live.recording.segment import SegmentFile
from padstudio.live.recording.whole_file import WholeFile
from padstudio.vision.stage.detection import Detection

Record = dict[str, Any]
#: Why a frame has no pose that was read in no time, at the stage ``read``.
DROPPED_LIVE = "dropped_live"
#: What is said of such a frame.
DROPPED: Record = {
    "status": "failed",
    "stage": "read",
    "reason": DROPPED_LIVE,
    "detail": "it came while an earlier frame was being read",
    "advice": "run the flight again: that reads every frame",
    "elapsed_ms": {},
}
_UPPER = np.triu_indices(6)


@dataclass(frozen=True, eq=False)
class ReadFrame:
    """What a frame that was read came to.

    Attributes
    ----------
    pts_s : float
        On the stream's own clock.
    connection, number : int
        As of `padstudio.live.reports.frame.LiveFrame`.
    is_damaged : bool
    latency_ms : float
        From its arrival to its pose.
    detection : Detection
    """

    pts_s: float
    connection: int
    number: int
    is_damaged: bool
    latency_ms: float
    detection: Detection


class PosesFile:
    """The poses file of a segment that is, or was, being written.

    Parameters
    ----------
    path : Path
    segment : SegmentFile
    name : str
        The video, as lines call it.
    connection : int
    place : (int, float)
        Number of the segment's first frame among all, and its time in a flight of all segments, s.
    unix_offset_s : float
        Unix time less `time.monotonic`.

    Raises
    ------
    OSError
        As of all its methods: if the disk does not take it.
    """

    def __init__(
        self,
        path: Path,
        segment: SegmentFile,
        name: str,
        connection: int,
        place: tuple[int, float],
        unix_offset_s: float,
    ) -> None:
        self.connection = connection
        self._segment, self._name, self._unix_offset_s = segment, name, unix_offset_s
        self._first_frame, self._start_s = place
        self._written = 0
        self._file = WholeFile(path)

    @property
    def size_bytes(self) -> int:
        """Bytes in the file."""
        return self._file.size

    def place_of(self, read: ReadFrame) -> int | None:
        """Which of the segment's frames it is; None where it is none of them."""
        if read.connection != self.connection:
            return None
        base = self._segment.form.time_base
        pts = round(read.pts_s * base.denominator / base.numerator) - self._segment.first_pts
        place = bisect.bisect_left(self._segment.pts, pts)
        found = place < len(self._segment.pts) and self._segment.pts[place] == pts
        return place if found else None

    def add(self, place: int, read: ReadFrame) -> bool:
        """Write a frame's line, after those of frames before it that nobody read.

        False where that one's line is there already.
        """
        if place < self._written:
            return False
        self._drop_until(place)
        record = read.detection.to_record(self._name)
        record |= _covariances(read.detection)
        if read.is_damaged:
            record["damaged"] = True
        told = {"number": read.number, "latency_ms": round(read.latency_ms, 3)}
        self._write(place, record, told)
        return True

    def sync(self) -> None:
        """Have what is there survive a power cut."""
        self._file.sync()

    def finish(self) -> None:
        """Write the lines of all that is left, and close it."""
        self._drop_until(len(self._segment.pts))
        self._file.close()

    def abandon(self) -> None:
        """Close it with the lines that are whole."""
        self._file.cut()

    def _drop_until(self, place: int) -> None:
        for missed in range(self._written, place):
            self._write(missed, DROPPED, {})

    def _write(self, place: int, record: Record, told: Record) -> None:
        segment, pts = self._segment, self._segment.pts[place]
        seconds = float(segment.form.time_base)
        unix_s = round(segment.arrived_s[pts] + self._unix_offset_s, 6)
        line = {
            "source": self._name,
            "frame": self._first_frame + place,
            "time_s": self._start_s + (pts - segment.pts[0]) * seconds,
            **{k: v for k, v in record.items() if k not in ("source", "frame", "time_s")},
            "pts": pts,
            "live": {"unix_s": unix_s, **told},
        }
        self._file.write(_line(line))
        self._file.mark()
        self._written = place + 1


def _covariances(detection: Detection) -> Record:
    """Covariances as of a poses file: upper triangles by rows."""
    found: Record = {}
    if detection.uncertainty is not None:
        found["covariance"] = detection.uncertainty.covariance[_UPPER].tolist()
    if detection.single is not None:
        single = detection.single
        fields = detection.to_record("")["single"]
        found["single"] = fields | {"covariance": single.uncertainty.covariance[_UPPER].tolist()}
    return found


def _line(record: Record) -> bytes:
    try:
        text = json.dumps(record, ensure_ascii=False, allow_nan=False)
    except ValueError:
        text = json.dumps(_without_nan(record), ensure_ascii=False)
    return text.encode() + b"\n"


def _without_nan(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_nan(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_without_nan(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
