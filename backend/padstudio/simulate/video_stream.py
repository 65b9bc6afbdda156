"""What a live video stream of a given bit rate leaves of a picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from padstudio.arrays import Image
from padstudio.errors import SpecError, shown
from padstudio.simulate.video_writer import Codec

if TYPE_CHECKING:
    from av import Packet

# Encoders as live links use them: each frame at once, from those before it alone.
_ENCODERS = {
    "h264": ("libx264", {"preset": "medium", "tune": "zerolatency", "threads": "1"}),
    "h265": (
        "libx265",
        {
            "preset": "fast",
            "tune": "zerolatency",
            "x265-params": "log-level=error:pools=none:frame-threads=1",
        },
    ),
}
_DECODERS = {"h264": "h264", "h265": "hevc"}
# A key frame a second at 30 frames a second.
_KEYFRAME_EVERY = 30
# Rate factors that are tried: beyond the first nothing is to be seen, the last is the coarsest.
_FINEST, _COARSEST = 8, 51


@dataclass(frozen=True, eq=False)
class Streamed:
    """A picture that came through a stream.

    Attributes
    ----------
    image : (H, W, 3) uint8
        BGR.
    rate_factor : int
        Of the encoder.
    mbit_s : float
        What the stream takes: one key frame and 29 like the last frame, over and over.
    """

    image: Image
    rate_factor: int
    mbit_s: float


@dataclass(frozen=True, eq=False)
class Clip:
    """The frames that lead to a picture, and it, as a stream takes them.

    A stream's encoder settles at the quality that its bit rate allows in the long run. So the rate
    factor is searched with which a group of pictures like this one takes the bit rate.

    Attributes
    ----------
    pictures : sequence of (H, W, 3) uint8
        BGR, of one size; at least two. The first is the key frame.
    codec : {"h264", "h265"}
    fps : float

    Raises
    ------
    SpecError
        If the codec is not known, or there are too few pictures.
    """

    pictures: Sequence[Image]
    codec: Codec
    fps: float
    _coded: dict[int, Streamed] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        if self.codec not in _ENCODERS:
            raise SpecError(f"no codec {shown(self.codec)}; use {' or '.join(_ENCODERS)}")
        if len(self.pictures) < 2:
            raise SpecError("a stream's picture needs at least one before it")

    def at(self, mbit_s: float) -> Streamed:
        """The last picture at a bit rate; the coarsest there is where even that takes more."""
        fine, coarse = _FINEST, _COARSEST
        while fine < coarse:
            middle = (fine + coarse) // 2
            if self._with(middle).mbit_s <= mbit_s:
                coarse = middle
            else:
                fine = middle + 1
        return self._with(fine)

    def _with(self, rate_factor: int) -> Streamed:
        if rate_factor not in self._coded:
            packets = _encoded(self.pictures, self.codec, self.fps, rate_factor)
            height, width = self.pictures[0].shape[:2]
            image = _last_decoded(packets, self.codec)[:height, :width]
            key, last = packets[0].size, packets[-1].size
            group = key + (_KEYFRAME_EVERY - 1) * last
            mbit_s = 8e-6 * group * self.fps / _KEYFRAME_EVERY
            self._coded[rate_factor] = Streamed(np.ascontiguousarray(image), rate_factor, mbit_s)
        return self._coded[rate_factor]


def _encoded(pictures: Sequence[Image], codec: Codec, fps: float, factor: int) -> list[Packet[Any]]:
    from av import VideoCodecContext, VideoFrame

    name, options = _ENCODERS[codec]
    encoder = VideoCodecContext.create(name, "w")
    assert isinstance(encoder, VideoCodecContext)
    height, width = pictures[0].shape[:2]
    # 4:2:0 colour has even sizes.
    down, right = height % 2, width % 2
    encoder.width, encoder.height, encoder.pix_fmt = width + right, height + down, "yuv420p"
    encoder.framerate = Fraction(fps).limit_denominator(1001)
    encoder.time_base = 1 / encoder.framerate
    encoder.gop_size = _KEYFRAME_EVERY
    encoder.options = {**options, "crf": str(factor)}
    packets = []
    for number, picture in enumerate(pictures):
        even = np.pad(picture, ((0, down), (0, right), (0, 0)), mode="edge")
        frame = VideoFrame.from_ndarray(even, format="bgr24")
        frame.pts = number
        packets += encoder.encode(frame)
    return packets + encoder.encode(None)


def _last_decoded(packets: Sequence[Packet[Any]], codec: Codec) -> Image:
    from av import VideoCodecContext

    decoder = VideoCodecContext.create(_DECODERS[codec], "r")
    assert isinstance(decoder, VideoCodecContext)
    frames = [frame for packet in [*packets, None] for frame in decoder.decode(packet)]
    return np.asarray(frames[-1].to_ndarray(format="bgr24"), np.uint8)
