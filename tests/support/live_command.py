"""``padstudio live`` in a process of its own, and the stream that it reads."""

from __future__ import annotations

import contextlib
import json
import os
import select
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
from places import FOOTAGE

PAD, CAMERA = FOOTAGE / "pad_a.json", FOOTAGE / "camera_drone_2k7.yaml"
PATIENCE_S = 180.0
_PROGRAM = "from padstudio.cli.program import main; main()"


def landing_at(path: Path, size: tuple[int, int], *, crop: bool = False) -> Path:
    """The footage's landing in another size, H.264; ``crop`` changes the aspect."""
    with av.open(str(FOOTAGE / "flights/landing.mp4")) as source, av.open(str(path), "w") as target:
        stream = target.add_stream("libx264", rate=30, options={"preset": "ultrafast", "crf": "12"})
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        stream.codec_context.gop_size = 15
        stream.codec_context.max_b_frames = 0
        for number, frame in enumerate(source.decode(video=0)):
            bgr = frame.to_ndarray(format="bgr24")
            if crop:
                bgr = bgr[:, : bgr.shape[0]]
            small = cv2.resize(bgr, size, interpolation=cv2.INTER_AREA)
            out = av.VideoFrame.from_ndarray(np.ascontiguousarray(small), format="bgr24")
            out.pts, out.time_base = number, Fraction(1, 30)
            target.mux(stream.encode(out))
        target.mux(stream.encode(None))
    return path


def is_true(record: dict[str, Any]) -> bool:
    """Whether a pose is one of the landing's; which frame of the loop it is nobody says."""
    told = json.loads((FOOTAGE / "flights/landing.truth.json").read_text(encoding="utf-8"))
    found = np.array(record["position_mm"])
    for frame in told["frames"]:
        true = np.array(frame["position_mm"])
        turn = np.array(frame["rotation"]).T @ np.array(record["rotation"])
        angle = np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
        if np.linalg.norm(found - true) <= 0.02 * true[2] + 1 and angle <= 2:
            return True
    return False


class LiveCommand:
    """A running command, its lines read as they come."""

    def __init__(self, *arguments: object) -> None:
        command = [sys.executable, "-c", _PROGRAM, "live", *map(str, arguments)]
        environment = os.environ | {"NO_COLOR": "1", "COLUMNS": "200", "PYTHONUNBUFFERED": "1"}
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment
        )
        self.lines: list[dict[str, Any]] = []
        self._rest = b""

    @property
    def poses(self) -> list[dict[str, Any]]:
        """Lines with a pose so far."""
        return [line for line in self.lines if line.get("status") == "ok"]

    def events(self, kind: str) -> list[dict[str, Any]]:
        """Lines of an event so far."""
        return [line for line in self.lines if line.get("event") == kind]

    def read_until(self, holds: Callable[[], bool]) -> None:
        """Read lines until that is so."""
        assert self.process.stdout is not None
        limit_s = time.monotonic() + PATIENCE_S
        while not holds():
            left_s = limit_s - time.monotonic()
            assert left_s > 0, f"not in time; the last lines are {self.lines[-3:]}"
            ready, _, _ = select.select([self.process.stdout], [], [], left_s)
            data = os.read(self.process.stdout.fileno(), 65536) if ready else b""
            if not data and ready:
                raise AssertionError(f"it ended: {self.end()}")
            *whole, self._rest = (self._rest + data).split(b"\n")
            self.lines += [json.loads(line) for line in whole]

    def end(self) -> tuple[int, str]:
        """Wait for its end: exit code and what stands on stderr."""
        out, error = self.process.communicate(timeout=PATIENCE_S)
        self.lines += [json.loads(line) for line in (self._rest + (out or b"")).splitlines()]
        return self.process.returncode, error.decode()

    def close(self) -> None:
        """Kill it where it still runs."""
        if self.process.poll() is None:
            self.process.kill()
        with contextlib.suppress(ValueError):
            self.process.communicate()


@contextlib.contextmanager
def live(source: object, *arguments: object) -> Iterator[LiveCommand]:
    """The command over the landing's pad and camera; patient with a busy machine's decoder."""
    common = ("--pad", PAD, "--camera", CAMERA, "--late-ms", 600_000)
    command = LiveCommand(source, *common, *arguments)
    try:
        yield command
    finally:
        command.close()
