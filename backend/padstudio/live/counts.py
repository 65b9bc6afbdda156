"""What a live session has come to so far."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any


@dataclass
class SessionCounts:
    """Written by the session's thread alone; whole numbers, so that others may read them any time.

    Attributes
    ----------
    frames : int
        Looked at.
    poses : int
        Of these, with a pose.
    full : int
        Of these, of quality ``full``.
    dropped : int
        Frames that were decoded and not looked at, for a newer one was there.
    refused : int
        Frames of another shape than the camera's.
    defects : int
        Frames that brought a defect of the program to light.
    reasons : Counter of str
        Why frames have no pose.
    output_errors : Counter of str
        Errors of outputs, by their names.
    """

    frames: int = 0
    poses: int = 0
    full: int = 0
    dropped: int = 0
    refused: int = 0
    defects: int = 0
    reasons: Counter[str] = field(default_factory=Counter)
    output_errors: Counter[str] = field(default_factory=Counter)

    def to_dict(self) -> dict[str, Any]:
        """JSON-serialisable."""
        return {
            "frames": self.frames,
            "poses": self.poses,
            "full": self.full,
            "dropped": self.dropped,
            "refused": self.refused,
            "defects": self.defects,
            "reasons": dict(self.reasons.copy()),
            "output_errors": dict(self.output_errors.copy()),
        }
