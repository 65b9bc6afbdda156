"""How much is recorded, and how a recording is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Phase = Literal["waiting", "recording", "refused", "stopped", "closed"]


@dataclass(frozen=True, kw_only=True)
class RecordingOptions:
    """How much is recorded.

    Attributes
    ----------
    segment_s, segment_bytes : float, int
        A segment that is as long or as large ends before the next frame at which decoding can
        start.
    most_bytes : int or None
        A recording that is as large stops; None: no limit.
    least_free_bytes : int
        It stops where the disk has less room.
    held_bytes : int
        What may wait for a slow disk; packets beyond are dropped.
    """

    segment_s: float = 60.0
    segment_bytes: int = 500_000_000
    most_bytes: int | None = None
    least_free_bytes: int = 500_000_000
    held_bytes: int = 64_000_000


@dataclass(frozen=True)
class RecordingState:
    """How a recording is.

    Attributes
    ----------
    phase : {"waiting", "recording", "refused", "stopped", "closed"}
        ``waiting`` for a stream, or for its next keyframe; ``refused``: this stream is not
        recorded, the next one may be; ``stopped``: nothing is recorded any more.
    detail : str
        A sentence on why, and what to do; empty while all is well.
    code : str
        Of the error; empty while all is well.
    segments, frames, bytes : int
        What is there.
    packets_dropped, reports_dropped : int
        What the disk was too slow for.
    """

    phase: Phase = "waiting"
    detail: str = ""
    code: str = ""
    segments: int = 0
    frames: int = 0
    bytes: int = 0
    packets_dropped: int = 0
    reports_dropped: int = 0
