"""Recording that is switched on and off while a session goes on."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

from padstudio.errors import ConflictError
from padstudio.live.recording.folder import SessionAbout
from padstudio.live.recording.recorder import Recorder
from padstudio.live.reports.report import LiveReport


class RecordingSwitch:
    """A `padstudio.live.reports.source.PacketTap` that hands on to a recorder while there is one.

    A recorder that comes in amid a connection is told of its stream first, in the thread that
    receives packets, as streams want it.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._recorder: Recorder | None = None
        self._open: tuple[Any, int] | None = None
        self._is_told = False
        self._last: dict[str, Any] | None = None

    @property
    def is_on(self) -> bool:
        """True while a recording is under way."""
        with self._lock:
            return self._recorder is not None

    def start(self, folder: Path, about: SessionAbout) -> None:
        """Begin a recording in a new folder.

        Raises
        ------
        ConflictError
            If one is under way, or the folder is not empty.
        StorageError
            If it cannot be written.
        """
        with self._lock:
            if self._recorder is not None:
                raise ConflictError("this session is being recorded already")
            self._recorder, self._is_told = Recorder(folder, about), False

    def stop(self) -> None:
        """End the recording, and wait until it is whole; nothing where there is none."""
        with self._lock:
            recorder, self._recorder = self._recorder, None
        if recorder is not None:
            recorder.close()
            with self._lock:
                self._last = _told(recorder, is_on=False)

    def state(self) -> dict[str, Any] | None:
        """How the recording is, or how the last one ended; None where there was none."""
        with self._lock:
            return self._last if self._recorder is None else _told(self._recorder, is_on=True)

    # As a tap

    def opened(self, stream: Any, connection: int) -> None:
        """A connection stands."""
        with self._lock:
            self._open, self._is_told = (stream, connection), self._recorder is not None
            recorder = self._recorder
        if recorder is not None:
            recorder.opened(stream, connection)

    def packet(self, packet: Any, arrived_s: float) -> None:
        """A packet came."""
        with self._lock:
            recorder, opened, is_told = self._recorder, self._open, self._is_told
            self._is_told = recorder is not None
        if recorder is None:
            return
        if not is_told and opened is not None:
            recorder.opened(*opened)
        recorder.packet(packet, arrived_s)

    def closed(self) -> None:
        """The connection ended."""
        with self._lock:
            self._open, recorder = None, self._recorder
        if recorder is not None:
            recorder.closed()

    # Of frames that are pushed, and of all that are read

    def frame_bytes(self, jpeg: bytes, pts_s: float, arrived_s: float) -> None:
        """A frame came as a file."""
        with self._lock:
            recorder = self._recorder
        if recorder is not None:
            recorder.frame_bytes(jpeg, pts_s, arrived_s)

    def take(self, report: LiveReport) -> None:
        """A frame was read."""
        with self._lock:
            recorder = self._recorder
        if recorder is not None:
            recorder.take(report)


def _told(recorder: Recorder, *, is_on: bool) -> dict[str, Any]:
    state = recorder.state
    return {
        "id": recorder.folder.name,
        "is_on": is_on,
        "phase": state.phase,
        "detail": state.detail,
        "frames": state.frames,
        "bytes": state.bytes,
    }
