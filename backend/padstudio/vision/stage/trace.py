"""Times stages and, when asked, keeps what they put out."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from padstudio.arrays import Image
from padstudio.pad.spec import Channel
from padstudio.vision.stage.detection import StageRecord, Trace

P = ParamSpec("P")
T = TypeVar("T")


class Recorder:
    """The clock and, for a trace, the memory of one frame's run.

    Parameters
    ----------
    keep : bool
        Keep every stage's output.
    """

    def __init__(self, *, keep: bool) -> None:
        self.keep = keep
        self._started = time.perf_counter()
        self._elapsed: dict[str, float] = defaultdict(float)
        self._records: list[StageRecord] = []

    def run(
        self,
        name: str,
        channel: Channel | None,
        stage: Callable[P, T],
        *args: P.args,
        **kwargs: P.kwargs,
    ) -> T:
        """Run a stage, time it, keep its output."""
        begin = time.perf_counter()
        output = stage(*args, **kwargs)
        elapsed = 1e3 * (time.perf_counter() - begin)
        self._elapsed[name] += elapsed
        self.note(name, channel, output, elapsed)
        return output

    def note(self, name: str, channel: Channel | None, output: object, elapsed: float = 0) -> None:
        """Keep an output that was made elsewhere."""
        if self.keep:
            self._records.append(StageRecord(name, channel, elapsed, output))

    def append(self, other: Recorder) -> None:
        """Keep another run's outputs behind one's own; its time does not count."""
        self._records.extend(other._records)

    def elapsed_ms(self) -> dict[str, float]:
        """Milliseconds per stage, and ``total`` since the recorder was made."""
        return {**self._elapsed, "total": 1e3 * (time.perf_counter() - self._started)}

    def trace(self, image: Image) -> Trace | None:
        """The trace, where one was asked for."""
        return Trace(image, tuple(self._records)) if self.keep else None
