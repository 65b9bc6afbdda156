"""A camera that shows its pictures over HTTP, as many do: MJPEG in parts, or MPEG-TS."""

from __future__ import annotations

import contextlib
import io
import ssl
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import av
import cv2
import pytest
import videos

_RATE_HZ = 50.0


class HttpCamera(ThreadingHTTPServer):
    """Answers ``/mjpeg`` (frames of `videos.picture`, 0 … 255 in a loop), ``/ts``, ``/page``,
    ``/elsewhere`` (a redirection to ``/mjpeg``) and ``/secret``, which asks for a password.

    Parameters
    ----------
    transport_stream : bytes
        What is sent at ``/ts``.
    certificate : Path or None
        Makes it a server of HTTPS, of the host ``localhost``.
    """

    daemon_threads = True

    def __init__(self, transport_stream: bytes = b"", certificate: Path | None = None) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self._origin = f"http://127.0.0.1:{self.server_port}"
        if certificate is not None:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            context.load_cert_chain(certificate)
            self.socket = context.wrap_socket(self.socket, server_side=True)
            self._origin = f"https://localhost:{self.server_port}"
        self.transport_stream = transport_stream
        self.is_over = threading.Event()
        self.hosts: list[str] = []
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def url(self, path: str) -> str:
        """The address of a path."""
        return self._origin + path

    def handle_error(self, *_words: object) -> None:
        """A client that does not trust the certificate hangs up."""

    def close(self) -> None:
        """End all connections."""
        self.is_over.set()
        self.shutdown()
        self.server_close()


class _Handler(BaseHTTPRequestHandler):
    server: HttpCamera

    def do_GET(self) -> None:
        self.server.hosts.append(self.headers["Host"])
        with contextlib.suppress(OSError):
            if self.path == "/mjpeg":
                self._send_pictures()
            elif self.path == "/ts":
                self._begin("video/mp2t")
                self.wfile.write(self.server.transport_stream)
            elif self.path == "/page":
                self._begin("text/html")
                self.wfile.write(b"<html>Log in</html>" * 500)
            elif self.path == "/elsewhere":
                self.send_response(302)
                self.send_header("Location", "/mjpeg")
                self.end_headers()
            else:
                self.send_error(401 if self.path == "/secret" else 404)

    def log_message(self, *_words: object) -> None:
        pass

    def _begin(self, kind: str) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.end_headers()

    def _send_pictures(self) -> None:
        self._begin("multipart/x-mixed-replace; boundary=frame")
        number = 0
        while not self.server.is_over.wait(1 / _RATE_HZ):
            jpeg = cv2.imencode(".jpg", videos.picture(number % 256))[1].tobytes()
            head = b"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: %d\r\n\r\n" % len(jpeg)
            self.wfile.write(head + jpeg + b"\r\n")
            number += 1


def transport_stream(path: Path) -> bytes:
    """An H.264 file's packets as MPEG-TS."""
    out = io.BytesIO()
    with av.open(str(path)) as source, av.open(out, "w", format="mpegts") as target:
        stream = target.add_stream_from_template(source.streams.video[0])
        for packet in source.demux(video=0):
            if packet.dts is not None:
                packet.stream = stream
                target.mux(packet)
    return out.getvalue()


@pytest.fixture
def http_camera() -> Iterator[HttpCamera]:
    """A camera that is ended with the test; its ``transport_stream`` can be set."""
    camera = HttpCamera()
    yield camera
    camera.close()
