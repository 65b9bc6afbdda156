"""Decodes the packets of a video stream that come one by one, as recordings of robots hold them.

References
----------
Annex B of ITU-T H.264 and H.265; https://docs.foxglove.dev/docs/sdk/schemas/compressed-video: each
packet makes up one frame, none waits for later ones, and keyframes bring their parameters along.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, Literal

from padstudio.errors import LimitError
from padstudio.media.video import VideoError

if TYPE_CHECKING:
    from av import VideoCodecContext, VideoFrame

Codec = Literal["h264", "hevc"]

_CODECS: dict[str, Codec] = {"h264": "h264", "h265": "hevc", "hevc": "hevc"}
# A unit's first byte, behind its start code.
_UNIT = re.compile(rb"\x00\x00\x01(.)", re.DOTALL)
_H264_IDR, _H265_FIRST_IRAP, _H265_LAST_IRAP = 5, 16, 23


def codec_of(name: str) -> Codec:
    """FFmpeg's name of a codec.

    Raises
    ------
    VideoError
        If it is none that is read.
    """
    codec = _CODECS.get(name.strip().lower())
    if codec is None:
        raise VideoError(
            f"video packets of the format {name!r} are not read; there are {', '.join(_CODECS)}",
            code="unknown_encoding",
        )
    return codec


def is_keyframe(packet: bytes, codec: Codec) -> bool:
    """True where decoding can start with a packet."""
    for unit in _UNIT.finditer(packet):
        first = unit[1][0]
        if codec == "h264" and first & 0x1F == _H264_IDR:
            return True
        if codec == "hevc" and _H265_FIRST_IRAP <= first >> 1 & 0x3F <= _H265_LAST_IRAP:
            return True
    return False


def decode_packets(
    packets: Iterable[tuple[int, bytes]], codec: Codec, max_pixels: int
) -> Iterator[tuple[int, VideoFrame]]:
    """Decode packets from a keyframe on.

    Parameters
    ----------
    packets : iterable of (int, bytes)
        Rising timestamps, and packets.
    codec : {"h264", "hevc"}
    max_pixels : int

    Yields
    ------
    tuple of int and VideoFrame
        A packet's timestamp and its frame; packets that give none are passed over.

    Raises
    ------
    LimitError
        If a frame has too many pixels.
    """
    import av

    context = av.CodecContext.create(codec, "r")
    assert isinstance(context, av.VideoCodecContext)
    context.thread_count, context.thread_type = 1, "NONE"
    context.options = {"max_pixels": str(max_pixels)}

    def frames_of(packet: Any) -> Iterator[tuple[int, VideoFrame]]:
        try:
            found = context.decode(packet)
        except av.error.FFmpegError:
            _check_size(context, max_pixels)
            return
        for frame in found:
            if frame.pts is not None:
                yield frame.pts, frame

    for pts, data in packets:
        packet = av.Packet(data)
        packet.pts = packet.dts = pts
        yield from frames_of(packet)
    yield from frames_of(None)


def _check_size(context: VideoCodecContext, max_pixels: int) -> None:
    if context.width * context.height > max_pixels:
        raise LimitError(
            f"the video's frames are {context.width} x {context.height}, more than "
            f"{max_pixels / 1e6:g} megapixels; scale it down, or raise the limit in the settings",
            code="too_many_pixels",
        )
