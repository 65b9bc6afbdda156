"""Keeps a stream's last packets, so that any recent frame can be decoded again."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from padstudio.arrays import Image, YuvFrame
from padstudio.errors import NotFoundError
from padstudio.media.video import MAX_PIXELS
from padstudio.media.video_frames import to_frame

if TYPE_CHECKING:
    from av import Packet, VideoFrame
    from av.video.stream import VideoStream

#: Seconds and bytes that are kept: ten seconds to look back at, and what the first rests on.
KEEP_S, MAX_BYTES = 12.0, 32 << 20
# Times are told in seconds; units of streams are far longer.
_SAME_S = 1e-6


@dataclass(frozen=True)
class ShelvedFrame:
    """A frame that can be had again.

    Attributes
    ----------
    connection : int
    pts_s : float
        Both as of its `padstudio.live.reports.frame.LiveFrame`.
    arrived_s : float
        Of `time.monotonic`.
    """

    connection: int
    pts_s: float
    arrived_s: float


@dataclass(frozen=True)
class _Form:
    """What a connection's packets are."""

    codec: str
    extradata: bytes
    time_base: Fraction
    connection: int


@dataclass(eq=False)
class _Group:
    """A keyframe's packet and those that follow it."""

    form: _Form
    data: list[bytes] = field(default_factory=list)
    frames: list[ShelvedFrame] = field(default_factory=list)
    size: int = 0

    def index_of(self, connection: int, pts_s: float) -> int | None:
        """The place of the packet of a frame."""
        if self.form.connection != connection:
            return None
        for place, frame in enumerate(self.frames):
            # Where a stream tells no times, a frame's is that of its arrival.
            if min(abs(frame.pts_s - pts_s), abs(frame.arrived_s - pts_s)) < _SAME_S:
                return place
        return None


class PacketShelf:
    """A `padstudio.live.reports.source.PacketTap` that forgets what is older than it should keep.

    Parameters
    ----------
    keep_s : float
        At least so long a part of the stream, from a keyframe on, once it has run so long.
    max_bytes : int
        Never more than that; of a stream with fewer keyframes than fit in, nothing is kept until
        the next one.
    """

    def __init__(self, keep_s: float = KEEP_S, max_bytes: int = MAX_BYTES) -> None:
        self._keep_s, self._max_bytes = keep_s, max_bytes
        self._lock = threading.Lock()
        self._groups: deque[_Group] = deque()
        self._form: _Form | None = None
        self._needs_keyframe = True

    @property
    def size(self) -> int:
        """Bytes of packets that are kept."""
        with self._lock:
            return sum(group.size for group in self._groups)

    def opened(self, stream: VideoStream, connection: int) -> None:
        """A connection stands."""
        context = stream.codec_context
        unit = stream.time_base or Fraction(1, 1_000_000)
        self._form = _Form(context.name, bytes(context.extradata or b""), unit, connection)
        self._needs_keyframe = True

    def packet(self, packet: Packet[VideoStream], arrived_s: float) -> None:
        """A packet came."""
        form = self._form
        if form is None or (self._needs_keyframe and not packet.is_keyframe):
            return
        pts_s = arrived_s if packet.pts is None else float(packet.pts * form.time_base)
        data = bytes(packet)
        with self._lock:
            if packet.is_keyframe:
                self._groups.append(_Group(form))
                self._needs_keyframe = False
            group = self._groups[-1]
            group.data.append(data)
            group.frames.append(ShelvedFrame(form.connection, pts_s, arrived_s))
            group.size += len(data)
            self._forget(arrived_s)

    def closed(self) -> None:
        """The connection ended; what came is kept."""
        self._needs_keyframe = True

    def frames(self) -> list[ShelvedFrame]:
        """All frames that can be had, in the order in which they are shown."""
        with self._lock:
            frames = [frame for group in self._groups for frame in group.frames]
        return sorted(frames, key=lambda frame: (frame.connection, frame.pts_s))

    def picture(
        self, connection: int, pts_s: float, max_pixels: int = MAX_PIXELS
    ) -> Image | YuvFrame:
        """Decode a frame again, in the calling thread.

        Parameters
        ----------
        connection, pts_s
            Of its `LiveFrame`, or `ShelvedFrame`.
        max_pixels : int

        Returns
        -------
        (H, W, 3) uint8, BGR, or YuvFrame
            The same to the bit as in the stream, unless packets before it were lost or passed over.

        Raises
        ------
        NotFoundError
            Code ``frame_gone``: it is too old, or was never here.
        LimitError
            If it has too many pixels.
        """
        with self._lock:
            found = [(g, g.index_of(connection, pts_s)) for g in self._groups]
            held = next(((g, place) for g, place in found if place is not None), None)
            data = list(held[0].data) if held else []
        if held is not None:
            for place, frame in _decoded(held[0].form, data, max_pixels):
                if place == held[1]:
                    return to_frame(frame, 0, max_pixels)
        raise NotFoundError(
            f"the frame is gone: the last {self._keep_s:g} s of a stream are kept",
            code="frame_gone",
        )

    def _forget(self, now_s: float) -> None:
        size = sum(group.size for group in self._groups)
        while len(self._groups) > 1 and (
            size > self._max_bytes or now_s - self._groups[1].frames[0].arrived_s >= self._keep_s
        ):
            size -= self._groups.popleft().size
        if size > self._max_bytes:
            self._groups.clear()
            self._needs_keyframe = True


def _decoded(form: _Form, data: list[bytes], max_pixels: int) -> Iterator[tuple[int, VideoFrame]]:
    """Frames with the places of their packets."""
    import av

    context = av.CodecContext.create(form.codec, "r")
    assert isinstance(context, av.VideoCodecContext)
    context.thread_count, context.thread_type = 1, "NONE"
    context.options = {"max_pixels": str(max_pixels)}
    if form.extradata:
        context.extradata = form.extradata
    packets: list[Packet[Any] | None] = []
    for place, each in enumerate(data):
        packet: Packet[Any] = av.Packet(each)
        # A decoder hands a packet's timestamp on to its frame, whatever it is.
        packet.pts = packet.dts = place
        packets.append(packet)
    for next_packet in (*packets, None):
        try:
            frames = context.decode(next_packet)
        except av.error.FFmpegError:
            continue
        for frame in frames:
            if frame.pts is not None:
                yield frame.pts, frame
