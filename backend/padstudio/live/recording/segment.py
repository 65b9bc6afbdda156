"""One segment: packets of a stream in a file that can be read wherever its writing ends.

References
----------
ISO/IEC 14496-12, movie fragments: each frame is one, so that a break costs the frame that was being
written; timestamps keep the stream's own unit.
"""

from __future__ import annotations

import bisect
import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from padstudio.live.recording.stream_form import StreamForm
from padstudio.live.recording.whole_file import WholeFile

_OPTIONS = {
    "movflags": "frag_every_frame+empty_moov+default_base_moof+delay_moov",
    "flush_packets": "1",
    # Edit lists count in milliseconds.
    "use_editlist": "0",
}
#: A longer gap between two frames is a clock that was set anew.
MOST_GAP_S = 10.0


@dataclass(frozen=True)
class StreamPacket:
    """A packet, apart from its stream.

    Attributes
    ----------
    data : bytes
    pts, dts : int or None
        In the unit of its stream; None where the stream does not say.
    is_keyframe : bool
    arrived_s : float
        Of `time.monotonic`.
    """

    data: bytes
    pts: int | None
    dts: int | None
    is_keyframe: bool
    arrived_s: float


class SegmentFile:
    """A segment that is being written.

    Parameters
    ----------
    path : Path
    form : StreamForm
    first : StreamPacket
        The one that it begins with; it is not written yet.

    Attributes
    ----------
    first_pts : int
        The stream's timestamp at the file's 0.
    pts : list of int
        Timestamps of the frames in the file, ascending.
    arrived_s : dict of int to float
        When each of them arrived.
    is_reordered : bool
        Some came behind others that are shown later.

    Raises
    ------
    OSError
        As of all its methods: if the disk does not take it.
    """

    def __init__(self, path: Path, form: StreamForm, first: StreamPacket) -> None:
        import av

        self.form = form
        self.first_pts = self._decoding_time(first)
        self.pts: list[int] = []
        self.arrived_s: dict[int, float] = {}
        self.is_reordered = False
        self._last_dts: int | None = None
        self._file = WholeFile(path)
        self._container = av.open(_Sink(self._file), "w", format="mp4", options=self._options())
        self._stream = self._container.add_stream_from_template(form.template)
        self._stream.time_base = form.time_base
        # What was made up, as of single JPEGs, does not say it.
        self._stream.width, self._stream.height = form.size_px

    @property
    def size_bytes(self) -> int:
        """Bytes in the file."""
        return self._file.size

    @property
    def length_s(self) -> float:
        """From its first frame to its last."""
        return length_s(self.pts, self.form) if self.pts else 0.0

    def add(self, packet: StreamPacket) -> bool:
        """Write a packet; False, and nothing is written, where its time does not go on."""
        import av

        dts = self._decoding_time(packet) - self.first_pts
        pts = dts if packet.pts is None else packet.pts - self.first_pts
        if self._last_dts is not None:
            dts = max(dts, self._last_dts + 1)
            gap_s = float((dts - self._last_dts) * self.form.time_base)
            if gap_s > MOST_GAP_S:
                return False
        if pts < dts or pts in self.arrived_s:
            return False
        out = av.Packet(packet.data)
        out.pts, out.dts, out.time_base = pts, dts, self.form.time_base
        out.is_keyframe, out.stream = packet.is_keyframe, self._stream
        self._container.mux_one(out)
        self._file.mark()
        self._last_dts = dts
        self.is_reordered |= bool(self.pts) and pts < self.pts[-1]
        bisect.insort(self.pts, pts)
        self.arrived_s[pts] = packet.arrived_s
        return True

    def sync(self) -> None:
        """Have what is there survive a power cut."""
        self._file.sync()

    def finish(self) -> None:
        """Close it, whole."""
        try:
            self._container.close()
            self._file.mark()
        finally:
            self.abandon()

    def abandon(self) -> None:
        """Close it with what was written whole; errors are nobody's concern any more."""
        with contextlib.suppress(OSError):
            self._file.cut()
        with contextlib.suppress(Exception):
            self._container.close()

    def _options(self) -> dict[str, str]:
        return _OPTIONS | {"video_track_timescale": str(self.form.time_base.denominator)}

    @staticmethod
    def _decoding_time(packet: StreamPacket) -> int:
        times = [time for time in (packet.dts, packet.pts) if time is not None]
        return times[0] if times else 0


class _Sink:
    """What the writer of containers needs of a file, which it cannot go back in."""

    def __init__(self, file: WholeFile) -> None:
        self._file = file

    def write(self, data: Any) -> int:
        return self._file.write(bytes(data))


def length_s(pts: Sequence[int], form: StreamForm) -> float:
    """How long frames are together, as `padstudio.media.video_index` counts it."""
    intervals = np.diff(np.array(pts, np.int64))
    usual = float(np.median(intervals)) if len(intervals) else 0.0
    return (float(pts[-1] - pts[0]) + usual) * float(form.time_base)
