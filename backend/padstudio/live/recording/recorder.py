"""Records a live session: takes packets and poses as they come, and never keeps them waiting."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from padstudio import __version__
from padstudio.errors import StudioError
from padstudio.geometry.camera import Camera
from padstudio.live.recording.first_packet import FirstPacket
from padstudio.live.recording.folder import (
    SessionAbout,
    SessionFile,
    begin_folder,
    without_secrets,
)
from padstudio.live.recording.options import RecordingOptions, RecordingState
from padstudio.live.recording.poses import ReadFrame
from padstudio.live.recording.segment import StreamPacket
from padstudio.live.recording.stream_form import MICROSECONDS, StreamForm, form_of, jpeg_form
from padstudio.live.recording.writer import RecordingWriter
from padstudio.live.reports.report import LiveReport, Sight
from padstudio.media.images import read_header
from padstudio.pad.spec import Pad

if TYPE_CHECKING:
    from av import Packet
    from av.video.stream import VideoStream

# Between looks at disk and state.
_TICK_S = 1.0
# A disk that hangs does not keep the program from ending.
_CLOSE_S = 20.0
_MOST_REPORTS = 10_000


@dataclass(frozen=True, eq=False)
class _Job:
    """Something for the writer to do; what it takes of memory, and whether it is a report."""

    do: Callable[[], None]
    bytes: int = 0
    is_report: bool = False


class Recorder:
    """Keeps a stream as it came and the poses beside it; a `PacketTap` and an `Output` in one.

    Its methods only put down what came; a thread of its own writes. Where the disk is too slow,
    packets are dropped: the segment ends, and the next one begins at a keyframe. What ends the
    recording, such as a full disk, stands in `state`; the session goes on.

    Whoever hands it on to a stream that is open already calls `opened` first.

    Parameters
    ----------
    folder : Path
        New, or empty.
    about : SessionAbout
        As `session_about` makes it.
    options : RecordingOptions or None
    told : callable or None
        Called in the writer's thread with every new state.

    Attributes
    ----------
    folder : Path

    Raises
    ------
    ConflictError, StorageError
        If the folder is not empty, or cannot be written.
    """

    def __init__(
        self,
        folder: Path,
        about: SessionAbout,
        options: RecordingOptions | None = None,
        told: Callable[[RecordingState], None] | None = None,
    ) -> None:
        self.folder = folder
        self._options, self._told = options or RecordingOptions(), told
        begin_folder(folder, about)
        self._state = RecordingState()
        session = SessionFile(about, time.time(), time.monotonic())
        self._writer = RecordingWriter(folder, session, self._options, self._set_state)
        self._jobs: deque[_Job] = deque()
        self._ready = threading.Condition()
        self._held = self._reports = 0
        self._dropped = [0, 0]
        self._has_gap = False
        self._is_timed, self._first = True, FirstPacket()
        self._is_closing = False
        self._connection = 0
        self._jpeg_size: tuple[int, int] | None = None
        self._thread = threading.Thread(target=self._run, name="recording", daemon=True)
        self._thread.start()

    @property
    def state(self) -> RecordingState:
        """As of now; from any thread."""
        with self._ready:
            packets, reports = self._dropped
            return replace(self._state, packets_dropped=packets, reports_dropped=reports)

    def opened(self, stream: VideoStream, connection: int) -> None:
        """A connection stands, or its stream has changed its size or codec."""
        self._connection = connection
        try:
            form = form_of(stream)
        except StudioError as error:
            detail, code = error.message, error.error_code
            self._put(_Job(lambda: self._writer.refuse(detail, code)))
            return
        self._is_timed, self._first = form.is_timed, FirstPacket()
        self._open(form, connection)

    def packet(self, packet: Packet[VideoStream], arrived_s: float) -> None:
        """A packet came; times are of `time.monotonic`."""
        if not packet.size or self._is_over():
            return
        times = packet.pts, packet.dts
        if not self._is_timed:
            times = (round(arrived_s / MICROSECONDS),) * 2
        kept = StreamPacket(bytes(packet), *times, packet.is_keyframe, arrived_s)
        for each in self._first.passed(kept):
            self._take(each)

    def closed(self) -> None:
        """The connection ended."""
        self._put(_Job(self._writer.end_connection))

    def frame_bytes(self, jpeg: bytes, pts_s: float, arrived_s: float, connection: int = 0) -> None:
        """A frame came by itself, as a JPEG file, as from a page's camera.

        Parameters
        ----------
        jpeg : bytes
        pts_s : float
            When it was taken, on the sender's clock; the same as of its `LiveFrame`.
        arrived_s : float
            Of `time.monotonic`.
        connection : int
            As of its `LiveFrame`.

        Raises
        ------
        ImageError, LimitError
            If it is no picture.
        """
        if self._is_over():
            return
        header = read_header(jpeg)
        size = (header.width, header.height)
        if self._jpeg_size != size or self._connection != connection:
            self._jpeg_size, self._connection = size, connection
            self._open(jpeg_form(size), connection)
        pts = round(pts_s / MICROSECONDS)
        self._take(StreamPacket(jpeg, pts, pts, True, arrived_s))

    def take(self, report: LiveReport) -> None:
        """A frame was read."""
        frame = report.frame
        read = ReadFrame(
            frame.pts_s,
            frame.connection,
            frame.number,
            frame.is_damaged,
            1e3 * (report.posed_s - frame.arrived_s),
            replace(report.detection, trace=None),
        )
        with self._ready:
            if self._reports >= _MOST_REPORTS or self._is_closing:
                self._dropped[1] += not self._is_closing
                return
        self._put(_Job(lambda: self._writer.add_pose(read), is_report=True))

    def sight_changed(self, sight: Sight, detail: str) -> None:
        """The pad or the stream was lost or found: the frames' lines say so already."""

    def close(self) -> None:
        """End the recording, and wait until it is whole."""
        with self._ready:
            self._is_closing = True
            self._ready.notify()
        self._thread.join(_CLOSE_S)

    def _open(self, form: StreamForm, connection: int) -> None:
        now_s = time.monotonic()
        self._put(_Job(lambda: self._writer.open(form, connection, now_s)))

    def _take(self, packet: StreamPacket) -> None:
        """Put a packet down, or drop it, and all after it up to the next keyframe."""
        size = len(packet.data)
        with self._ready:
            has_room = self._held + size <= self._options.held_bytes
            if not has_room or (self._has_gap and not packet.is_keyframe):
                self._dropped[0] += 1
                self._has_gap = True
                return
            told = tuple(self._dropped) if self._has_gap else None
            self._has_gap = False

        def write() -> None:
            if told is not None:
                self._writer.dropped(*told)
            self._writer.add(packet)

        self._put(_Job(write, size))

    def _put(self, job: _Job) -> None:
        with self._ready:
            if self._is_closing:
                return
            self._held += job.bytes
            self._reports += job.is_report
            self._jobs.append(job)
            self._ready.notify()

    def _is_over(self) -> bool:
        with self._ready:
            return self._is_closing or self._state.phase in ("stopped", "closed")

    def _set_state(self, state: RecordingState) -> None:
        with self._ready:
            self._state = state
        if self._told is not None:
            self._told(self.state)

    def _run(self) -> None:
        self._writer.begin()
        tick_s = time.monotonic() + _TICK_S
        while True:
            with self._ready:
                if not self._jobs and not self._is_closing:
                    self._ready.wait(max(0.0, tick_s - time.monotonic()))
                job = self._jobs.popleft() if self._jobs else None
                is_done = job is None and self._is_closing
            if job is not None:
                job.do()
                with self._ready:
                    self._held -= job.bytes
                    self._reports -= job.is_report
            if is_done:
                break
            if time.monotonic() >= tick_s:
                self._writer.tick()
                tick_s = time.monotonic() + _TICK_S
        self._writer.dropped(*self._dropped)
        self._writer.close()


def session_about(
    pads: Pad | Iterable[Pad],
    camera: Camera,
    source: str = "",
    method: str = "dense",
    params: Mapping[str, Any] | None = None,
) -> SessionAbout:
    """What a recording is of.

    Parameters
    ----------
    pads : Pad or iterable of Pad
    camera : Camera
    source : str
        The stream's address; no password of it is kept.
    method : {"dense", "paper"}
    params : mapping or None
        The detector's parameters that are not the defaults, by group and name.
    """
    known = (pads,) if isinstance(pads, Pad) else tuple(pads)
    return SessionAbout(
        tuple(pad.to_dict() for pad in known),
        camera.to_ros_yaml(),
        without_secrets(source),
        method,
        dict(params or {}),
        __version__,
    )


def new_folder(base: Path) -> Path:
    """Where in a folder a recording that begins now goes: named by the time, UTC."""
    return base / datetime.now(UTC).strftime("%Y-%m-%dT%H%M%SZ")
