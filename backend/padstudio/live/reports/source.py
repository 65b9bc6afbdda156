"""What frames come from, and who else wants its packets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

from padstudio.live.reports.frame import LiveFrame

if TYPE_CHECKING:
    from av import Packet
    from av.video.stream import VideoStream

Phase = Literal["connecting", "open", "lost", "ended", "refused"]


@dataclass(frozen=True)
class StreamState:
    """How a source is.

    Attributes
    ----------
    phase : {"connecting", "open", "lost", "ended", "refused"}
        ``lost`` is tried again; ``ended`` (a file's end) and ``refused`` are not.
    detail : str
        A sentence on why, and what to do; empty while all is well.
    code : str
        Of the error; empty while all is well.
    frames : int
        Decoded since the session began.
    dropped : int
        Of these, those that nobody took before the next one came.
    damaged : int
        Of these, those for which the decoder filled in.
    skipped : int
        Packets that were never decoded, as decoding could not keep pace.
    connections : int
        How often it was opened.
    size_px : (width, height) or None
    codec : str or None
        FFmpeg's name of it.
    """

    phase: Phase = "connecting"
    detail: str = ""
    code: str = ""
    frames: int = 0
    dropped: int = 0
    damaged: int = 0
    skipped: int = 0
    connections: int = 0
    size_px: tuple[int, int] | None = None
    codec: str | None = None


class FrameSource(Protocol):
    """Gives the newest frame at any time."""

    @property
    def state(self) -> StreamState:
        """As of now; from any thread."""

    def newest(self, timeout_s: float) -> LiveFrame | None:
        """Take the newest frame, waiting for one that was not taken yet; None where none came."""

    def close(self) -> None:
        """Let go of the stream; waits until its thread has ended."""


class PacketTap(Protocol):
    """Takes a stream's packets as they come, in the thread that receives them."""

    def opened(self, stream: VideoStream, connection: int) -> None:
        """A connection stands, or its stream has changed its size or codec."""

    def packet(self, packet: Packet[VideoStream], arrived_s: float) -> None:
        """A packet came; times are of `time.monotonic`. It is not to be changed."""

    def closed(self) -> None:
        """The connection ended."""
