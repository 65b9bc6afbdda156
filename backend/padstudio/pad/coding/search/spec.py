"""What is asked of a field of levels, and the watch over a search for one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import monotonic
from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import SearchCancelledError, SearchExhaustedError, SpecError, shown
from padstudio.pad.spec import MAX_CELLS, MAX_LEVELS, MAX_WINDOW

Unique = Literal["rotation", "plain"]
Method = Literal["auto", "growth"]
# Fields (rows, cols) of levels whose windows another must not repeat.
Fields = Sequence[NDArray[np.uint8]]


class Rules(NamedTuple):
    """What the windows of a field must keep to, for compiled loops.

    Attributes
    ----------
    window, levels, distance : int
        b, Y and the least distance.
    turns : int
        In how many turns windows must differ: 4 or 1.
    visible_lines : bool
    """

    window: int
    levels: int
    distance: int
    turns: int
    visible_lines: bool


@dataclass(frozen=True, kw_only=True)
class FieldSpec:
    """A field to be generated.

    Attributes
    ----------
    rows, cols : int
        Cells down and across, at least ``window``.
    window : int
        b: the property holds for all b × b windows.
    levels : int
        Y: cells take levels 0 … Y−1.
    unique : {"rotation", "plain"}
        "rotation": no window equals another in any turn, nor itself turned. "plain": no window
        equals another as the page stands.
    distance : int
        Least number of cells in which any two windows differ (in any turn for "rotation", a window
        and itself turned included). 1 is mere uniqueness; 3 lets one misread cell be corrected.
    visible_lines : bool
        Every window has a level change across each of its inner grid lines.
    method : {"auto", "growth"}
        "growth" follows the paper step by step; "auto" takes what reaches farthest.
    seed : int
        Same spec and seed give the same field, on every platform.

    Raises
    ------
    SpecError
        Where a value is out of its range; whether the field can exist is for
        `padstudio.pad.coding.search.bounds`.
    """

    rows: int = 125
    cols: int = 125
    window: int = 5
    levels: int = 2
    unique: Unique = "rotation"
    distance: int = 3
    visible_lines: bool = False
    method: Method = "auto"
    seed: int = 1

    def __post_init__(self) -> None:
        for name, low, high in (
            ("window", 2, MAX_WINDOW),
            ("levels", 2, MAX_LEVELS),
            ("rows", self.window, MAX_FIELD_CELLS),
            ("cols", self.window, MAX_FIELD_CELLS),
            ("distance", 1, self.window**2),
            ("seed", 0, 2**63 - 1),
        ):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int | np.integer):
                raise SpecError(f"{name} is {shown(value)}; it must be a whole number")
            if not low <= value <= high:
                raise SpecError(
                    f"{name} is {value}; it must be {low} … {high}", detail={"field": name}
                )
        for name, choices in (("unique", get_args(Unique)), ("method", get_args(Method))):
            if getattr(self, name) not in choices:
                raise SpecError(
                    f"{name} is {shown(getattr(self, name))}; it must be {' or '.join(choices)}",
                    detail={"field": name},
                )

    @property
    def turns(self) -> int:
        """In how many turns windows must differ: 4 or 1."""
        return 4 if self.unique == "rotation" else 1

    @property
    def cells_in_words(self) -> str:
        """The cells of all fields that the spec asks for, for messages."""
        return f"{self.rows} x {self.cols} cells"

    @property
    def last_resort(self) -> str:
        """What does where only one field finds room, as the end of a sentence; else nothing."""
        return ""

    @property
    def rules(self) -> Rules:
        """What compiled loops need to know of the spec."""
        return Rules(self.window, self.levels, self.distance, self.turns, self.visible_lines)

    @property
    def windows(self) -> int:
        """Number of windows of the field."""
        return _windows(self.rows, self.cols, self.window)

    def windows_needed(self, rows: int, cols: int) -> int:
        """How many windows must differ, were the field of so many rows and columns."""
        return _windows(rows, cols, self.window)


# A field may be larger than the layers that a pad file holds.
MAX_FIELD_CELLS = 2 * MAX_CELLS


def _windows(rows: int, cols: int, b: int) -> int:
    return max(0, rows - b + 1) * max(0, cols - b + 1)


class Watch:
    """The time budget, progress and cancelling of a search.

    Parameters
    ----------
    budget_s : float
        Wall time after which `spent` is true.
    progress : callable, optional
        Called with the share done, 0 … 1; it may fall back where a search starts again.
    cancel : callable, optional
        Asked from time to time; the search ends once it answers true.
    """

    def __init__(
        self,
        budget_s: float,
        progress: Callable[[float], None] | None = None,
        cancel: Callable[[], bool] | None = None,
    ) -> None:
        self._start = monotonic()
        self._budget_s = budget_s
        self._progress = progress
        self._cancel = cancel

    def spent(self, done: float) -> bool:
        """Report the share done; whether the budget is spent.

        Raises
        ------
        SearchCancelledError
            Once ``cancel`` answers true.
        """
        if self._cancel is not None and self._cancel():
            raise SearchCancelledError("the search was cancelled")
        if self._progress is not None:
            self._progress(min(max(done, 0.0), 1.0))
        return self.elapsed_s > self._budget_s

    def unseen(self) -> Watch:
        """The same budget and cancelling, without progress: of a search that is a small part."""
        other = Watch(self._budget_s, None, self._cancel)
        other._start = self._start
        return other

    @property
    def elapsed_s(self) -> float:
        """Wall time since the search began, s."""
        return monotonic() - self._start


class FieldSearchError(SearchExhaustedError):
    """No field of the size asked for was found in time.

    Attributes
    ----------
    field : (rows, cols) uint8 or None
        The largest field reached, verified; None where none of a window's size was.
    """

    def __init__(self, message: str, field: NDArray[np.uint8] | None) -> None:
        rows, cols = (0, 0) if field is None else field.shape
        super().__init__(message, detail={"rows": rows, "cols": cols})
        self.field = field
