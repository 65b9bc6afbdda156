"""A source of frames that somebody sends one by one: the browser's own camera."""

from __future__ import annotations

import threading
import time

from padstudio.arrays import Image
from padstudio.live.reports.frame import LiveFrame
from padstudio.live.reports.source import StreamState


class PushedFrames:
    """A `padstudio.live.reports.source.FrameSource` of pushed pictures."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._waiting: LiveFrame | None = None
        self._frames = self._dropped = 0
        self._size: tuple[int, int] | None = None
        self._is_closed = False

    @property
    def state(self) -> StreamState:
        """As of now."""
        with self._changed:
            return StreamState(
                phase="ended" if self._is_closed else "open" if self._frames else "connecting",
                frames=self._frames,
                dropped=self._dropped,
                connections=1 if self._frames else 0,
                size_px=self._size,
                codec="pictures",
            )

    def push(self, picture: Image, arrived_s: float, pts_s: float) -> int:
        """Hand a picture over; its number."""
        with self._changed:
            self._dropped += self._waiting is not None
            number, self._frames = self._frames, self._frames + 1
            self._size = picture.shape[1], picture.shape[0]
            self._waiting = LiveFrame(number, picture, pts_s, arrived_s, time.monotonic())
            self._changed.notify_all()
            return number

    def newest(self, timeout_s: float) -> LiveFrame | None:
        """The picture that was pushed last, once."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting is not None or self._is_closed, timeout_s)
            found, self._waiting = self._waiting, None
            return found

    def close(self) -> None:
        """No more will come."""
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()
