#!/usr/bin/env python3
"""``padstudio live`` on a network camera: start, memory, CPU share, latency, score.

    bench_live.py [--flight VIDEO] [--seconds N] [--losses N] [--http]

A flight that has its truth beside it (by default the landing of the footage; pad and camera stand
in the folder above) is encoded as a camera would, H.264 with a keyframe a second and no B-frames,
and streamed in real time by GStreamer's RTSP server. The command runs on the first core alone,
camera and benchmark on the others. Told are: seconds from its start to the first frame and pose;
the largest resident memory; CPU time over wall-clock time; frames received, read, and false by
score.py; latencies; and those of the first pose after the stream was silent for 3 s.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
import score

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))

from camera_server import CameraServer  # noqa: E402

_PROGRAM = "from padstudio.cli.program import main; main()"
_SILENT_S = 3.0
_TICKS = os.sysconf("SC_CLK_TCK")


def as_camera(video: Path, target: Path) -> int:
    """The video as a camera encodes it; how many frames it has."""
    count = 0
    with av.open(str(video)) as source, av.open(str(target), "w") as out:
        given = source.streams.video[0]
        options = {"preset": "veryfast", "crf": "16", "tune": "zerolatency"}
        stream = out.add_stream("libx264", rate=30, options=options)
        stream.width, stream.height, stream.pix_fmt = given.width, given.height, "yuv420p"
        stream.codec_context.gop_size = 30
        for frame in source.decode(given):
            frame.pts, frame.time_base = count, Fraction(1, 30)
            frame.pict_type = av.video.frame.PictureType.NONE
            out.mux(stream.encode(frame))
            count += 1
        out.mux(stream.encode(None))
    return count


class Live:
    """The command, and what it has said so far."""

    def __init__(self, url: str, pad: Path, camera: Path, *more: str) -> None:
        command = [sys.executable, "-c", _PROGRAM, "live", url, "--pad", str(pad)]
        command += ["--camera", str(camera), "--json", "-", "--stats-json", "--quiet", *more]
        self.begun_s = time.time()
        self.process = subprocess.Popen(
            ["taskset", "-c", "0", *command], stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        self.lines: list[dict[str, Any]] = []
        self.stats: dict[str, Any] = {}
        self.errors = ""
        self._threads = [
            threading.Thread(target=self._read_lines, daemon=True),
            threading.Thread(target=self._read_stats, daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    def frames(self) -> list[dict[str, Any]]:
        """Lines of frames."""
        return [line for line in self.lines if "status" in line]

    def usage(self) -> tuple[float, float]:
        """CPU seconds so far, and the largest resident memory, MB."""
        folder = Path(f"/proc/{self.process.pid}")
        fields = (folder / "stat").read_text(encoding="ascii").rpartition(")")[2].split()
        status = (folder / "status").read_text(encoding="ascii")
        peak = next(line for line in status.splitlines() if line.startswith("VmHWM"))
        return (int(fields[11]) + int(fields[12])) / _TICKS, int(peak.split()[1]) / 1024

    def end(self) -> int:
        """End it in order."""
        self.process.terminate()
        code = self.process.wait(30)
        for thread in self._threads:
            thread.join(10)
        return code

    def _read_lines(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append(json.loads(line))

    def _read_stats(self) -> None:
        assert self.process.stderr is not None
        for line in self.process.stderr:
            if line.startswith(b"{"):
                self.stats = json.loads(line)
            else:
                self.errors += line.decode()


def judged(frames: list[dict[str, Any]], truth: list[dict[str, Any]]) -> Iterator[str]:
    """Verdicts of the poses of one connection; they tell themselves which frame is its first."""
    # A connection's clock begins anywhere between two frames.
    first_s = frames[0]["time_s"]
    places = [round((frame["time_s"] - first_s) * 30) for frame in frames]
    found = [(place, frame) for place, frame in zip(places, frames, strict=True) if _ok(frame)]

    def verdict(place: int, frame: dict[str, Any]) -> str:
        return score.judge(truth[place % len(truth)], frame, ("", 0)).verdict

    def good(offset: int) -> int:
        return sum(verdict(place + offset, frame) == "good" for place, frame in found[:40])

    offset = max(range(len(truth)), key=good)
    return (verdict(place + offset, frame) for place, frame in found)


def _ok(line: dict[str, Any]) -> bool:
    return line.get("status") == "ok"


def after_losses(lines: list[dict[str, Any]]) -> list[float]:
    """Milliseconds from decoded frame to the first pose after each loss of the stream."""
    found: list[float] = []
    is_lost = has_begun = False
    for line in lines:
        has_begun = has_begun or _ok(line)
        is_lost = is_lost or (has_begun and line.get("event") == "no_stream")
        if is_lost and _ok(line):
            found.append(1000 * (line["live"]["posed_s"] - line["live"]["decoded_s"]))
            is_lost = False
    return found


def measure(args: argparse.Namespace, folder: Path) -> None:
    told = json.loads(args.flight.with_suffix(".truth.json").read_text(encoding="utf-8"))
    footage = args.flight.parent.parent
    video = folder / "camera.mp4"
    as_camera(args.flight, video)
    server = CameraServer(video)
    try:
        more = ["--http", "127.0.0.1:0"] if args.http else []
        live = Live(server.url, footage / "pad_a.json", footage / told["camera"], *more)
        while not any(map(_ok, live.lines)) and live.process.poll() is None:
            time.sleep(0.05)
        cpu_s, _ = live.usage()
        wall_s = time.monotonic()
        time.sleep(args.seconds)
        more_cpu_s, peak_mb = live.usage()
        share = (more_cpu_s - cpu_s) / (time.monotonic() - wall_s)
        steady = live.stats
        for _ in range(args.losses):
            server.silence()
            time.sleep(_SILENT_S)
            server.speak()
            time.sleep(4)
        code = live.end()
    finally:
        server.stop()
    show(live, told["frames"], (share, peak_mb, code), steady)


def show(
    live: Live, truth: list[dict[str, Any]], used: tuple[float, float, int], steady: dict[str, Any]
) -> None:
    frames = live.frames()
    first_s = frames[0]["live"]["decoded_s"] - live.begun_s
    pose_s = next(f for f in frames if _ok(f))["live"]["posed_s"] - live.begun_s
    share, peak_mb, code = used
    verdicts = []
    for connection in sorted({f["live"]["connection"] for f in frames}):
        verdicts += judged([f for f in frames if f["live"]["connection"] == connection], truth)
    read = sum(map(_ok, frames))
    stream = live.stats["stream"]
    print(f"exit code {code}; first frame decoded after {first_s:.2f} s, first pose {pose_s:.2f} s")
    print(f"peak memory {peak_mb:.0f} MB; {100 * share:.0f} % of a core")
    print(
        f"decoded {stream['frames']}, dropped {stream['dropped']}, skipped packets "
        f"{stream.get('skipped', 0)}; looked at {len(frames)}, read {read} "
        f"({100 * read / len(frames):.1f} %), good {verdicts.count('good')}, "
        f"poor {verdicts.count('poor')}, false {verdicts.count('false')}"
    )
    print(f"{'latency, ms':24s}{'frames':>8s}{'median':>9s}{'95 %':>9s}{'of all':>9s}{'95 %':>9s}")
    for name, stage in (steady or live.stats)["latency_ms"].items():
        keys = ("median_ms", "p95_ms", "all_median_ms", "all_p95_ms")
        row = "".join(f"{stage[key]:9.2f}" for key in keys)
        print(f"{name.replace('_to_', ' → '):24s}{stage['frames']:8d}{row}")
    lost = after_losses(live.lines)
    if lost:
        print(
            f"decoded → first pose after a loss, ms: {', '.join(f'{value:.0f}' for value in lost)} "
            f"(median {np.median(lost):.0f})"
        )
    if live.errors:
        print(live.errors, file=sys.stderr)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    default = HERE.parent / "footage/flights/landing.mp4"
    parser.add_argument("--flight", type=Path, default=default)
    parser.add_argument("--seconds", type=float, default=20.0, help="measured after the first pose")
    parser.add_argument("--losses", type=int, default=5)
    parser.add_argument("--http", action="store_true", help="with a monitor that nobody watches")
    args = parser.parse_args()
    cores = os.sched_getaffinity(0)
    if len(cores) > 1:
        os.sched_setaffinity(0, cores - {0})
    with tempfile.TemporaryDirectory() as folder:
        measure(args, Path(folder))


if __name__ == "__main__":
    main()
