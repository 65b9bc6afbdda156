#!/usr/bin/env python3
"""Streams a looped landing through GStreamer's RTSP server into a live session, for long.

    soak_live.py [--minutes 60] [--speed 2] [--transport udp] [--pull 120]

Prints memory, frames and what was dropped, and in the end by how much memory grew after the first
minute. ``--speed`` has frames come that much faster than they were filmed.
"""

from __future__ import annotations

import argparse
import sys
import threading
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))

import psutil  # noqa: E402
from camera_server import CameraServer  # noqa: E402
from places import FOOTAGE  # noqa: E402

from padstudio.geometry.camera import Camera  # noqa: E402
from padstudio.live.session import LiveSession  # noqa: E402
from padstudio.live.stream.addresses import parse_address  # noqa: E402
from padstudio.live.stream.live_stream import LiveStream  # noqa: E402
from padstudio.live.stream.options import StreamOptions  # noqa: E402
from padstudio.live.stream.packet_shelf import PacketShelf  # noqa: E402
from padstudio.pad.spec import Pad  # noqa: E402
from padstudio.vision.detector import Detector  # noqa: E402

# Pools of memory fill up until then.
_WARM_S = 300.0


def main() -> int:
    """Soak; 1 where memory grew by more than was allowed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("--transport", choices=["tcp", "udp"], default="tcp")
    parser.add_argument("--every", type=float, default=15.0, help="seconds between lines")
    parser.add_argument("--pull", type=float, default=0.0, help="pull the stream so often, s")
    parser.add_argument("--video", type=Path, default=FOOTAGE / "flights/landing.mp4")
    parser.add_argument("--pad", type=Path, default=FOOTAGE / "pad_a.json")
    parser.add_argument("--camera", type=Path, default=FOOTAGE / "camera_drone_2k7.yaml")
    parser.add_argument("--most-growth-mb", type=float, default=15.0)
    options = parser.parse_args()
    server = CameraServer(options.video, speed=options.speed)
    shelf = PacketShelf()
    stream = LiveStream(
        parse_address(server.url), StreamOptions(transport=options.transport), (shelf,)
    )
    session = LiveSession(Detector(Pad.load(options.pad), Camera.load(options.camera)), stream)
    runner = threading.Thread(target=session.run)
    runner.start()
    try:
        growth = watch(options, server, stream, session, shelf)
    finally:
        session.stop()
        runner.join()
        stream.close()
        server.stop()
    print(f"growth after the first {_WARM_S:g} s: {growth:+.1f} MB")
    return growth > options.most_growth_mb


def watch(
    options: argparse.Namespace,
    server: CameraServer,
    stream: LiveStream,
    session: LiveSession,
    shelf: PacketShelf,
) -> float:
    """Print how it goes; the growth of memory, MB."""
    process = psutil.Process()
    begun = pulled = time.monotonic()
    warm = last = 0.0
    print("     s   RSS MB  shelf MB  CPU s  decoded  dropped  skipped  conns  read  poses")
    while time.monotonic() - begun < 60.0 * options.minutes:
        time.sleep(options.every)
        now = time.monotonic()
        last = process.memory_info().rss / 1e6
        if now - begun >= _WARM_S and not warm:
            warm = last
        state, counts = stream.state, session.counts
        print(
            f"{now - begun:6.0f} {last:8.1f} {shelf.size / 1e6:9.2f} "
            f"{sum(process.cpu_times()[:2]):6.0f} {state.frames:8d} {state.dropped:8d} "
            f"{state.skipped:8d} {state.connections:6d} {counts.frames:5d} {counts.poses:6d}",
            flush=True,
        )
        if options.pull and now - pulled >= options.pull:
            pulled = now
            server.stop()
            time.sleep(3.0)
            server.start()
    return last - warm if warm else 0.0


if __name__ == "__main__":
    sys.exit(main())
