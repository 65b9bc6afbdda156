"""Where the vehicle was in the last seconds, as its autopilot streams it.

Positions and attitudes come apart and at rates of their own; each is taken between its neighbours
in time. Times are the autopilot's, since its boot; frames as in `padstudio.autopilot.vehicle`.
"""

from __future__ import annotations

from collections import deque
from typing import Literal

import numpy as np

from padstudio.arrays import Array
from padstudio.autopilot.vehicle import MAX_GAP_S, attitude_between

# More than ten seconds at the 250 a second of a fast link.
_KEPT = 3000
#: Why the vehicle's pose is not known: a later sample is still to come; it will never be.
Unknown = Literal["not_yet", "never"]


class RecentTrack:
    """Positions and attitudes of the last seconds."""

    def __init__(self) -> None:
        self._positions = _Samples()
        self._attitudes = _Samples()

    def position(self, time_s: float, position_m: Array) -> None:
        """A position (3,) in the local frame."""
        self._positions.add(time_s, position_m)

    def attitude(self, time_s: float, quaternion_wxyz: Array) -> None:
        """An attitude: a quaternion (4,) that takes body vectors to local vectors."""
        norm = float(np.linalg.norm(quaternion_wxyz))
        if 0.5 < norm < 2:
            self._attitudes.add(time_s, quaternion_wxyz / norm)

    @property
    def newest_s(self) -> tuple[float | None, float | None]:
        """Times of the newest position and of the newest attitude."""
        return self._positions.newest_s, self._attitudes.newest_s

    def at(self, time_s: float) -> tuple[Array, Array] | Unknown:
        """Position (3,) m and rotation (3, 3) local from body at a time, or why there is none."""
        places, turns = self._positions.about(time_s), self._attitudes.about(time_s)
        if isinstance(places, str) or isinstance(turns, str):
            return "never" if "never" in (places, turns) else "not_yet"
        before, after, share = places
        position = (1 - share) * before + share * after
        return position, attitude_between(*turns)


class _Samples:
    """Values in the order of their times."""

    def __init__(self) -> None:
        self._kept: deque[tuple[float, Array]] = deque(maxlen=_KEPT)

    @property
    def newest_s(self) -> float | None:
        return self._kept[-1][0] if self._kept else None

    def add(self, time_s: float, value: Array) -> None:
        if not np.isfinite(value).all():
            return
        newest_s = self.newest_s
        if newest_s is not None and time_s <= newest_s:
            if newest_s - time_s < 1.0:
                return
            # The autopilot has begun anew.
            self._kept.clear()
        self._kept.append((time_s, value))

    def about(self, time_s: float) -> tuple[Array, Array, float] | Unknown:
        """The values before and after a time, and its share of the way between them."""
        if not self._kept:
            return "never"
        later: tuple[float, Array] | None = None
        for sample in reversed(self._kept):
            if sample[0] == time_s:
                return sample[1], sample[1], 0.0
            if sample[0] < time_s:
                if later is None:
                    return "not_yet" if time_s - sample[0] <= MAX_GAP_S else "never"
                gap_s = later[0] - sample[0]
                if gap_s > MAX_GAP_S:
                    return "never"
                return sample[1], later[1], (time_s - sample[0]) / gap_s
            later = sample
        return "never"
