"""The frames of the last seconds, to scrub back to: their records, and the pictures of some."""

from __future__ import annotations

import threading
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

from padstudio.errors import NotFoundError

#: How far back one can go, s.
KEPT_S = 10.0
# Whatever their rate, pictures of no more frames are kept: about thirty a second of small ones.
_MOST_FRAMES, _MOST_BYTES = 300, 96_000_000


@dataclass(frozen=True, eq=False)
class KeptFrame:
    """A frame that was read, with its picture.

    Attributes
    ----------
    number : int
        Of the session.
    taken_s : float
        Since the session began, as far as that is known.
    record : dict
        A line of a poses file.
    marks : dict
        As of `padstudio.vision.overlays.marks.Marks.to_dict`.
    picture : bytes
        The file.
    media_type : str
        Of the file.
    """

    number: int
    taken_s: float
    record: dict[str, Any]
    marks: dict[str, Any]
    picture: bytes
    media_type: str

    def to_dict(self) -> dict[str, Any]:
        """Without the picture; JSON-serialisable."""
        return {
            "number": self.number,
            "taken_s": round(self.taken_s, 3),
            "record": self.record,
            "marks": self.marks,
        }

    def line(self) -> dict[str, Any]:
        """What a list says of it."""
        position = self.record.get("position_mm")
        return {
            "number": self.number,
            "taken_s": round(self.taken_s, 3),
            "status": self.record["status"],
            "reason": self.record.get("reason"),
            "height_mm": position[2] if position else None,
        }


class FrameShelf:
    """Keeps the newest frames; for any thread."""

    def __init__(self) -> None:
        self._frames: OrderedDict[int, KeptFrame] = OrderedDict()
        self._bytes = 0
        self._is_closed = False
        self._changed = threading.Condition()

    def add(self, frame: KeptFrame) -> None:
        """Keep a frame, and let go of those that are too old."""
        with self._changed:
            self._frames[frame.number] = frame
            self._bytes += len(frame.picture)
            while self._is_over(frame):
                _, gone = self._frames.popitem(last=False)
                self._bytes -= len(gone.picture)
            self._changed.notify_all()

    def _is_over(self, newest: KeptFrame) -> bool:
        oldest = next(iter(self._frames.values()))
        too_many = len(self._frames) > _MOST_FRAMES or self._bytes > _MOST_BYTES
        too_old = newest.taken_s - oldest.taken_s > KEPT_S
        return len(self._frames) > 1 and (too_many or too_old)

    def get(self, number: int) -> KeptFrame:
        """One of them; raises `NotFoundError` where it is not kept (any more)."""
        with self._changed:
            found = self._frames.get(number)
        if found is None:
            raise NotFoundError(
                f"frame {number} is not kept; only those of the last {KEPT_S:.0f} s are",
                code="frame_not_kept",
            )
        return found

    def newest(self, after: int, timeout_s: float) -> KeptFrame | None:
        """The newest, waiting for one of a higher number; None where there is none at all."""
        with self._changed:
            self._changed.wait_for(lambda: self._is_closed or self._last() > after, timeout_s)
            return next(reversed(self._frames.values()), None)

    def close(self) -> None:
        """Let nobody wait any longer."""
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()

    def list(self) -> list[dict[str, Any]]:
        """What is kept, the oldest first."""
        with self._changed:
            return [frame.line() for frame in self._frames.values()]

    def _last(self) -> int:
        return next(reversed(self._frames), -1)
