"""The autopilot's clock, from answers to TIMESYNC.

An answer says that the autopilot's clock showed r at some moment between t0, when the question was
sent, and t1, when the answer came. So the line that takes our time to the autopilot's lies below
all points (t0, r) and above all points (t1, r). Of all such lines the one is taken that keeps the
largest vertical distance from both sets: it gives the shortest way there and the shortest way back
the same length, whatever delays single packets had on either way. Its distance, half of the
shortest round trip, is the error that it has if the shortest ways are as unequal as can be.

References
----------
L. Zhang, Z. Liu and C. H. Xia, "Clock synchronization algorithms for network measurements", IEEE
INFOCOM 2002, doi:10.1109/INFCOM.2002.1019257 (lines between convex hulls, as a linear programme).
https://mavlink.io/en/services/timesync.html
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array

# Crystals are within 100 ppm; two of them, and some more for heat.
_MOST_DRIFT = 3e-4
# Answers are kept so long: by then drift has changed with temperature.
_WINDOW_S, _WINDOW_MOST = 120.0, 240
# What took longer says too little.
_MOST_ROUND_TRIP_S = 1.0
_LEAST_ANSWERS = 10
# Without answers for so long the clock is not known any more.
_STALE_S = 60.0
# Answers that contradict those before by more are of a clock that was set anew.
_SLACK_S = 2e-3
# Golden sections: the drift to 1e-4 of its range.
_SECTIONS = 24
_GOLDEN = (5**0.5 - 1) / 2


@dataclass(frozen=True)
class ClockState:
    """How well the autopilot's clock is known.

    Attributes
    ----------
    is_known : bool
    answers : int
        That it rests on.
    drift_ppm : float
        By how much the autopilot's clock goes faster than ours.
    error_s : float
        Half of the shortest round trip: the error if all of that was spent on one way.
    restarts : int
        How often it was begun anew, because the autopilot's clock had been.
    """

    is_known: bool = False
    answers: int = 0
    drift_ppm: float = 0.0
    error_s: float = 0.0
    restarts: int = 0


class AutopilotClock:
    """Takes times of `time.monotonic` to the autopilot's clock."""

    def __init__(self) -> None:
        self._answers: deque[tuple[float, int, float]] = deque(maxlen=_WINDOW_MOST)
        self._origin = (0.0, 0)
        self._line = (0.0, 0.0, 0.0)
        self._restarts = 0

    def take(self, sent_s: float, autopilot_ns: int, received_s: float) -> None:
        """An answer came.

        Parameters
        ----------
        sent_s, received_s : float
            Of the question and the answer, of `time.monotonic`.
        autopilot_ns : int
            What the autopilot's clock showed meanwhile.
        """
        if not 0 <= received_s - sent_s <= _MOST_ROUND_TRIP_S:
            return
        self._answers.append((sent_s, autopilot_ns, received_s))
        while received_s - self._answers[0][2] > _WINDOW_S:
            self._answers.popleft()
        if self._fit() < -_SLACK_S:
            self._answers = deque([(sent_s, autopilot_ns, received_s)], _WINDOW_MOST)
            self._restarts += 1
            self._fit()

    def at_ns(self, time_s: float) -> int | None:
        """What the autopilot's clock shows at a time of `time.monotonic`; None where unknown."""
        if not self._is_known(time_s):
            return None
        start_s, start_ns = self._origin
        offset, drift, _ = self._line
        since_s = time_s - start_s
        return start_ns + round((since_s + offset + drift * since_s) * 1e9)

    def state(self, now_s: float) -> ClockState:
        """How well it is known."""
        _, drift, margin = self._line
        return ClockState(
            self._is_known(now_s), len(self._answers), drift * 1e6, margin, self._restarts
        )

    def _is_known(self, time_s: float) -> bool:
        few = len(self._answers) < _LEAST_ANSWERS
        return not few and time_s - self._answers[-1][2] <= _STALE_S

    def _fit(self) -> float:
        """Fit the line; gives its distance from the points, s."""
        start_s, start_ns = self._origin = self._answers[-1][2], self._answers[-1][1]
        sent = np.array([answer[0] - start_s for answer in self._answers])
        received = np.array([answer[2] - start_s for answer in self._answers])
        shown = np.array([(answer[1] - start_ns) * 1e-9 for answer in self._answers])
        above, below = shown - sent, shown - received
        # The distance is a concave function of the drift: a minimum of lines less a maximum.
        low, high = -_MOST_DRIFT, _MOST_DRIFT
        for _ in range(_SECTIONS):
            step = _GOLDEN * (high - low)
            left, right = high - step, low + step
            if _margin(left, sent, above, received, below) < _margin(
                right, sent, above, received, below
            ):
                low = left
            else:
                high = right
        drift = (low + high) / 2
        margin = _margin(drift, sent, above, received, below)
        self._line = float(np.max(below - drift * received)) + margin, drift, margin
        return margin


def _margin(drift: float, sent: Array, above: Array, received: Array, below: Array) -> float:
    """Half of the room between both sets of points in the direction of a drift."""
    room = np.min(above - drift * sent) - np.max(below - drift * received)
    return float(room) / 2
