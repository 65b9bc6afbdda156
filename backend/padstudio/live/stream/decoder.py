"""Makes frames of packets, each with its times and whether it is whole."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from padstudio.live.reports.frame import LiveFrame
from padstudio.live.stream.backlog import Arrival
from padstudio.live.stream.connection import check_size
from padstudio.live.stream.continuity import Continuity
from padstudio.media.video_frames import to_frame

if TYPE_CHECKING:
    from av import Packet, VideoFrame
    from av.video.stream import VideoStream

# A sender's clock that puts a frame outside of this range before its arrival is not in step with
# this computer's, and says nothing, s.
_IN_STEP_S = (-0.005, 2.0)
# Frames that a decoder may hold back; times of older packets are forgotten.
_MOST_HELD = 64
# Of an AVProducerReferenceTime: its first field, µs of Unix time.
_WALL_CLOCK_BYTES = 8


@dataclass(frozen=True, eq=False)
class DecodedFrame:
    """A frame in the decoder's memory; `LiveFrame` says what its fields are."""

    number: int
    frame: VideoFrame
    pts_s: float
    arrived_s: float
    decoded_s: float
    captured_s: float | None
    connection: int
    is_damaged: bool

    def to_live(self, max_pixels: int) -> LiveFrame:
        """The frame for who reads it, in planes where they are of a known kind."""
        return LiveFrame(
            self.number,
            to_frame(self.frame, 0, max_pixels),
            self.pts_s,
            self.arrived_s,
            self.decoded_s,
            self.captured_s,
            self.connection,
            self.is_damaged,
        )


@dataclass(frozen=True)
class _Note:
    arrived_s: float
    captured_s: float | None
    is_broken: bool


class StreamDecoder:
    """Decodes the packets of one connection after the other.

    Parameters
    ----------
    max_pixels : int
        Of a frame.
    """

    def __init__(self, max_pixels: int) -> None:
        self._max_pixels = max_pixels
        self._connection = self._number = 0
        self._begin(0)

    def _begin(self, connection: int) -> None:
        self._connection = connection
        self._continuity: Continuity | None = None
        self._is_broken = self._is_filled = False
        self._last_pts_s: float | None = None
        self._notes: dict[int, _Note] = {}

    def decode(self, arrival: Arrival, *, has_gap: bool, is_pressed: bool) -> list[DecodedFrame]:
        """The frames that a packet completes: none, one, or several at a stream's end.

        Parameters
        ----------
        arrival : Arrival
        has_gap : bool
            Packets before it were passed over; it is a keyframe then.
        is_pressed : bool
            Time is short: frames on which no other rests are passed over.

        Raises
        ------
        LimitError
            If a frame has too many pixels.
        """
        import av

        if arrival.number != self._connection:
            self._begin(arrival.number)
        codec = arrival.connection.codec
        if has_gap:
            self._continuity, self._is_broken = None, False
            if codec.is_open:
                codec.flush_buffers()
        codec.skip_frame = "NONREF" if is_pressed else "DEFAULT"
        packet = arrival.packet
        note = self._noted(arrival)
        if packet.pts is not None:
            self._notes[packet.pts] = note
        try:
            frames = codec.decode(packet)
        except av.error.FFmpegError:
            check_size(codec.width, codec.height, self._max_pixels)
            self._is_broken = True
            return []
        decoded = [self._told(frame, arrival, note) for frame in frames]
        while len(self._notes) > _MOST_HELD:
            del self._notes[next(iter(self._notes))]
        return [frame for frame in decoded if frame is not None]

    def _noted(self, arrival: Arrival) -> _Note:
        """What is known of a packet's frame before it is decoded."""
        packet = arrival.packet
        if self._continuity is None:
            codec = arrival.connection.codec
            self._continuity = Continuity(codec.name, bytes(codec.extradata or b""))
        # What is missing harms the frames that follow in the order of decoding.
        is_broken = packet.is_corrupt or self._continuity.breaks(bytes(packet))
        self._is_broken = is_broken or (self._is_broken and not packet.is_keyframe)
        captured_s = _captured_s(packet, arrival.arrived_s)
        return _Note(arrival.arrived_s, captured_s, self._is_broken)

    def _told(self, frame: VideoFrame, arrival: Arrival, note: _Note) -> DecodedFrame | None:
        check_size(frame.width, frame.height, self._max_pixels)
        self._is_filled = bool(frame.is_corrupt or (self._is_filled and not frame.key_frame))
        if frame.pts is not None:
            note = self._notes.pop(frame.pts, note)
        pts_s = note.arrived_s
        if arrival.connection.is_timed:
            if frame.pts is None or frame.time_base is None:
                return None
            pts_s = float(frame.pts * frame.time_base)
        # What is no later than the frame before cannot be placed.
        if self._last_pts_s is not None and pts_s <= self._last_pts_s:
            return None
        self._last_pts_s = pts_s
        number, self._number = self._number, self._number + 1
        return DecodedFrame(
            number,
            frame,
            pts_s,
            note.arrived_s,
            time.monotonic(),
            note.captured_s,
            arrival.number,
            note.is_broken or self._is_filled,
        )


def _captured_s(packet: Packet[VideoStream], arrived_s: float) -> float | None:
    """When a frame was taken, by its sender's reports (RFC 3550, 6.4.1)."""
    if not packet.has_sidedata("prft"):
        return None
    data = bytes(packet.get_sidedata("prft"))[:_WALL_CLOCK_BYTES]
    wall_s = int.from_bytes(data, "little", signed=True) / 1e6
    captured_s = wall_s - (time.time() - time.monotonic())
    least, most = _IN_STEP_S
    return captured_s if least <= arrived_s - captured_s <= most else None
