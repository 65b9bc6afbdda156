"""Opens a source with FFmpeg and gives its packets as they come."""

from __future__ import annotations

import contextlib
import io
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from padstudio.errors import LimitError, StudioError
from padstudio.live.stream.addresses import StreamAddress
from padstudio.live.stream.errors import StreamError, explain
from padstudio.live.stream.options import StreamOptions, opening_of
from padstudio.media.video import main_stream, open_container
from padstudio.network import lookup

if TYPE_CHECKING:
    from av import Packet
    from av.container import InputContainer
    from av.video.codeccontext import VideoCodecContext
    from av.video.stream import VideoStream

#: Of an SDP file, bytes.
MAX_SDP_BYTES = 64 << 10


class Connection:
    """An open source.

    Parameters
    ----------
    address : StreamAddress
    options : StreamOptions

    Raises
    ------
    StreamError
        If it cannot be opened, or has no video that can be decoded.
    """

    def __init__(self, address: StreamAddress, options: StreamOptions) -> None:
        self.address, self.options = address, options
        self._stack = contextlib.ExitStack()
        try:
            self._container = self._open()
            self.stream = self._stream()
        except BaseException as error:
            self.close()
            if not isinstance(error, Exception):
                raise
            told = explain(error, address)
            if address.is_secure and options.verify_tls and not isinstance(error, StreamError):
                told = self._certificate_error() or told
            raise told from None

    @property
    def codec(self) -> VideoCodecContext:
        """Decodes the stream's packets."""
        return self.stream.codec_context

    @property
    def is_timed(self) -> bool:
        """Whether its packets have times of their own; pictures by HTTP have none."""
        return self._container.format.name not in ("mpjpeg", "mjpeg")

    def packets(self, is_closing: threading.Event) -> Iterator[Packet[VideoStream]]:
        """Packets as they come, those of a file when they are due; at its end an empty one.

        Raises
        ------
        StreamError
            If the stream breaks or is silent for too long.
        """
        packets = iter(self._container.demux(self.stream))
        start: float | None = None
        while not is_closing.is_set():
            asked_s = time.monotonic()
            try:
                packet = next(packets, None)
            except Exception as error:
                # FFmpeg's errors are the system's, or have no root in common.
                raise self._lost(error) from None
            if packet is None:
                return
            if self.address.kind == "file" and packet.dts is not None:
                due = float(packet.dts * packet.time_base)
                start = time.monotonic() - due if start is None else start
                if is_closing.wait(max(0.0, start + due - time.monotonic())):
                    return
            yield packet
            # FFmpeg gives what it held back before it says that nothing comes.
            if self.address.kind != "file" and time.monotonic() - asked_s >= self.options.silent_s:
                raise self._silent()

    def close(self) -> None:
        """Let go of the source."""
        self._stack.close()

    def _open(self) -> InputContainer:
        import av
        from av.container import InputContainer

        address, options = self.address, self.options
        if address.kind == "file":
            if not Path(address.url).is_file():
                raise FileNotFoundError(2, "no such file")
            return self._stack.enter_context(open_container(address.url, options.max_pixels))
        if address.kind in ("rtsp", "http"):
            # FFmpeg does not tell an unknown name from other faults.
            lookup(address.host, address.port)
        opening = opening_of(address, options, _read_sdp(address))
        source: str | IO[bytes] = opening.target if opening.sdp is None else io.BytesIO(opening.sdp)
        if opening.form is not None:
            self._check_form(opening.form)
        try:
            container = av.open(
                source,
                format=opening.form,
                options=opening.options,
                metadata_errors="replace",
                timeout=(options.connect_s, options.silent_s),
            )
        except (av.error.PatchWelcomeError, av.error.ArgumentError, av.error.InvalidDataError):
            if address.kind == "rtp" and opening.sdp is None:
                raise self._needs_sdp() from None
            raise
        assert isinstance(container, InputContainer)
        return self._stack.enter_context(container)

    def _check_form(self, form: str) -> None:
        from av.format import ContainerFormat

        try:
            ContainerFormat(form, "r")
        except ValueError:
            unknown = f"this installation of FFmpeg knows no {form}"
            raise self._error(unknown, "not_available", True) from None

    def _stream(self) -> VideoStream:
        """The stream with the largest frames; a size that is not known yet counts as none."""
        if self.address.kind == "file":
            return main_stream(self._container, self.options.max_pixels)
        streams = self._container.streams.video
        if not streams:
            raise self._error("the stream holds no video", "no_video_stream", False)
        decoded = [s for s in streams if s.codec_context is not None]
        if not decoded:
            raise self._error(
                "its codec cannot be decoded; let the camera send H.264 or H.265",
                "unsupported_codec",
                True,
            )
        stream = max(decoded, key=lambda s: s.codec_context.width * s.codec_context.height)
        context: Any = stream.codec_context
        check_size(context.width, context.height, self.options.max_pixels)
        # Threads by frames would hold frames back, and one is enough for any camera's stream.
        context.thread_count, context.thread_type = 1, "NONE"
        context.options = {"max_pixels": str(self.options.max_pixels)}
        return stream

    def _needs_sdp(self) -> StreamError:
        port = self.address.port
        return self._error(
            "RTP alone does not say what it carries: name the codec, as "
            f"rtp://0.0.0.0:{port}?codec=h264, or give the sender's .sdp file",
            "sdp_needed",
            True,
        )

    def _certificate_error(self) -> StreamError | None:
        """FFmpeg does not tell a certificate from other faults: what Python says of it."""
        import ssl

        context, host = ssl.create_default_context(), self.address.host
        where = (host, self.address.port)
        try:
            with (
                socket.create_connection(where, self.options.connect_s) as plain,
                context.wrap_socket(plain, server_hostname=host),
            ):
                return None
        except ssl.SSLCertVerificationError as error:
            said = f"its certificate is not trusted ({error.verify_message})"
            return self._error(said, "bad_certificate", True)
        except OSError:
            return None

    def _lost(self, error: Exception) -> StreamError:
        if type(error).__name__ in ("ExitError", "TimeoutError"):
            return self._silent()
        return explain(error, self.address)

    def _silent(self) -> StreamError:
        return self._error(f"nothing came for {self.options.silent_s:g} s", "silent", False)

    def _error(self, sentence: str, code: str, is_final: bool) -> StreamError:
        return StreamError(f"{self.address.shown}: {sentence}", code=code, is_final=is_final)


def check_size(width: int, height: int, max_pixels: int) -> None:
    """Raises LimitError where frames have too many pixels."""
    if width * height > max_pixels:
        raise LimitError(
            f"its frames are {width} x {height}, more than {max_pixels / 1e6:g} megapixels; let "
            "the camera send smaller ones",
            code="too_many_pixels",
        )


def _read_sdp(address: StreamAddress) -> bytes | None:
    if address.kind != "sdp":
        return None
    with Path(address.url).open("rb") as file:
        data = file.read(MAX_SDP_BYTES + 1)
    if len(data) > MAX_SDP_BYTES or not data.startswith(b"v=0"):
        raise StudioError("the file is no SDP description", code="bad_sdp")
    return data
