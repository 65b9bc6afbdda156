"""What a session's watchers are told, kept once for all of them.

In the thread that reads frames a report is put down, and who waits is woken; its record is made by
who asks first.
"""

from __future__ import annotations

import json
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from padstudio.errors import NotFoundError
from padstudio.live.outputs.records import Records, event_record, sight_record
from padstudio.live.reports.event import EventKind
from padstudio.live.reports.report import LiveReport, Sight, without_picture

#: Entries that are kept: those of the last ten seconds at 60 frames a second, and more.
KEPT = 720


@dataclass(eq=False)
class Entry:
    """A report or an event.

    Attributes
    ----------
    number : int
        Counts entries from 1.
    kind : {"pose", "event"}
    report : LiveReport or None
        Without its picture.
    make : callable
        Gives the record.
    """

    number: int
    kind: Literal["pose", "event"]
    report: LiveReport | None
    make: Callable[[], dict[str, Any]] = field(repr=False)

    @cached_property
    def text(self) -> str:
        """The record as JSON on one line."""
        return json.dumps(self.make(), ensure_ascii=False)


class Watch:
    """An output, and one of events; asked from any thread.

    Parameters
    ----------
    records : Records
    """

    def __init__(self, records: Records) -> None:
        self._records = records
        self._lock = threading.Lock()
        self._entries: deque[Entry] = deque(maxlen=KEPT)
        self._count = 0
        self._wake: Callable[[], None] | None = None
        self.is_over = False

    def on_change(self, wake: Callable[[], None] | None) -> None:
        """Have somebody called, in the thread that reads frames, when there is more."""
        self._wake = wake

    def take(self, report: LiveReport) -> None:
        """Put a report down."""
        kept = without_picture(report)
        self._add("pose", kept, lambda: self._records.of(kept))

    def sight_changed(self, sight: Sight, detail: str) -> None:
        """Put it down."""
        record = sight_record(sight, detail)
        self._add("event", None, lambda: record)

    def stream_changed(self, kind: EventKind, detail: str, code: str) -> None:
        """Put it down."""
        record = event_record(kind, detail, code)
        self._add("event", None, lambda: record)

    def close(self) -> None:
        """Nothing more will come."""
        self.is_over = True
        if self._wake is not None:
            self._wake()

    def newest(self) -> int:
        """The number of the newest entry."""
        with self._lock:
            return self._count

    def after(self, number: int) -> list[Entry]:
        """Entries after one, as far as they are kept, in their order."""
        with self._lock:
            return [entry for entry in self._entries if entry.number > number]

    def reports(self) -> list[LiveReport]:
        """Reports that are kept, without their pictures."""
        with self._lock:
            return [entry.report for entry in self._entries if entry.report is not None]

    def report(self, frame: int) -> LiveReport:
        """That of a frame.

        Raises
        ------
        NotFoundError
            If it is not kept.
        """
        for report in self.reports():
            if report.frame.number == frame:
                return report
        raise NotFoundError(
            f"frame {frame} is not kept: the last ten seconds are, of frames that were read",
            code="frame_gone",
        )

    def _add(
        self,
        kind: Literal["pose", "event"],
        report: LiveReport | None,
        make: Callable[[], dict[str, Any]],
    ) -> None:
        with self._lock:
            self._count += 1
            self._entries.append(Entry(self._count, kind, report, make))
        if self._wake is not None:
            self._wake()
