"""Whether the pad is in view, said once each time that changes.

One frame without a pose is no loss, and one with a pose, after a loss, is no return: the pad is
lost after `SightOptions.lost_after` frames in a row without one, and found after
`SightOptions.found_after` with one. A stream that gives nothing is lost whatever its last frames
showed.
"""

from __future__ import annotations

from dataclasses import dataclass

from padstudio.live.reports.report import Sight


@dataclass(frozen=True, kw_only=True)
class SightOptions:
    """When a sight counts as changed.

    Attributes
    ----------
    found_after, lost_after : int
        So many frames in a row with a pose, or without one.
    silent_s : float
        No frame for so long is a lost stream.
    """

    found_after: int = 2
    lost_after: int = 5
    silent_s: float = 1.0


@dataclass(frozen=True)
class SightChange:
    """What is in view from now on, and why."""

    sight: Sight
    detail: str


class SightKeeper:
    """Counts frames; for one thread."""

    def __init__(self, options: SightOptions) -> None:
        self._options = options
        self.sight: Sight | None = None
        self._with_pose = self._without = 0

    def saw(self, has_pose: bool, reason: str = "") -> SightChange | None:
        """Take a frame into account; the change, where there is one.

        Parameters
        ----------
        has_pose : bool
        reason : str
            Why it has none.
        """
        if has_pose:
            self._with_pose, self._without = self._with_pose + 1, 0
            if self._with_pose >= self._options.found_after:
                return self._change("found", "the pad is in view")
            return None
        self._with_pose, self._without = 0, self._without + 1
        if self._without >= self._options.lost_after:
            why = f": {reason}" if reason else ""
            return self._change("lost", f"{self._without} frames without a pose{why}")
        return None

    def heard_nothing(self, detail: str) -> SightChange | None:
        """No frames come; the change, where there is one."""
        self._with_pose = self._without = 0
        return self._change("no_stream", detail)

    def _change(self, sight: Sight, detail: str) -> SightChange | None:
        if sight == self.sight:
            return None
        self.sight = sight
        return SightChange(sight, detail)
