"""A network camera of GStreamer's: run by the system's Python, which has its bindings.

    /usr/bin/python3 gstreamer_camera.py --as rtsp --port 0 video.mp4 [other_size.mp4 …]

Streams files of H.264 or H.265 (all of one) in a loop, each frame at its time, as RTSP, as MPEG-TS
or RTP over UDP. Writes ``ready PORT``, then takes commands by lines: ``silence``, ``speak``,
``file NUMBER``, ``count``; each is answered by the number of frames sent so far.
"""

from __future__ import annotations

import argparse
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstApp", "1.0")
gi.require_version("GstRtsp", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstApp, GstRtsp, GstRtspServer  # noqa: E402

PATH = "/camera"
_CAPS = "video/x-{codec},stream-format=byte-stream,alignment=au"
_SOURCE = f"appsrc name=source is-live=true format=time caps={_CAPS} ! {{codec}}parse ! {_CAPS}"
_RTP = "rtp{codec}pay pt=96"
_ELEMENTS = ("appsrc", "qtdemux", "h264parse", "h265parse", "rtph264pay", "rtph265pay")
_ELEMENTS += ("mpegtsmux", "rtpmp2tpay", "udpsink", "rtpbin")
_SINK = "udpsink host=127.0.0.1 port={port} sync=false"
_WAYS = {
    "ts": f"mpegtsmux alignment=7 ! {_SINK}",
    "rtp": f"{_RTP} ! {_SINK}",
    "rtp-ts": f"mpegtsmux ! rtpmp2tpay pt=33 ! {_SINK}",
}


@dataclass(frozen=True)
class Unit:
    """A coded frame, and its time in its file, ns."""

    data: bytes
    pts: int
    is_key: bool


def codec_of(path: str) -> str:
    """What GStreamer's elements call an MP4 file's codec."""
    data = Path(path).read_bytes()
    return "h265" if b"hvc1" in data or b"hev1" in data else "h264"


def read_units(path: str, codec: str) -> list[Unit]:
    """All frames of an MP4 file, each keyframe with its parameters, from GStreamer's own parser."""
    caps = _CAPS.format(codec=codec)
    pipeline = Gst.parse_launch(
        f'filesrc location="{path}" ! qtdemux ! {codec}parse config-interval=-1 '
        f"! {caps} ! appsink name=sink sync=false"
    )
    pipeline.set_state(Gst.State.PLAYING)
    sink = pipeline.get_by_name("sink")
    units, first = [], None
    while (sample := sink.pull_sample()) is not None:
        buffer = sample.get_buffer()
        first = buffer.dts if first is None else first
        is_key = not buffer.has_flags(Gst.BufferFlags.DELTA_UNIT)
        data = buffer.extract_dup(0, buffer.get_size())
        units.append(Unit(data, max(0, buffer.pts - first), is_key))
    pipeline.set_state(Gst.State.NULL)
    assert units, f"{path} holds no frames of {codec}"
    return units


def lap_ns(units: list[Unit]) -> float:
    """How long all of them last; what files say of a frame's duration is not to be relied on."""
    times = [unit.pts for unit in units]
    return (max(times) - min(times)) * len(units) / max(1, len(units) - 1) or 1e9


class Camera:
    """What is filmed: the files' frames, each at its time, whoever watches."""

    def __init__(self, files: list[list[Unit]], speed: float, began: float) -> None:
        self.files, self.speed, self.began = files, speed, began
        self.file = 0
        self.is_silent = False
        self.sent = 0


class Pusher(threading.Thread):
    """Feeds one pipeline with the camera's frames until it is stopped."""

    def __init__(self, camera: Camera, source: GstApp.AppSrc) -> None:
        super().__init__(daemon=True)
        self.camera, self.source = camera, source
        self.is_over = threading.Event()
        source.connect("need-data", self._begin)

    def _begin(self, _source: GstApp.AppSrc, _bytes: int) -> None:
        if not self.is_alive() and not self.is_over.is_set():
            self.start()

    def run(self) -> None:
        camera = self.camera
        while (clock := self.source.get_clock()) is None:
            time.sleep(0.001)
        running = clock.get_time() - self.source.get_base_time()
        origin = time.monotonic()
        file, units, start = -1, [], 0.0
        place, lap = 0, 0.0
        while not self.is_over.is_set():
            if file != camera.file:
                file, units = camera.file, camera.files[camera.file]
                lap = lap_ns(units) / 1e9 / camera.speed
                place, start = self._first(units, lap, time.monotonic())
            unit = units[place]
            due = start + unit.pts / 1e9 / camera.speed
            if self.is_over.wait(max(0.0, due - time.monotonic())):
                return
            if not camera.is_silent:
                buffer = Gst.Buffer.new_wrapped(unit.data)
                buffer.pts = max(0, running + int((due - origin) * 1e9))
                if self.source.emit("push-buffer", buffer) != Gst.FlowReturn.OK:
                    return
                camera.sent += 1
            place += 1
            if place == len(units):
                place, start = 0, start + lap

    def _first(self, units: list[Unit], lap: float, now: float) -> tuple[int, float]:
        """Where to begin: at the start, or at the next keyframe of what is on now."""
        if not self.camera.began:
            return 0, now
        at = (time.time() - self.camera.began) % lap
        for place, unit in enumerate(units):
            pts = unit.pts / 1e9 / self.camera.speed
            if unit.is_key and pts >= at:
                return place, now - at
        return 0, now - at + lap


def serve_rtsp(camera: Camera, options: argparse.Namespace) -> int:
    """Start an RTSP server; its port."""
    server = GstRtspServer.RTSPServer()
    server.set_address("127.0.0.1")
    server.set_service(str(options.port))
    factory = GstRtspServer.RTSPMediaFactory()
    factory.set_launch(f"( {_SOURCE} ! {_RTP} name=pay0 )".format(codec=options.codec))
    if options.password:
        auth = GstRtspServer.RTSPAuth()
        token = GstRtspServer.RTSPToken()
        token.set_string("media.factory.role", "user")
        auth.add_digest(options.user, options.password, token)
        auth.set_supported_methods(GstRtsp.RTSPAuthMethod.DIGEST)
        server.set_auth(auth)
        permissions = GstRtspServer.RTSPPermissions()
        permissions.add_permission_for_role("user", "media.factory.access", True)
        permissions.add_permission_for_role("user", "media.factory.construct", True)
        factory.set_permissions(permissions)

    def configure(_factory: object, media: GstRtspServer.RTSPMedia) -> None:
        pusher = Pusher(camera, media.get_element().get_by_name_recurse_up("source"))
        media.connect("unprepared", lambda _media: pusher.is_over.set())

    factory.connect("media-configure", configure)
    server.get_mount_points().add_factory(PATH, factory)
    assert server.attach(None), f"port {options.port} is taken"
    return server.get_bound_port()


def send(camera: Camera, options: argparse.Namespace) -> int:
    """Start sending to a port on this machine."""
    pipeline = Gst.parse_launch(
        f"{_SOURCE} ! {_WAYS[options.way]}".format(codec=options.codec, port=options.port)
    )
    options.pusher = Pusher(camera, pipeline.get_by_name("source"))
    options.pipeline = pipeline
    pipeline.set_state(Gst.State.PLAYING)
    return options.port


def obey(camera: Camera, loop: GLib.MainLoop) -> None:
    """Take commands until there are no more."""
    for line in sys.stdin:
        words = line.split()
        if words[0] in ("silence", "speak"):
            camera.is_silent = words[0] == "silence"
        elif words[0] == "file":
            camera.file = int(words[1])
        print(camera.sent, flush=True)
    loop.quit()


def main() -> None:
    """Read the command line and stream until standard input ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*")
    parser.add_argument("--check", action="store_true", help="whether all elements are installed")
    parser.add_argument("--as", dest="way", choices=["rtsp", *_WAYS], default="rtsp")
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--user", default="pilot")
    parser.add_argument("--password", default="")
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("--began", type=float, default=0.0, help="Unix time; 0: as one connects")
    options = parser.parse_args()
    Gst.init(None)
    if options.check:
        sys.exit(not all(map(Gst.ElementFactory.find, _ELEMENTS)))
    options.codec = codec_of(options.files[0])
    files = [read_units(path, options.codec) for path in options.files]
    camera = Camera(files, options.speed, options.began)
    port = serve_rtsp(camera, options) if options.way == "rtsp" else send(camera, options)
    loop = GLib.MainLoop()
    threading.Thread(target=obey, args=(camera, loop), daemon=True).start()
    print(f"ready {port}", flush=True)
    loop.run()


if __name__ == "__main__":
    main()
