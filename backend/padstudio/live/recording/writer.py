"""Writes a recording: segments, the poses beside them, the session's file; in one thread."""

from __future__ import annotations

import contextlib
import logging
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from padstudio.errors import StorageError, full_disk
from padstudio.live.recording.folder import (
    SegmentEntry,
    SessionFile,
    poses_name,
    video_name,
    write_session,
)
from padstudio.live.recording.options import RecordingOptions, RecordingState
from padstudio.live.recording.poses import PosesFile, ReadFrame
from padstudio.live.recording.segment import SegmentFile, StreamPacket
from padstudio.live.recording.stream_form import StreamForm

logger = logging.getLogger(__name__)

# A stream without frames that stand alone is cut at any keyframe, so many times as late.
_LATE = 4
# Frames that may be read before their packets are written.
_MOST_EARLY = 4


class RecordingWriter:
    """All that is done on disk; only one thread calls it.

    Parameters
    ----------
    folder : Path
        As `padstudio.live.recording.folder.begin_folder` made it.
    session : SessionFile
    options : RecordingOptions
    changed : callable
        Told of every new state.
    """

    def __init__(
        self,
        folder: Path,
        session: SessionFile,
        options: RecordingOptions,
        changed: Callable[[RecordingState], None],
    ) -> None:
        self._folder, self._session, self._options = folder, session, options
        self._changed = changed
        self._state = RecordingState()
        self._form: StreamForm | None = None
        self._connection = 0
        self._segment: SegmentFile | None = None
        self._poses: list[PosesFile] = []
        self._early: list[ReadFrame] = []
        self._closed_bytes = self._closed_frames = 0
        self._next = (0, 0.0)

    @property
    def is_stopped(self) -> bool:
        """Nothing is written any more."""
        return self._state.phase in ("stopped", "closed")

    def begin(self) -> None:
        """Write the session's file for the first time."""
        with self._guarded():
            write_session(self._folder, self._session)
            self._check_room()

    def open(self, form: StreamForm, connection: int, arrived_s: float) -> None:
        """A connection stands, or its stream is another one."""
        if self.is_stopped:
            return
        with self._guarded():
            self._end_segment()
            self._form, self._connection, self._early = form, connection, []
            self._session.connections.append(
                {
                    "connection": connection,
                    "unix_s": self._session.unix_of(arrived_s),
                    "codec": form.codec,
                    "size_px": list(form.size_px),
                }
            )
            self._set(phase="waiting", detail="", code="")

    def refuse(self, detail: str, code: str) -> None:
        """The stream that was opened is not recorded."""
        if self.is_stopped:
            return
        with self._guarded():
            self._end_segment()
            self._form = None
            self._set(phase="refused", detail=detail, code=code)

    def end_connection(self) -> None:
        """The connection ended."""
        if self.is_stopped:
            return
        with self._guarded():
            self._end_segment()
            self._form = None

    def dropped(self, packets: int, reports: int) -> None:
        """So many in all were dropped on the way here; where packets, the segment ends."""
        if self.is_stopped:
            return
        with self._guarded():
            if packets > self._session.packets_dropped:
                self._end_segment()
            self._session.packets_dropped, self._session.reports_dropped = packets, reports
            self._set(packets_dropped=packets, reports_dropped=reports)

    def add(self, packet: StreamPacket) -> None:
        """Write a packet."""
        if self.is_stopped or self._form is None:
            return
        with self._guarded():
            if self._segment is not None and self._is_due(self._segment, packet):
                self._end_segment()
            is_written = self._segment is not None and self._segment.add(packet)
            if not is_written:
                self._end_segment()
            if not is_written and packet.is_keyframe:
                self._begin_segment(packet)
        self._place_early()

    def add_pose(self, read: ReadFrame) -> None:
        """Write what a frame came to, where it is one of the recording."""
        if self.is_stopped:
            return
        with self._guarded():
            for poses in reversed(self._poses):
                place = poses.place_of(read)
                if place is not None:
                    poses.add(place, read)
                    # Frames are read in their order: none of a segment before comes any more.
                    while self._poses[0] is not poses:
                        self._finish_poses()
                    return
            # A connection's first packets wait for their times.
            self._early = [*self._early, read][-_MOST_EARLY:]

    def _place_early(self) -> None:
        early, self._early = self._early, []
        for read in early:
            self.add_pose(read)

    def tick(self) -> None:
        """Once a second: have it survive a power cut, and look at the room that is left."""
        if self.is_stopped:
            return
        with self._guarded():
            if self._segment is not None:
                self._segment.sync()
            for poses in self._poses:
                poses.sync()
            self._check_room()
            self._set()

    def close(self) -> None:
        """End the recording."""
        if self.is_stopped:
            return
        with self._guarded():
            self._end_all("")
            self._set(phase="closed")

    def _is_due(self, segment: SegmentFile, packet: StreamPacket) -> bool:
        """Whether a segment ends before a packet."""
        if not packet.is_keyframe:
            return False
        share = max(
            segment.length_s / self._options.segment_s,
            segment.size_bytes / self._options.segment_bytes,
        )
        # Without reordering no frame from a keyframe on needs one before it.
        is_clean = not segment.is_reordered or segment.form.is_clean_start(packet.data)
        return share >= (1 if is_clean else _LATE)

    def _begin_segment(self, packet: StreamPacket) -> None:
        assert self._form is not None
        self._check_room()
        number = len(self._session.segments) + 1
        name, lines = video_name(number), poses_name(number)
        session, form = self._session, self._form
        segment = self._segment = SegmentFile(self._folder / name, form, packet)
        offset_s = session.unix_s - session.monotonic_s
        self._poses.append(
            PosesFile(
                *(self._folder / lines, segment, name, self._connection, self._next, offset_s)
            )
        )
        session.segments.append(
            SegmentEntry(
                name,
                lines,
                self._connection,
                form.codec,
                form.size_px,
                (form.time_base.numerator, form.time_base.denominator),
                segment.first_pts,
                *self._next,
                session.unix_of(packet.arrived_s),
            )
        )
        segment.add(packet)
        write_session(self._folder, session)
        self._set(phase="recording", segments=number)

    def _end_segment(self) -> None:
        """Close the segment; its poses stay open for those that are on the way."""
        segment, self._segment = self._segment, None
        if segment is None:
            return
        entry = self._session.segments[-1]
        entry.frames, entry.duration_s = len(segment.pts), segment.length_s
        self._next = (entry.first_frame + entry.frames, entry.start_s + entry.duration_s)
        self._closed_frames += entry.frames
        segment.finish()
        self._closed_bytes += segment.size_bytes
        write_session(self._folder, self._session)
        if not self.is_stopped:
            self._set(phase="waiting")

    def _end_all(self, code: str) -> None:
        self._end_segment()
        while self._poses:
            self._finish_poses()
        session = self._session
        session.ended_unix_s, session.ended_by = session.unix_of(time.monotonic()), code
        write_session(self._folder, session)

    def _finish_poses(self) -> None:
        """Close those of the first segment that are open."""
        self._poses[0].finish()
        del self._poses[0]

    def _abandon_all(self, code: str) -> None:
        """Keep what is whole, where the disk takes no more."""
        session, segment = self._session, self._segment
        if segment is not None:
            segment.abandon()
        for poses in self._poses:
            poses.abandon()
        self._segment, self._poses = None, []
        if session.segments:
            # How many frames are whole shows when it is read.
            session.segments[-1].frames = session.segments[-1].duration_s = None
        session.ended_unix_s, session.ended_by = session.unix_of(time.monotonic()), code
        with contextlib.suppress(OSError):
            write_session(self._folder, session)

    def _check_room(self) -> None:
        """Raise where the disk or the recording is as full as it may be."""
        free = shutil.disk_usage(self._folder).free
        if free < self._options.least_free_bytes:
            raise StorageError(
                f"the disk has {free / 1e6:.0f} MB of room, less than the "
                f"{self._options.least_free_bytes / 1e6:.0f} MB to be left",
                code="disk_low",
            )
        most = self._options.most_bytes
        if most is not None and self._bytes() >= most:
            raise StorageError(
                f"the recording has the {most / 1e6:.0f} MB that it may have",
                code="recording_full",
            )

    def _bytes(self) -> int:
        open_bytes = self._segment.size_bytes if self._segment else 0
        return self._closed_bytes + open_bytes + sum(poses.size_bytes for poses in self._poses)

    def _set(self, **values: object) -> None:
        frames = self._closed_frames + (len(self._segment.pts) if self._segment else 0)
        told = {"frames": frames, "bytes": self._bytes(), **values}
        self._state = replace(self._state, **told)  # type: ignore[arg-type]
        self._changed(self._state)

    @contextlib.contextmanager
    def _guarded(self) -> Iterator[None]:
        """Whatever goes wrong ends the recording, not the session."""
        try:
            yield
        except StorageError as error:
            self._stop(error.message, error.error_code)
        except OSError as error:
            full = full_disk(error)
            what = "the disk is full" if full else f"the disk takes no more ({error.strerror})"
            self._stop(what, "disk_full" if full else "cannot_record")
        except Exception as error:
            logger.exception("a recording brought a defect to light")
            self._stop(f"a defect of the program: {error!r}", "internal_error")

    def _stop(self, why: str, code: str) -> None:
        self._state = replace(self._state, phase="stopped")
        try:
            self._end_all(code)
        except Exception:
            self._abandon_all(code)
        detail = f"the recording ended: {why}; what is there is kept"
        self._set(phase="stopped", detail=detail, code=code)
