"""What the packets of a connection are, and where a recording of them can begin."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from padstudio.errors import StudioError

if TYPE_CHECKING:
    from av.video.stream import VideoStream

#: FFmpeg's names of what is recorded as it comes.
CODECS = {"h264": "H.264", "hevc": "H.265", "mjpeg": "MJPEG"}
#: Unit of times that are not the stream's own, s.
MICROSECONDS = Fraction(1, 1_000_000)
# FFmpeg's names of forms whose reader makes times up.
_UNTIMED = ("mpjpeg", "mjpeg")
_START_CODE = re.compile(rb"\x00\x00\x01")
_H264_SLICE, _H264_IDR = 1, 5
_HEVC_IDR = (19, 20)
_HEVC_LAST_SLICE = 31
# ISO/IEC 14496-15: units follow a length of so many bytes where the header is of that form.
_LENGTH_BYTES = 4


class UnrecordableError(StudioError):
    """A stream that is not recorded."""

    code = "unrecordable_codec"
    status = 422


@dataclass(frozen=True, eq=False)
class StreamForm:
    """What packets are.

    Attributes
    ----------
    codec : str
        One of `CODECS`.
    size_px : (width, height)
    time_base : Fraction
        Unit of their timestamps, s.
    template : av.video.stream.VideoStream
        Says how they are written.
    is_framed : bool
        Their units follow their lengths, not start codes.
    is_timed : bool
        They have times of their own; pictures by HTTP have none, and are timed as they arrive.
    """

    codec: str
    size_px: tuple[int, int]
    time_base: Fraction
    template: Any
    is_framed: bool = False
    is_timed: bool = True

    def is_clean_start(self, data: bytes) -> bool:
        """True where no frame from this packet on needs one before it (an IDR picture)."""
        if self.codec == "mjpeg":
            return True
        for first in self._unit_starts(data):
            kind = first & 0x1F if self.codec == "h264" else first >> 1 & 0x3F
            if self.codec == "h264" and _H264_SLICE <= kind <= _H264_IDR:
                return kind == _H264_IDR
            if self.codec == "hevc" and kind <= _HEVC_LAST_SLICE:
                return kind in _HEVC_IDR
        return False

    def _unit_starts(self, data: bytes) -> Iterator[int]:
        """The first byte of each unit (Annex B of ITU-T H.264 and H.265)."""
        if self.is_framed:
            place = 0
            while place + _LENGTH_BYTES < len(data):
                yield data[place + _LENGTH_BYTES]
                length = int.from_bytes(data[place : place + _LENGTH_BYTES], "big")
                place += _LENGTH_BYTES + length
            return
        for found in _START_CODE.finditer(data):
            if found.end() < len(data):
                yield data[found.end()]


def form_of(stream: VideoStream) -> StreamForm:
    """What a stream's packets are; the stream may be closed afterwards.

    Raises
    ------
    UnrecordableError
        If they are of another codec than `CODECS`, or their size is not known.
    """
    context = stream.codec_context
    codec = context.name
    if codec == "rawvideo":
        raise UnrecordableError(
            "raw pictures are not recorded, as they would fill the disk; open the device with "
            "input_format=mjpeg or h264"
        )
    if codec not in CODECS:
        raise UnrecordableError(
            f"a stream of the codec {codec} is not recorded; set the camera to "
            f"{', '.join(CODECS.values())}"
        )
    size = (context.width, context.height)
    if not all(size):
        raise UnrecordableError("the stream does not say its size yet", code="unknown_size")
    header = context.extradata or b""
    is_timed = stream.container.format.name not in _UNTIMED
    return StreamForm(
        codec,
        size,
        (stream.time_base if is_timed else None) or MICROSECONDS,
        _holder().add_stream_from_template(stream),
        is_framed=codec != "mjpeg" and header[:1] == b"\x01",
        is_timed=is_timed,
    )


def jpeg_form(size_px: tuple[int, int]) -> StreamForm:
    """What JPEG files of one size are, each a frame."""
    template = _holder().add_stream("mjpeg", rate=30)
    return StreamForm("mjpeg", size_px, MICROSECONDS, template)


def _holder() -> Any:
    """A container that is never written and holds copies of what streams say."""
    import av

    return av.open(io.BytesIO(), "w", format="mp4")
