"""Whether packets of a coded stream are missing, by what they say of themselves.

Decoders fill in for a frame that is missing as a whole, and say nothing.

References
----------
ITU-T H.264 (08/2021): 7.3.2.1.1 (sequence parameters), 7.3.3 (slice header), 7.4.3 (frame_num and
its gaps); ITU-T H.265 (08/2021): 7.3.6.1 (slice segment header).
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass

_START_CODE = b"\x00\x00\x01"
_H264_SLICE, _H264_IDR, _H264_SPS = 1, 5, 7
_HEVC_LAST_SLICE = 31
# Bytes of a unit that hold what is read here.
_HEAD_BYTES = 64
# Profiles whose parameters tell of colour formats, 7.3.2.1.1.
_HIGH = (100, 110, 122, 244, 44, 83, 86, 118, 128, 138, 139, 134, 135)


@dataclass
class _Bits:
    """Reads a unit's bits behind its header."""

    data: bytes
    place: int = 0

    def read(self, count: int) -> int:
        """An unsigned number of so many bits; raises IndexError at the end."""
        value = 0
        for _ in range(count):
            byte = self.data[self.place >> 3]
            value = value << 1 | (byte >> (7 - (self.place & 7)) & 1)
            self.place += 1
        return value

    def golomb(self) -> int:
        """An Exp-Golomb number (H.264, 9.1)."""
        zeros = 0
        while not self.read(1):
            zeros += 1
        return (1 << zeros) - 1 + self.read(zeros)


@dataclass(frozen=True)
class _Slice:
    """Of a slice: where in its frame it begins, its frame_num, whether others rest on it."""

    place: int
    number: int
    is_reference: bool
    is_idr: bool


def units(data: bytes) -> Iterator[bytes]:
    """The first bytes of each unit of a packet (Annex B), those against emulation taken out."""
    place = data.find(_START_CODE)
    while place >= 0:
        start = place + len(_START_CODE)
        yield data[start : start + _HEAD_BYTES].replace(b"\x00\x00\x03", b"\x00\x00")
        place = data.find(_START_CODE, start)


class Continuity:
    """Follows the packets of one connection.

    Parameters
    ----------
    codec : str
        FFmpeg's name; of others than ``h264`` and ``hevc`` nothing is known.
    extradata : bytes
        The stream's parameters, in the form of its packets.
    """

    def __init__(self, codec: str, extradata: bytes) -> None:
        self._codec = codec
        # Within files, lengths stand in place of start codes, and nothing gets lost.
        self._is_known = codec in ("h264", "hevc") and extradata[:1] != b"\x01"
        self._bits: int | None = None
        self._has_planes = False
        self._last: int | None = None
        if codec == "h264" and self._is_known:
            with contextlib.suppress(IndexError):
                for unit in units(extradata):
                    self._read_parameters(unit)

    def breaks(self, data: bytes) -> bool:
        """Whether something is missing before or within a packet; False where that is not known."""
        if not self._is_known:
            return False
        try:
            return self._breaks_h264(data) if self._codec == "h264" else _begins_late(data)
        except IndexError:
            return True

    def _breaks_h264(self, data: bytes) -> bool:
        found: list[_Slice] = []
        for unit in units(data):
            kind = unit[0] & 0x1F
            if kind == _H264_SPS:
                self._read_parameters(unit)
            elif kind in (_H264_SLICE, _H264_IDR) and self._bits is not None:
                found.append(self._slice(unit))
        if not found:
            return False
        first = found[0]
        is_whole = not first.place and all(each.number == first.number for each in found)
        is_next = first.is_idr or self._last is None or first.number in (self._last, self._next())
        if first.is_reference:
            self._last = first.number
        return not (is_whole and is_next)

    def _next(self) -> int | None:
        if self._last is None or self._bits is None:
            return None
        return (self._last + 1) % (1 << self._bits)

    def _slice(self, unit: bytes) -> _Slice:
        bits = _Bits(unit[1:])
        place = bits.golomb()
        bits.golomb()
        bits.golomb()
        if self._has_planes:
            bits.read(2)
        number = bits.read(self._bits or 0)
        return _Slice(place, number, bool(unit[0] & 0x60), unit[0] & 0x1F == _H264_IDR)

    def _read_parameters(self, unit: bytes) -> None:
        if unit[0] & 0x1F != _H264_SPS:
            return
        bits = _Bits(unit[4:])
        bits.golomb()
        if unit[1] in _HIGH:
            self._has_planes = bits.golomb() == 3 and bool(bits.read(1))
            bits.golomb()
            bits.golomb()
            bits.read(1)
            if bits.read(1):
                # Scaling lists are as long as they like; cameras have none.
                self._bits = None
                return
        self._bits = bits.golomb() + 4


def _begins_late(data: bytes) -> bool:
    """Whether an H.265 frame lacks its first slice."""
    for unit in units(data):
        if unit[0] >> 1 & 0x3F <= _HEVC_LAST_SLICE:
            return not unit[2] & 0x80
    return False
