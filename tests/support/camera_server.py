"""Network cameras for tests, and the fixtures that start them.

`CameraServer` runs GStreamer's RTSP server, or its senders of MPEG-TS and RTP over UDP
(`gstreamer_camera.py`, in a process of the system's Python). Fixtures, known to the whole suite:

``rtsp_server``
    ``rtsp_server(path, …, password="", began=0.0, speed=1.0) -> CameraServer``: streams files of
    H.264 or H.265 in a loop, at `CameraServer.url`, over TCP and UDP; ended with the test.
``udp_sender``
    ``udp_sender(path, way="ts" | "rtp" | "rtp-ts", port=…)``: the same, sent to a UDP port.
``rtsp_relay``
    ``rtsp_relay(server, drop=0.02, reorder=0.0, seed=1) -> RtspRelay``: between a client and the
    server, `RtspRelay.url`; loses or exchanges packets of RTP over UDP.
``free_udp_port``
    An even port of 127.0.0.1 at which nothing listens.

Where GStreamer is missing, they fail and say what installs it.
"""

from __future__ import annotations

import contextlib
import select
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest
from udp_relay import RtspRelay

PYTHONS = ("/usr/bin/python3", "/opt/homebrew/bin/python3", "/usr/local/bin/python3")
_SCRIPT = Path(__file__).with_name("gstreamer_camera.py")
_WAIT_S = 60.0

StartServer = Callable[..., "CameraServer"]


@cache
def _python() -> str:
    """A Python that has GStreamer's bindings; the environment's own has not."""
    for python in PYTHONS:
        if Path(python).exists():
            command = [python, str(_SCRIPT), "--check"]
            if subprocess.run(command, capture_output=True).returncode == 0:
                return python
    raise AssertionError(
        "GStreamer's RTSP server or its Python bindings are missing; tests/install-tools.sh "
        "installs them"
    )


class CameraServer:
    """A process that streams files.

    Parameters
    ----------
    files : Path
        Videos in MP4, all of H.264 or all of H.265; the first is shown until `show` names another.
    way : {"rtsp", "ts", "rtp", "rtp-ts"}
    port : int
        0: any free one (RTSP alone).
    password : str
        What the user ``pilot`` has to say; empty: nobody is asked.
    began : float
        Unix time at which the camera began to film: who connects later joins in at the next
        keyframe. 0: each connection begins with the first frame.
    speed : float
        Frames come that much faster.
    """

    def __init__(
        self,
        *files: Path,
        way: str = "rtsp",
        port: int = 0,
        password: str = "",
        began: float = 0.0,
        speed: float = 1.0,
    ) -> None:
        self.port = port
        self._arguments = [*map(str, files), "--as", way, "--password", password]
        self._arguments += ["--began", str(began), "--speed", str(speed)]
        self._process: subprocess.Popen[str] | None = None
        self.start()

    @property
    def url(self) -> str:
        """Of the stream, without a password."""
        return self.url_for("")

    def url_for(self, password: str) -> str:
        """The address with a password for ``pilot``."""
        user = f"pilot:{password}@" if password else ""
        return f"rtsp://{user}127.0.0.1:{self.port}/camera"

    def start(self) -> None:
        """Start, or start again at the same port."""
        command = [_python(), str(_SCRIPT), *self._arguments, "--port", str(self.port)]
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True)
        self.port = int(self._answer().removeprefix("ready "))

    def stop(self) -> None:
        """Pull the plug: connections break, and nobody listens at the port."""
        if self._process is not None:
            process, self._process = self._process, None
            process.kill()
            process.communicate()

    def silence(self) -> None:
        """Send no frames, with connections left open; time goes on."""
        self._tell("silence")

    def speak(self) -> None:
        """Send frames again."""
        self._tell("speak")

    def show(self, file: int) -> None:
        """Go on with another of the files, from its first frame."""
        self._tell(f"file {file}")

    def sent(self) -> int:
        """Frames sent since the process was started, to whomever."""
        return self._tell("count")

    def _tell(self, command: str) -> int:
        assert self._process is not None
        assert self._process.stdin is not None
        self._process.stdin.write(command + "\n")
        self._process.stdin.flush()
        return int(self._answer())

    def _answer(self) -> str:
        assert self._process is not None
        assert self._process.stdout is not None
        ready, _, _ = select.select([self._process.stdout], [], [], _WAIT_S)
        line = self._process.stdout.readline().strip() if ready else ""
        assert line, "the camera's process ended or hangs"
        return line


@pytest.fixture
def rtsp_server() -> Iterator[StartServer]:
    """Starts RTSP servers; see the module."""
    with contextlib.ExitStack() as stack:

        def start(*files: Path, **options: object) -> CameraServer:
            server = CameraServer(*files, **options)  # type: ignore[arg-type]
            stack.callback(server.stop)
            return server

        yield start


@pytest.fixture
def udp_sender(rtsp_server: StartServer) -> StartServer:
    """Starts senders over UDP; see the module."""
    return rtsp_server


@pytest.fixture
def rtsp_relay() -> Iterator[Callable[..., RtspRelay]]:
    """Starts relays that lose packets; see the module."""
    with contextlib.ExitStack() as stack:

        def start(server: CameraServer, **options: float) -> RtspRelay:
            relay = RtspRelay(server.port, **options)  # type: ignore[arg-type]
            stack.callback(relay.close)
            return relay

        yield start


@pytest.fixture
def free_udp_port() -> int:
    """An even port of 127.0.0.1 that is free, and so is the next."""
    return find_udp_port()


def find_udp_port() -> int:
    """An even UDP port of 127.0.0.1 that is free, and so is the next, which RTCP uses."""
    while True:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as first:
            first.bind(("127.0.0.1", 0))
            port: int = first.getsockname()[1]
            if port % 2:
                continue
            with contextlib.suppress(OSError), _bound(port + 1):
                return port


def _bound(port: int) -> socket.socket:
    second = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    second.bind(("127.0.0.1", port))
    return second


def wait_for(condition: Callable[[], object], most_s: float = _WAIT_S) -> None:
    """Wait until something holds; a failure where it never does."""
    end = time.monotonic() + most_s
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.005)
