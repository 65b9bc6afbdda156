"""A frame of a stream, and when it was taken and decoded."""

from __future__ import annotations

from dataclasses import dataclass

from padstudio.arrays import Image, YuvFrame


@dataclass(frozen=True, eq=False)
class LiveFrame:
    """One decoded frame.

    All times but ``pts_s`` are of `time.monotonic`.

    Attributes
    ----------
    number : int
        Counts the frames that were decoded since the session began, those that are dropped later
        included; never starts anew.
    picture : (H, W, 3) uint8, BGR, or YuvFrame
    pts_s : float
        On the stream's own clock, s; rises within a connection. Differences of it say how far
        apart frames were taken.
    arrived_s : float
        When the frame's last packet was there.
    decoded_s : float
        When it was decoded.
    captured_s : float or None
        When it was taken, as the stream says (RTCP sender reports); None where it does not.
    connection : int
        Counts connections; times of different ones are not on one clock.
    is_damaged : bool
        The decoder filled in for missing data, here or in a frame that this one rests on.
    """

    number: int
    picture: Image | YuvFrame
    pts_s: float
    arrived_s: float
    decoded_s: float
    captured_s: float | None = None
    connection: int = 0
    is_damaged: bool = False

    @property
    def taken_s(self) -> float:
        """When it was taken as far as that is known: when it arrived where nothing says more."""
        return self.arrived_s if self.captured_s is None else self.captured_s
