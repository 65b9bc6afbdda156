"""Opens uploaded videos, whatever their name; only the ``video*`` modules read with PyAV."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from typing import IO, TYPE_CHECKING

from padstudio.errors import LimitError, StudioError
from padstudio.media.remote import open_source

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.video.stream import VideoStream

#: Pixels of one frame, unless the caller sets another limit.
MAX_PIXELS = 50_000_000

# Others, such as playlists and concatenations, make the reader open files of their choosing.
_FORMATS = "mov,mp4,matroska,webm,avi,mpegts"
_READABLE = "MP4, MOV, MKV, WebM, AVI or MPEG-TS"


class VideoError(StudioError):
    """A file is no readable video."""

    code = "invalid_video"
    status = 422


@contextlib.contextmanager
def open_container(source: str, max_pixels: int = MAX_PIXELS) -> Iterator[InputContainer]:
    """A video file opened for reading; raises `VideoError` where it is none."""
    import av

    with contextlib.ExitStack() as stack:
        file: str | IO[bytes] = stack.enter_context(open_source(source))
        options = _options(max_pixels)
        if isinstance(file, str):
            options["protocol_whitelist"] = "file"
        try:
            container = av.open(file, mode="r", options=options, metadata_errors="replace")
        except (av.error.FFmpegError, ValueError) as error:
            raise _unreadable(source, error) from error
        yield stack.enter_context(container)


def main_stream(container: InputContainer, max_pixels: int = MAX_PIXELS) -> VideoStream:
    """The video stream with the largest frames; cover pictures do not count.

    Raises
    ------
    VideoError
        If there is none.
    LimitError
        If its frames have too many pixels.
    """
    streams = [s for s in container.streams.video if not _is_cover(s)]
    if not streams:
        raise VideoError(
            "the file holds no video stream, only sound or subtitles; upload the camera's own file",
            code="no_video_stream",
        )
    stream = max(streams, key=lambda s: s.codec_context.width * s.codec_context.height)
    context = stream.codec_context
    size = (context.width, context.height)
    if not all(size):
        # The reader tells no size that it does not take.
        size = _refused_size(container.name, max_pixels) or size
    if size[0] * size[1] > max_pixels:
        raise LimitError(
            f"the video's frames are {size[0]} x {size[1]}, more than "
            f"{max_pixels / 1e6:g} megapixels; scale it down, or raise the limit in the settings",
            code="too_many_pixels",
        )
    if not all(size):
        raise VideoError(
            "the video's frames have no size: its first frames are missing or cannot be decoded; "
            "copy the file from the camera again",
            code="no_frames",
        )
    # A worker process has one core; the pictures are the same with any number of threads.
    context.thread_count = 1
    context.thread_type = "NONE"
    return stream


def decode(container: InputContainer, stream: VideoStream) -> Iterator[VideoFrame]:
    """Decode from where a container is: what is damaged is passed over, up to the end."""
    import av

    packets = container.demux(stream)
    while True:
        try:
            packet = next(packets, None)
            frames = packet.decode() if packet is not None else []
        except av.error.InvalidDataError:
            continue
        except (av.error.FFmpegError, EOFError):
            return
        if packet is None:
            return
        yield from frames


def read_subtitles(source: str) -> Iterator[tuple[float, str]]:
    """The texts of a video's first subtitle stream with their times, s.

    Yields
    ------
    tuple of float and str
        Seconds since the file's start, and the text as stored.
    """
    import av

    with open_container(source) as container:
        if not container.streams.subtitles:
            return
        stream = container.streams.subtitles[0]
        is_mp4_text = stream.codec_context.name == "mov_text"
        with contextlib.suppress(av.error.FFmpegError, EOFError):
            for packet in container.demux(stream):
                if packet.pts is None or not packet.size:
                    continue
                data = bytes(packet)
                if is_mp4_text:
                    # 3GPP TS 26.245: the text's length, the text, then its style.
                    data = data[2 : 2 + int.from_bytes(data[:2], "big")]
                yield float(packet.pts * (stream.time_base or 0)), data.decode("utf-8", "replace")


def _options(max_pixels: int) -> dict[str, str]:
    # The reader decodes a frame to learn what is in a file, hence the limit here too.
    return {"format_whitelist": _FORMATS, "max_pixels": str(max_pixels)}


def _refused_size(path: str, max_pixels: int) -> tuple[int, int] | None:
    """The size of frame at which the reader stopped; it is told only in the reader's log."""
    import av
    import av.logging

    level = av.logging.get_level()
    av.logging.set_level(av.logging.ERROR)
    try:
        with av.logging.Capture() as messages, contextlib.suppress(av.error.FFmpegError, OSError):
            av.open(path, options=_options(max_pixels)).close()
    finally:
        av.logging.set_level(level)
    for _, _, text in messages:
        found = re.match(r"Picture size (\d+)x(\d+) ", text)
        if found:
            return int(found[1]), int(found[2])
    return None


def _is_cover(stream: VideoStream) -> bool:
    from av.stream import Disposition

    return bool(stream.disposition & Disposition.attached_pic)


def _unreadable(source: str, error: Exception) -> VideoError:
    with open_source(source, as_file=True) as file:
        assert not isinstance(file, str)
        head = file.read(12)
    if not head:
        return VideoError("the file is empty; upload it again", code="empty_file")
    if head[4:8] in (b"ftyp", b"moov", b"mdat", b"free", b"wide"):
        return VideoError(
            "the video's index is missing or damaged: the recording or the copy was cut short; "
            "copy the file from the camera again, or repair it with a tool such as untrunc",
            code="truncated_video",
        )
    if head[:4] in (b"\x1a\x45\xdf\xa3", b"RIFF"):
        return VideoError(
            "the video holds no frame that can be read: the recording was cut short before the "
            "first one, or its beginning is damaged",
            code="no_frames",
        )
    return VideoError(
        f"the file is no video; upload {_READABLE} ({error.__class__.__name__})",
        code="not_a_video",
    )
