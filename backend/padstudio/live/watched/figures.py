"""Figures of a session: how many frames are read, how fast, how late poses are."""

from __future__ import annotations

import statistics
from collections import deque
from dataclasses import dataclass
from typing import Any

from padstudio.live.reports.report import LiveReport
from padstudio.live.watched.shelf import KEPT_S

# Frames whose figures are kept: more than ten seconds of them.
_MOST = 2000


@dataclass(frozen=True)
class _Seen:
    posed_s: float
    is_read: bool
    late_ms: float
    work_ms: float


class Figures:
    """Adds up reports; for one thread."""

    def __init__(self) -> None:
        self.frames = self.read = self.dropped = 0
        self._last: deque[_Seen] = deque(maxlen=_MOST)

    def add(self, report: LiveReport) -> None:
        """Take a frame into account."""
        frame, is_read = report.frame, report.detection.ok
        self.frames += 1
        self.read += is_read
        self.dropped += report.dropped
        late_ms = 1000 * (report.posed_s - frame.taken_s)
        work_ms = 1000 * (report.posed_s - frame.decoded_s)
        self._last.append(_Seen(report.posed_s, is_read, late_ms, work_ms))

    def to_dict(self, now_s: float) -> dict[str, Any]:
        """As of now, of `time.monotonic`; JSON-serialisable.

        Rates are of the last ten seconds, or of as many as there were.
        """
        recent = [seen for seen in self._last if now_s - seen.posed_s <= KEPT_S]
        span_s = min(KEPT_S, now_s - self._last[0].posed_s) if self._last else 0.0
        return {
            "frames": self.frames,
            "read": self.read,
            "dropped": self.dropped,
            "recent_frames": len(recent),
            "recent_read": sum(seen.is_read for seen in recent),
            "frames_per_s": round((len(recent) - 1) / span_s, 1)
            if len(recent) > 1 and span_s > 0
            else None,
            "latency_ms": _spread([seen.late_ms for seen in recent]),
            "pose_ms": _spread([seen.work_ms for seen in recent]),
        }


def _spread(values: list[float]) -> dict[str, float] | None:
    """Median and 95th percentile."""
    if not values:
        return None
    ordered = sorted(values)
    high = ordered[min(len(ordered) - 1, round(0.95 * (len(ordered) - 1)))]
    return {"median": round(statistics.median(ordered), 1), "p95": round(high, 1)}
