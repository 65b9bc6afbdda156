"""Plays files into a recorder, as a live session does with a stream."""

from __future__ import annotations

import json
import time
import zipfile
from collections.abc import Callable, Container, Iterator
from pathlib import Path
from typing import Any

import av
from places import FOOTAGE

from padstudio import Camera, Detector, Pad
from padstudio.live.recording.options import RecordingOptions, RecordingState
from padstudio.live.recording.recorder import Recorder, session_about
from padstudio.live.reports.frame import LiveFrame
from padstudio.live.reports.report import LiveReport
from padstudio.media.video_frames import to_frame
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Reason, StageFailure

PAD = FOOTAGE / "pad_a.json"
CAMERA = FOOTAGE / "camera_drone_2k7.yaml"
NOTHING = Detection(None, StageFailure("edges", Reason.NO_EDGES, "nothing stands out"))
#: Room enough on any disk, so that tests do not depend on it.
OPTIONS = RecordingOptions(least_free_bytes=0)
_MAX_PIXELS = 50_000_000

Packet = tuple[bytes, int | None, int | None, bool]


def recorder(
    folder: Path,
    options: RecordingOptions = OPTIONS,
    told: Callable[[RecordingState], None] | None = None,
    source: str = "rtsp://drone.local/live",
) -> Recorder:
    """One for the footage's pad and camera."""
    about = session_about(Pad.load(PAD), Camera.load(CAMERA), source)
    return Recorder(folder, about, options, told)


def packets_of(path: Path) -> list[Packet]:
    """A video's packets in their order: bytes, times, whether they are keyframes."""
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        return [
            (bytes(packet), packet.pts, packet.dts, packet.is_keyframe)
            for packet in container.demux(stream)
            if packet.size
        ]


def units(data: bytes, codec: str, is_framed: bool) -> list[bytes]:
    """The units of a packet, or the packet where its codec has none.

    Parameters
    ----------
    is_framed : bool
        They follow their lengths, not start codes.
    """
    if codec == "mjpeg":
        return [data]
    if not is_framed:
        return [part.rstrip(b"\0") for part in data.split(b"\0\0\1") if part.rstrip(b"\0")]
    found, place = [], 0
    while place < len(data):
        length = int.from_bytes(data[place : place + 4], "big")
        found.append(data[place + 4 : place + 4 + length].rstrip(b"\0"))
        place += 4 + length
    return found


def play(
    path: Path,
    into: Recorder,
    *,
    connection: int = 1,
    first_number: int = 0,
    is_read: Callable[[int], bool] = lambda number: True,
    detect: Callable[[LiveFrame], Detection] = lambda frame: NOTHING,
    between: Callable[[int], None] = lambda packet: None,
) -> int:
    """Give a file's packets and frames to a recorder; how many frames it has.

    Parameters
    ----------
    is_read : callable
        Of frames by their number; others are dropped, as where reading is slow.
    between : callable
        Called after each packet with its number.
    """
    number = 0
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        into.opened(stream, connection)
        for place, packet in enumerate(container.demux(stream)):
            if packet.size:
                into.packet(packet, time.monotonic())
                between(place)
            for frame in packet.decode():
                live = _live(frame, first_number + number, connection, stream.time_base)
                if is_read(number):
                    into.take(LiveReport(live, detect(live), time.monotonic()))
                number += 1
    into.closed()
    return number


def follower(pad: Path = PAD, camera: Path = CAMERA) -> Callable[[LiveFrame], Detection]:
    """Detects frames one by one, poses fused with those before, as a session does."""
    detector = Detector(Pad.load(pad), Camera.load(camera))
    waiting: list[LiveFrame] = []

    def pictures() -> Iterator[Any]:
        while True:
            yield waiting[-1].picture

    def times() -> Iterator[float]:
        while True:
            yield waiting[-1].pts_s

    found = detector.track(pictures(), times_s=times())

    def detect(frame: LiveFrame) -> Detection:
        waiting[:] = [frame]
        return next(found)

    return detect


def _live(frame: Any, number: int, connection: int, time_base: Any) -> LiveFrame:
    now_s = time.monotonic()
    picture = to_frame(frame, 0, _MAX_PIXELS)
    pts_s = float(frame.pts * time_base)
    return LiveFrame(number, picture, pts_s, now_s, now_s, connection=connection)


def lines_of(path: Path) -> list[dict[str, Any]]:
    """The records of a poses file."""
    return [json.loads(line) for line in path.read_text().splitlines()]


def session_of(folder: Path) -> dict[str, Any]:
    """What ``session.json`` says."""
    return dict(json.loads((folder / "session.json").read_text()))


#: Frames of the footage that a recorded session did not read.
MISSED = frozenset({5, 6, 17, 33, 34, 35, 59})


def record_landing(
    folder: Path,
    video: Path = FOOTAGE / "flights" / "landing.mp4",
    missed: Container[int] = MISSED,
) -> Path:
    """Record a landing in two segments, but for some frames with their poses."""
    options = RecordingOptions(segment_s=0.9, least_free_bytes=0)
    into = recorder(folder, options, source="rtsp://pilot:s3cret@drone.local/live")
    play(video, into, is_read=lambda number: number not in missed, detect=follower())
    into.close()
    return folder


def zip_of(folder: Path, target: Path, change: dict[str, bytes] | None = None) -> Path:
    """A zip of a folder, some of whose files are others, or none where they are empty."""
    contents = {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
    with zipfile.ZipFile(target, "w") as archive:
        for name, data in (contents | (change or {})).items():
            if data:
                archive.writestr(f"landing/{name}", data)
    return target
