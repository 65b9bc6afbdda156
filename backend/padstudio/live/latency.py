"""How long frames take from stage to stage, without keeping them all.

Of the last `WINDOW` frames percentiles are exact. Over all of them they are read from a histogram
whose bins are 2 % wide, so they are off by 1 % at the most; adding a frame costs a logarithm a
stage.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Any

import numpy as np

from padstudio.live.reports.report import LiveReport

#: So many frames make the sliding window: ten seconds at 30 a second.
WINDOW = 300
#: Stages in their order, and what each is. The first two need a stream that says when it captured.
STAGES = {
    "captured_to_arrived": "camera, encoder and link; only where the stream says when",
    "captured_to_sent": "all of it; only where the stream says when",
    "arrived_to_decoded": "decoder",
    "decoded_to_posed": "waiting for the frame before, and detector",
    "posed_to_sent": "outputs",
    "decoded_to_sent": "from decoded frame to message",
    "arrived_to_sent": "from the last packet to message",
}
# Bins of the histogram: from a microsecond on, each so much wider than the one before.
_LEAST_MS, _GROWTH, _BINS = 1e-3, 1.02, 1000
_LOG = math.log(_GROWTH)


class StageTimes:
    """One stage's times; for one thread at a time."""

    def __init__(self, window: int = WINDOW) -> None:
        self._recent: deque[float] = deque(maxlen=window)
        self._bins = np.zeros(_BINS, np.int64)
        self.count = 0

    def add(self, elapsed_ms: float) -> None:
        """Take a frame into account; a negative time, of clocks that disagree, counts as none."""
        elapsed_ms = max(elapsed_ms, 0.0)
        place = int(math.log(max(elapsed_ms, _LEAST_MS) / _LEAST_MS) / _LOG)
        self._bins[min(place, _BINS - 1)] += 1
        self._recent.append(elapsed_ms)
        self.count += 1

    def recent_ms(self, percent: float) -> float | None:
        """A percentile of the window; None of nothing."""
        # A copy, as another thread may ask.
        recent = list(self._recent)
        return float(np.percentile(recent, percent)) if recent else None

    def all_ms(self, percent: float) -> float | None:
        """A percentile of all frames, to 1 %; None of nothing."""
        sums = np.cumsum(self._bins)
        if not sums[-1]:
            return None
        place = int(np.searchsorted(sums, max(percent / 100 * sums[-1], 1)))
        return float(_LEAST_MS * _GROWTH ** (place + 0.5))


class LatencyMeter:
    """Every stage's times.

    Parameters
    ----------
    window : int
        Frames of the sliding window.
    """

    def __init__(self, window: int = WINDOW) -> None:
        self.stages = {name: StageTimes(window) for name in STAGES}

    def add(self, report: LiveReport, sent_s: float) -> None:
        """Take a frame into account.

        Parameters
        ----------
        report : LiveReport
        sent_s : float
            When every output had taken it, of `time.monotonic`.
        """
        frame = report.frame
        at = {
            "captured": frame.captured_s,
            "arrived": frame.arrived_s,
            "decoded": frame.decoded_s,
            "posed": report.posed_s,
            "sent": sent_s,
        }
        for name, times in self.stages.items():
            first, _, last = name.partition("_to_")
            begun, ended = at[first], at[last]
            if begun is not None and ended is not None:
                times.add(1000 * (ended - begun))

    def to_dict(self) -> dict[str, Any]:
        """Median and 95th percentile of the window and of all, ms; JSON-serialisable."""
        return {
            name: {
                "frames": times.count,
                "median_ms": _rounded(times.recent_ms(50)),
                "p95_ms": _rounded(times.recent_ms(95)),
                "all_median_ms": _rounded(times.all_ms(50)),
                "all_p95_ms": _rounded(times.all_ms(95)),
            }
            for name, times in self.stages.items()
            if times.count
        }


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 3)
