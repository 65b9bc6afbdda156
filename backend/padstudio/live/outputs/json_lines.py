"""JSON lines to a file descriptor, by a thread of its own: a slow reader delays no pose.

Lines wait in a queue of bounded length. Where the reader falls behind, the oldest reports go, the
newest stay, and the next line that is written says how many went.
"""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable
from typing import Any

from padstudio.live.outputs.records import Records, event_record, line_of, sight_record
from padstudio.live.reports.event import EventKind
from padstudio.live.reports.report import LiveReport, Sight, without_picture

#: Reports that wait for a slow reader: a third of a second of them.
MOST_WAITING = 10
# Events are few; so many wait at the most.
_MOST_EVENTS = 100
# A reader that takes nothing for so long at the end is not waited for.
_END_S = 1.0


class JsonLines:
    """An output, and one of events.

    Parameters
    ----------
    descriptor : int
        Open for writing; not closed.
    records : Records
    on_broken : callable, optional
        Called, once and from the writing thread, where the reader has gone away.

    Attributes
    ----------
    written, dropped : int
        Lines of reports that were written, and that were not, for the reader was too slow.
    is_broken : bool
        The reader has gone away.
    """

    def __init__(
        self, descriptor: int, records: Records, on_broken: Callable[[], None] | None = None
    ) -> None:
        self._descriptor, self._records, self._on_broken = descriptor, records, on_broken
        self._reports: deque[LiveReport] = deque()
        self._events: deque[dict[str, Any]] = deque(maxlen=_MOST_EVENTS)
        self._changed = threading.Condition()
        self._is_over = False
        self.written = self.dropped = self._untold = 0
        self.is_broken = False
        self._thread = threading.Thread(target=self._write, name="json-lines", daemon=True)
        self._thread.start()

    def take(self, report: LiveReport) -> None:
        """Have a line written of it."""
        with self._changed:
            self._reports.append(without_picture(report))
            if len(self._reports) > MOST_WAITING:
                self._reports.popleft()
                self.dropped, self._untold = self.dropped + 1, self._untold + 1
            self._changed.notify()

    def sight_changed(self, sight: Sight, detail: str) -> None:
        """Have a line written of it."""
        self._add(sight_record(sight, detail))

    def stream_changed(self, kind: EventKind, detail: str, code: str) -> None:
        """Have a line written of it."""
        self._add(event_record(kind, detail, code))

    def close(self) -> None:
        """Write what waits, if the reader takes it."""
        with self._changed:
            self._is_over = True
            self._changed.notify()
        self._thread.join(_END_S)

    def _add(self, event: dict[str, Any]) -> None:
        with self._changed:
            self._events.append(event)
            self._changed.notify()

    def _write(self) -> None:
        while (record := self._next()) is not None:
            line = line_of(record)
            try:
                while line:
                    # All at once, but where a signal comes in between.
                    line = line[os.write(self._descriptor, line) :]
            except OSError:
                self.is_broken = True
                if self._on_broken is not None:
                    self._on_broken()
                return
            self.written += "status" in record

    def _next(self) -> dict[str, Any] | None:
        """What is to be written next; None at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._events or self._reports or self._is_over)
            if self._events:
                return self._events.popleft()
            if not self._reports:
                return None
            report, untold = self._reports.popleft(), self._untold
            self._untold = 0
        record = self._records.of(report)
        if untold:
            record["live"]["not_written"] = untold
        return record
