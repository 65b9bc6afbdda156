"""Sources of live frames that tests hand out one by one, and outputs that keep what they get."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable
from dataclasses import replace
from functools import cache

from dense_frames import frame_of, sample_pad, small_camera

from padstudio.arrays import Image
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.live.reports.frame import LiveFrame
from padstudio.live.reports.report import LiveReport
from padstudio.live.reports.source import StreamState
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render

FPS = 30.0


@cache
def still_view() -> tuple[Image, Pose]:
    """A frame that is read, and its pose."""
    pose = look_at_pad(700.0, tilt_deg=5, heading_deg=30)
    return frame_of(pose, camera=small_camera()), pose


@cache
def bare_ground() -> Image:
    """A frame without the pad."""
    return render(Scene(pad=None), small_camera(), look_at_pad(700.0)).image


def live_frame(number: int, picture: Image, connection: int = 0) -> LiveFrame:
    """A frame that has just come."""
    now_s = time.monotonic()
    return LiveFrame(number, picture, number / FPS, now_s - 0.004, now_s, connection=connection)


class HandedOut:
    """A `padstudio.live.reports.source.FrameSource` of given frames.

    Each is given when asked for; None stands for a wait in vain. Then it has ended.
    """

    def __init__(self, frames: Iterable[LiveFrame | StreamState | None]) -> None:
        self._frames = iter(frames)
        self._state = StreamState("open")

    @property
    def state(self) -> StreamState:
        return self._state

    def newest(self, timeout_s: float) -> LiveFrame | None:
        item = next(self._frames, StreamState("ended"))
        if isinstance(item, StreamState):
            self._state = item
            return None
        return item

    def close(self) -> None:
        self._state = replace(self._state, phase="ended")


class Kept:
    """An output, and one of events, that keeps all it gets, and the thread that called."""

    def __init__(self) -> None:
        self.reports: list[LiveReport] = []
        self.sights: list[tuple[str, str]] = []
        self.events: list[tuple[str, str, str]] = []
        self.threads: set[int] = set()
        self.is_closed = False

    def take(self, report: LiveReport) -> None:
        self.threads.add(threading.get_ident())
        self.reports.append(report)

    def sight_changed(self, sight: str, detail: str) -> None:
        self.sights.append((sight, detail))

    def stream_changed(self, kind: str, detail: str, code: str) -> None:
        self.events.append((kind, detail, code))

    def close(self) -> None:
        self.is_closed = True


__all__ = ["sample_pad", "small_camera"]
