"""Makes small videos of every kind; each frame's number can be read from its picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

WIDTH, HEIGHT = 192, 128
_BITS = 8


def picture(number: int, width: int = WIDTH, height: int = HEIGHT) -> NDArray[np.uint8]:
    """A frame: its number as eight black or white bars, and a red top-left corner."""
    bgr = np.full((height, width, 3), 128, np.uint8)
    step = width // _BITS
    for bit in range(_BITS):
        bgr[height // 4 :, bit * step : (bit + 1) * step] = 235 if number >> bit & 1 else 16
    bgr[: height // 4, : width // 4] = (0, 0, 255)
    return bgr


def blank(_number: int, width: int = WIDTH, height: int = HEIGHT) -> NDArray[np.uint8]:
    """A grey frame, on which a detector soon gives up."""
    return np.full((height, width, 3), 128, np.uint8)


def number_of(bgr: NDArray[np.uint8]) -> int:
    """The number of a frame made by `picture`."""
    height, width = bgr.shape[:2]
    step = width // _BITS
    bars = [
        bgr[height // 2 :, (bit * step + step // 3) : (bit * step + 2 * step // 3)].mean()
        for bit in range(_BITS)
    ]
    return sum((bar > 128) << bit for bit, bar in enumerate(bars))


def write(
    path: Path,
    frames: int = 40,
    *,
    codec: str = "libx264",
    pixel_format: str = "yuv420p",
    times_ms: Sequence[int] | None = None,
    keyframe_every: int = 10,
    b_frames: int = 2,
    rotation_deg: int = 0,
    faststart: bool = False,
    options: dict[str, str] | None = None,
    size: tuple[int, int] = (WIDTH, HEIGHT),
    paint: Callable[[int, int, int], NDArray[np.uint8]] = picture,
) -> Path:
    """Write a video whose format is its name's.

    Parameters
    ----------
    times_ms : sequence of int or None
        Of each frame; None is 25 frames a second.
    rotation_deg : int
        By which a player shall turn the picture, clockwise.
    faststart : bool
        MP4: the index before the pictures.
    """
    flags = {"movflags": "faststart"} if faststart else {}
    with av.open(str(path), "w", options=flags) as container:
        stream = container.add_stream(
            codec, rate=25, options=_OPTIONS.get(codec, {}) | (options or {})
        )
        stream.width, stream.height = size
        stream.pix_fmt = pixel_format
        # AVI counts frames, others time them.
        unit = Fraction(1, 25) if path.suffix == ".avi" else Fraction(1, 1000)
        stream.time_base = stream.codec_context.time_base = unit
        stream.codec_context.gop_size = keyframe_every
        if codec in ("libx264", "libx265"):
            stream.codec_context.max_b_frames = b_frames
        if rotation_deg:
            stream.set_display_rotation(-rotation_deg)
        for number in range(frames):
            frame = av.VideoFrame.from_ndarray(paint(number, *size), format="bgr24")
            frame.pts = round(Fraction(times_ms[number] if times_ms else 40 * number, 1000) / unit)
            frame.time_base = unit
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return path


_OPTIONS = {
    "libx264": {"preset": "ultrafast", "crf": "18", "sc_threshold": "0"},
    "libx265": {"preset": "ultrafast", "x265-params": "log-level=error:pools=1:frame-threads=1"},
    "libvpx-vp9": {"deadline": "realtime", "cpu-used": "8"},
}


def write_with_subtitles(path: Path, codec: str, texts: Sequence[str]) -> Path:
    """Write a video with a subtitle to each frame, 25 a second."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=25, options=_OPTIONS["libx264"])
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        subtitles = container.add_stream(codec)
        subtitles.codec_context.subtitle_header = _STYLES
        subtitles.time_base = Fraction(1, 1000)
        for number, text in enumerate(texts):
            frame = av.VideoFrame.from_ndarray(picture(number), format="bgr24")
            frame.pts, frame.time_base = number, Fraction(1, 25)
            container.mux(stream.encode(frame))
            data = text.encode()
            length = len(data).to_bytes(2, "big") if codec == "mov_text" else b""
            packet = av.Packet(length + data)
            packet.stream, packet.time_base = subtitles, Fraction(1, 1000)
            packet.pts = packet.dts = 40 * number
            packet.duration = 40
            container.mux(packet)
        container.mux(stream.encode(None))
    return path


# The encoders ask for a header in the form of ASS, whatever they write.
_STYLES = (
    b"[Script Info]\nScriptType: v4.00+\n\n[V4+ Styles]\nFormat: Name, Fontname, Fontsize\n"
    b"Style: Default,Arial,16\n\n[Events]\nFormat: Layer, Start, End, Style, Text\n"
)
