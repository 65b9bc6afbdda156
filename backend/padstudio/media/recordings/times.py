"""How frames of a recording are found again by their times."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Clock = Literal["header", "recorder"]


@dataclass(frozen=True)
class TopicTimes:
    """How a topic's frames are found again by their times.

    Attributes
    ----------
    topic : str
    clock : {"header", "recorder"}
        Whose time a frame has: that of its message's header, or when the recorder took it.
    least_ns, most_ns : int
        By which the recorder's time is later than a frame's.
    is_stream : bool
        Frames are packets of a video stream, each resting on those before it.
    """

    topic: str
    clock: Clock
    least_ns: int
    most_ns: int
    is_stream: bool = False
