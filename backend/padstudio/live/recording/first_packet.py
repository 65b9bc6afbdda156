"""Gives a connection's first packet a time, where its stream does not have one for it yet.

Readers of RTP know the times of packets from the second one on, and the first is the keyframe that
all up to the next keyframe rest on.
"""

from __future__ import annotations

from dataclasses import replace

from padstudio.live.recording.segment import StreamPacket


class FirstPacket:
    """Holds packets back until the first one's time follows from those of the next two."""

    def __init__(self) -> None:
        self._held: list[StreamPacket] = []
        self._is_over = False

    def passed(self, packet: StreamPacket) -> list[StreamPacket]:
        """The packets that can be written now, as another one has come; all of them have times."""
        is_timed = _time_of(packet) is not None
        if self._is_over:
            return [packet] if is_timed else []
        if not is_timed:
            self._held = [packet]
            return []
        self._held.append(packet)
        if len(self._held) == 2:
            return []
        self._is_over = True
        if len(self._held) == 1:
            return self._held
        first, *timed = self._held
        second, third = (_time_of(each) or 0 for each in timed)
        time = second - max(1, third - second)
        return [replace(first, pts=time, dts=time), *timed]


def _time_of(packet: StreamPacket) -> int | None:
    return packet.pts if packet.dts is None else packet.dts
