"""Videos of simulated flights; the one file of the simulator that knows PyAV."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import SpecError, shown

if TYPE_CHECKING:
    from av import VideoFrame

Codec = Literal["h264", "h265"]
_ENCODERS = {"h264": "libx264", "h265": "libx265"}
# Presets and rate factors that give a drone's noise and size (docs/simulation.md): faster presets
# smooth noise away that cameras' encoders keep. The two encoders' scales differ.
_SETTINGS = {"h264": ("slow", 20), "h265": ("medium", 24)}

# Frames from key frame to key frame, as drones write them: a second at 30 frames a second.
_KEYFRAME_EVERY = 30


def check_size(width: int, height: int) -> None:
    """Refuse a size that no video of 4:2:0 colour can have.

    Raises
    ------
    SpecError
    """
    if width % 2 or height % 2:
        raise SpecError(
            f"a video of 4:2:0 colour needs an even size, not {width} x {height}; write stills",
            code="odd_video_size",
        )


class VideoWriter:
    """Writes an MP4 with 4:2:0 colour; use it as a context manager.

    Parameters
    ----------
    path : Path
    width, height : int
        Even, as 4:2:0 asks for.
    fps : float
    codec : {"h264", "h265"}
    quality : int, optional
        Constant rate factor, 0 (best) … 51; a drone's by default.

    Raises
    ------
    SpecError
        If the size is odd, or a figure out of range.
    """

    def __init__(
        self,
        path: Path,
        *,
        width: int,
        height: int,
        fps: float,
        codec: Codec = "h264",
        quality: int | None = None,
    ) -> None:
        import av
        from av.video.stream import VideoStream

        check_size(width, height)
        if codec not in _ENCODERS:
            raise SpecError(f"no codec {shown(codec)}; use {' or '.join(_ENCODERS)}")
        preset, usual = _SETTINGS[codec]
        quality = usual if quality is None else quality
        if not 0 <= quality <= 51:
            raise SpecError(f"quality is {quality}; it must lie within 0 … 51")
        self._container = av.open(str(path), "w")
        # A fixed number of threads: x264's and x265's output depends on it.
        options = {"crf": str(quality), "preset": preset}
        if codec == "h265":
            options["x265-params"] = "log-level=error:pools=2:frame-threads=1"
        else:
            options["threads"] = "2"
        rate = Fraction(fps).limit_denominator(1001)
        stream = self._container.add_stream(_ENCODERS[codec], rate=rate, options=options)
        assert isinstance(stream, VideoStream)
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.codec_context.gop_size = _KEYFRAME_EVERY
        self._path, self._stream = path, stream
        if codec == "h265":
            # The tag that Apple's players and browsers ask for.
            stream.codec_context.codec_tag = "hvc1"

    def __enter__(self) -> VideoWriter:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None:
            self._mux(None)
        self._container.close()
        if kind is not None:
            # Half a video beside no truth would only mislead.
            self._path.unlink(missing_ok=True)

    def write(self, bgr: NDArray[np.uint8]) -> None:
        """Append a frame (H, W, 3) uint8, BGR."""
        from av import VideoFrame

        self._mux(VideoFrame.from_ndarray(bgr, format="bgr24"))

    def _mux(self, frame: VideoFrame | None) -> None:
        for packet in self._stream.encode(frame):
            self._container.mux(packet)
