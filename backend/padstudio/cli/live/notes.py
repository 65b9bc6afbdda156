"""What a live session tells people on stderr."""

from __future__ import annotations

import json
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from padstudio.cli.support import note, show_table
from padstudio.live.reports.event import EventKind
from padstudio.live.reports.report import LiveReport, Sight
from padstudio.live.stats import line_for_people

# Figures are shown so often.
_EVERY_S = 5.0


class Notes:
    """An output that tells what changes, one line each."""

    def take(self, report: LiveReport) -> None:
        """Frames are for programs."""

    def sight_changed(self, sight: Sight, detail: str) -> None:
        """Tell it."""
        note(f"{sight}: {detail}")

    def stream_changed(self, kind: EventKind, detail: str, code: str) -> None:
        """Tell it; how it ended is told in the end."""
        if kind not in ("ended", "refused"):
            note(f"stream {kind}{f': {detail}' if detail else ''}{f' ({code})' if code else ''}")

    def close(self) -> None:
        """Nothing is held."""


class StatsTeller:
    """Tells figures every few seconds, in a thread of its own.

    Parameters
    ----------
    stats : callable
        The figures as of now.
    as_json : bool
    """

    def __init__(self, stats: Callable[[], dict[str, Any]], *, as_json: bool) -> None:
        self._stats, self._as_json = stats, as_json
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="stats", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End with a last line, or a table."""
        self._is_over.set()
        self._thread.join()
        if self._as_json:
            self._tell()
        else:
            show_latencies(self._stats())

    def _run(self) -> None:
        while not self._is_over.wait(_EVERY_S):
            self._tell()

    def _tell(self) -> None:
        stats = self._stats()
        if self._as_json:
            print(json.dumps({"time_unix_s": round(time.time(), 3)} | stats), file=sys.stderr)
        else:
            note(line_for_people(stats))


def show_latencies(stats: dict[str, Any]) -> None:
    """A table of every stage's latency."""
    rows = []
    for name, stage in stats["latency_ms"].items():
        figures = [stage[key] for key in ("median_ms", "p95_ms", "all_median_ms", "all_p95_ms")]
        title = name.replace("_to_", " → ")
        rows.append((title, str(stage["frames"]), *(f"{value:.1f}" for value in figures)))
    columns = ("latency, ms", "frames", "median", "95 %", "median of all", "95 % of all")
    caption = "median and 95 %: of the last 300 frames"
    show_table(columns, rows, right=columns[1:], caption=caption, to_stderr=True)


def show_end(stats: dict[str, Any]) -> None:
    """How a session ended."""
    counts = stats["counts"]
    note(line_for_people(stats))
    reasons = sorted(counts["reasons"].items(), key=lambda item: -item[1])
    if reasons:
        note("without a pose: " + ", ".join(f"{reason} {count}" for reason, count in reasons))
    for name, count in counts["output_errors"].items():
        note(f"{name}: {count} errors; PADSTUDIO_DEBUG=1 tells the first")
