"""A report as the JSON object of a line, a datagram or an event."""

from __future__ import annotations

import json
import time
from typing import Any

import numpy as np

from padstudio.live.reports.report import LiveReport, Sight

#: Left out of datagrams, so that one fits into any network's packet; all follow from others or are
#: of interest to people alone.
LEFT_OUT_OF_DATAGRAMS = (
    "rotation",
    "euler_deg",
    "single",
    "covariance",
    "elapsed_ms",
    "findings",
    "advice",
    "failed_at",
    "flatness_mm",
    "ambiguity",
)
#: A datagram is shorter than this, bytes: what Ethernet carries whole, with room for tunnels.
LONGEST_DATAGRAM = 1400
# Longest text in a datagram, bytes.
_LONGEST_TEXT = 200


class Records:
    """Makes records of a session's reports; for one thread.

    Parameters
    ----------
    source : str
        How the stream is called; without a password.
    """

    def __init__(self, source: str) -> None:
        self.source = source
        self._connection: int | None = None
        self._zero_s = self._begun_s = 0.0
        self._first_s: float | None = None

    def of(self, report: LiveReport) -> dict[str, Any]:
        """A line of a poses file (docs/conventions.md), with ``live`` and ``covariance``.

        ``time_s`` counts from the session's first frame on the stream's own clock; where the stream
        was connected anew, on from when its first frame came.
        """
        frame, detection = report.frame, report.detection
        record = detection.to_record(
            self.source, frame=frame.number, time_s=round(self._time_s(report), 6)
        )
        if frame.is_damaged:
            record["damaged"] = True
        if detection.uncertainty is not None:
            upper = np.triu_indices(6)
            record["covariance"] = detection.uncertainty.covariance[upper].tolist()
        unix_s = time.time() - time.monotonic()
        record["live"] = {
            "number": frame.number,
            "connection": frame.connection,
            "taken_s": round(unix_s + frame.taken_s, 6),
            "taken": "arrived" if frame.captured_s is None else "captured",
            "decoded_s": round(unix_s + frame.decoded_s, 6),
            "posed_s": round(unix_s + report.posed_s, 6),
            "latency_ms": round(1000 * (report.posed_s - frame.taken_s), 3),
            "dropped": report.dropped,
        }
        return record

    def _time_s(self, report: LiveReport) -> float:
        frame = report.frame
        if self._first_s is None:
            self._first_s = frame.arrived_s
        if frame.connection != self._connection:
            self._connection = frame.connection
            self._zero_s, self._begun_s = frame.pts_s, frame.arrived_s - self._first_s
        return self._begun_s + frame.pts_s - self._zero_s


def event_record(event: str, detail: str, code: str = "") -> dict[str, Any]:
    """What happened, now."""
    record: dict[str, Any] = {"event": event, "time_unix_s": round(time.time(), 6)}
    if detail:
        record["detail"] = detail
    if code:
        record["code"] = code
    return record


def sight_record(sight: Sight, detail: str) -> dict[str, Any]:
    """The pad or the stream was lost or found."""
    return event_record(sight, detail)


def line_of(record: dict[str, Any]) -> bytes:
    """A record as one line."""
    return (json.dumps(record, ensure_ascii=False) + "\n").encode()


def datagram_of(record: dict[str, Any]) -> bytes:
    """A record as one datagram, shorter than `LONGEST_DATAGRAM`."""
    kept = {
        name: _shortened(value) if isinstance(value, str) else value
        for name, value in record.items()
        if name not in LEFT_OUT_OF_DATAGRAMS
    }
    return json.dumps(kept, ensure_ascii=False, separators=(",", ":")).encode()


def _shortened(text: str) -> str:
    return text.encode()[:_LONGEST_TEXT].decode(errors="ignore")
