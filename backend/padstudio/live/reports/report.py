"""What a frame of a stream came to, and who is told."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np

from padstudio.live.reports.frame import LiveFrame
from padstudio.vision.stage.detection import Detection

#: Whether the pad is in view: it is; it is not; nothing can be said, for no frames come.
Sight = Literal["found", "lost", "no_stream"]


@dataclass(frozen=True, eq=False)
class LiveReport:
    """A frame that was read.

    Attributes
    ----------
    frame : LiveFrame
    detection : Detection
        Its pose as fused with the frames before it, or why there is none.
    posed_s : float
        When that was known, of `time.monotonic`.
    dropped : int
        Frames that were dropped since the one read before.
    """

    frame: LiveFrame
    detection: Detection
    posed_s: float
    dropped: int = 0


def without_picture(report: LiveReport) -> LiveReport:
    """The report for who keeps it: a frame's picture takes megabytes."""
    return replace(report, frame=replace(report.frame, picture=_NO_PICTURE))


_NO_PICTURE = np.zeros((0, 0, 3), np.uint8)


class Output(Protocol):
    """Takes what frames come to; called in the thread that reads frames, so it must not wait."""

    def take(self, report: LiveReport) -> None:
        """A frame was read."""

    def sight_changed(self, sight: Sight, detail: str) -> None:
        """The pad or the stream was lost or found; the sentence says why."""

    def close(self) -> None:
        """No more will come."""
