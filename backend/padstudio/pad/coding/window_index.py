"""Find windows in a field: which place, in which turn, exact and with some misread cells.

A window's key is a weighted sum of its levels modulo 2^64: its base-Y number where that fits,
else a hash. The least key of the four turns is the same however the window was seen; 32 mixed bits
of it are kept sorted beside the place, 8 bytes a window. Whatever the bits find is compared with
the field cell by cell, so that an answer is never a chance hit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import SpecError
from padstudio.pad.coding.window_keys import (
    U64,
    every_change,
    longest_run,
    mark,
    weights,
)
from padstudio.pad.spec import MAX_LEVELS, MAX_WINDOW

I32 = NDArray[np.int32]
I64 = NDArray[np.int64]

# Rows of windows keyed at a time, and windows varied at a time: bounds the memory in use.
_STRIP = 256
_BATCH = 1 << 20


@dataclass(frozen=True, eq=False)
class Places:
    """Where windows are.

    Attributes
    ----------
    rows, cols : (N,) int32
        Top left cell in the field; -1 where the window was not found, or at several places.
    turns : (N,) int32
        ``numpy.rot90(read, turn)`` is what the field holds there; -1 where not found.
    distances : (N,) int32
        Known cells in which it differs from the field; -1 where not found.
    """

    rows: I32
    cols: I32
    turns: I32
    distances: I32


@dataclass(frozen=True, eq=False)
class Votes:
    """Where a whole patch of read cells may lie, most votes first.

    Attributes
    ----------
    rows, cols : (N,) int32
        Where the top left cell of ``numpy.rot90(patch, turn)`` lies in the field; may be outside.
    turns, counts : (N,) int32
        The turn, and how many windows of the patch vote for it.
    """

    rows: I32
    cols: I32
    turns: I32
    counts: I32


class WindowIndex:
    """An index of all b × b windows of a field.

    Parameters
    ----------
    field : (rows, cols) uint8
    window, levels : int
        b and Y.
    rotation : bool
        Whether windows are looked for in all four turns, or as the page stands only.

    Raises
    ------
    SpecError
        If the field holds no window, or a level that is not below ``levels``.
    """

    def __init__(
        self, field: NDArray[np.uint8], window: int, levels: int, *, rotation: bool = True
    ) -> None:
        field = np.ascontiguousarray(field, np.uint8)
        if not 2 <= window <= MAX_WINDOW or not 2 <= levels <= MAX_LEVELS:
            raise SpecError(f"window {window} or levels {levels} is out of range")
        if field.ndim != 2 or min(field.shape) < window:
            raise SpecError(f"a field of {field.shape} cells holds no {window} x {window} window")
        if int(field.max()) >= levels:
            raise SpecError(f"the field holds level {field.max()}, not below levels = {levels}")
        self.field = field
        self.window = window
        self.levels = levels
        self.turns = 4 if rotation else 1
        self._down, self._across = weights(window, levels)
        self._across_count = field.shape[1] - window + 1
        marks = np.concatenate(
            [
                mark(self._strip_keys(field[top : top + _STRIP + window - 1]))
                for top in range(0, field.shape[0] - window + 1, _STRIP)
            ]
        )
        order = np.argsort(marks)
        self._places = order.astype(np.int32)
        self._marks = marks[order]
        self._longest = longest_run(self._marks)

    @property
    def nbytes(self) -> int:
        """Memory of the index without the field, bytes."""
        return self._marks.nbytes + self._places.nbytes

    def lookup(self, windows: NDArray[Any]) -> Places:
        """Find windows exactly.

        Parameters
        ----------
        windows : (N, b, b) integers
            Read levels; a window with a cell outside 0 … Y−1 (-1 for unknown) is not found.

        Returns
        -------
        Places
        """
        return self.lookup_near(windows, errors=0)

    def lookup_near(self, windows: NDArray[Any], *, errors: int = 1) -> Places:
        """Find windows of which some cells may be misread or unknown.

        Parameters
        ----------
        windows : (N, b, b) integers
            Read levels; -1 for an unknown cell, which counts as one of the errors.
        errors : int
            Most cells that may differ. A field of distance d answers rightly up to (d − 1) / 2.

        Returns
        -------
        Places
            The nearest place; not found where two are equally near.
        """
        read = self._checked(windows)
        unknown = (read < 0) | (read >= self.levels)
        filled = np.where(unknown, 0, read).astype(np.uint8)
        missing = unknown.sum((1, 2))
        found = _Found(len(read))
        open_ = np.flatnonzero(missing <= errors)
        for changes in range(errors + 1):
            batch = max(1, _BATCH // self._variants(changes))
            for first in range(0, len(open_), batch):
                numbers = open_[first : first + batch]
                self._search(filled[numbers], unknown[numbers], numbers, changes, found)
            # Unknown cells were filled with one level: the other levels are changes as well.
            open_ = open_[(found.places[open_] < 0) | (missing[open_] > changes)]
        return found.answer(self._across_count)

    def votes(self, patch: NDArray[Any], *, errors: int = 0) -> Votes:
        """Where a patch of read cells may lie: every window of it votes.

        Parameters
        ----------
        patch : (R, C) integers
            Read levels; -1 for unknown cells. A patch smaller than a window gets no votes.
        errors : int
            Misread or unknown cells allowed in a window; see `lookup_near`.
        """
        b = self.window
        patch = np.asarray(patch)
        if patch.ndim != 2 or min(patch.shape) < b:
            return Votes(*(np.zeros(0, np.int32) for _ in range(4)))
        views = np.lib.stride_tricks.sliding_window_view(patch, (b, b))
        i, j = (x.ravel() for x in np.indices(views.shape[:2]))
        places = self.lookup_near(views.reshape(-1, b, b), errors=errors)
        hit = places.turns >= 0
        i, j, turns = i[hit], j[hit], places.turns[hit]
        i_end, j_end = patch.shape[0] - b - i, patch.shape[1] - b - j
        row = places.rows[hit] - np.choose(turns, [i, j_end, i_end, j])
        col = places.cols[hit] - np.choose(turns, [j, i, j_end, i_end])
        votes, counts = np.unique(np.stack([row, col, turns]), axis=1, return_counts=True)
        order = np.argsort(-counts, kind="stable")
        row, col, turns = votes[:, order].astype(np.int32)
        return Votes(row, col, turns, counts[order].astype(np.int32))

    def _checked(self, windows: NDArray[Any]) -> NDArray[np.int64]:
        read = np.asarray(windows)
        if read.ndim != 3 or read.shape[1:] != (self.window, self.window):
            raise SpecError(
                f"windows has shape {read.shape}; it must be (N, {self.window}, {self.window})"
            )
        return read.astype(np.int64)

    def _turn_weights(self, turn: int) -> tuple[U64, U64]:
        """Weights of rows and of columns under which a window has the key of it turned."""
        down, across = self._down, self._across
        return (
            (down, across),
            (across, down[::-1]),
            (down[::-1], across[::-1]),
            (across[::-1], down),
        )[turn]

    def _strip_keys(self, strip: NDArray[np.uint8]) -> U64:
        """Least keys over the turns of all windows of some rows, in reading order."""
        b = self.window
        height, width = strip.shape[0] - b + 1, strip.shape[1] - b + 1
        levels = strip.astype(np.uint64)
        least = np.full((height, width), np.iinfo(np.uint64).max, np.uint64)
        for turn in range(self.turns):
            down, across = self._turn_weights(turn)
            lines = sum(levels[:, j : j + width] * across[j] for j in range(b))
            np.minimum(least, sum(lines[i : i + height] * down[i] for i in range(b)), out=least)
        return least.ravel()

    def _variants(self, changes: int) -> int:
        count = 1
        for k in range(changes):
            count = count * (self.window**2 - k) // (k + 1)
        return int(count * (self.levels - 1) ** changes)

    def _search(
        self,
        read: NDArray[np.uint8],
        unknown: NDArray[np.bool_],
        numbers: I64,
        changes: int,
        found: _Found,
    ) -> None:
        """Look for windows with exactly so many cells changed."""
        turned = [np.outer(*self._turn_weights(turn)) for turn in range(self.turns)]
        flat = read.reshape(len(read), -1).astype(np.uint64)
        keys = np.stack([flat @ w.ravel() for w in turned])
        for cells, shifts in every_change(self.window**2, self.levels, changes):
            levels = (flat[:, cells] + shifts) % np.uint64(self.levels)
            varied = np.stack(
                [
                    key + ((levels - flat[:, cells]) * w.ravel()[cells]).sum(1, dtype=np.uint64)
                    for key, w in zip(keys, turned, strict=True)
                ]
            )
            marks = mark(varied.min(0))
            at = np.searchsorted(self._marks, marks)
            for step in range(self._longest):
                slot = np.minimum(at + step, len(self._marks) - 1)
                hit = np.flatnonzero(self._marks[slot] == marks)
                if not len(hit):
                    break
                seen = read[hit].copy().reshape(len(hit), -1)
                seen[:, cells] = levels[hit]
                wrong = changes - (unknown[hit].reshape(len(hit), -1)[:, cells]).sum(1)
                place = self._places[slot[hit]]
                self._enter(seen.reshape(-1, *read.shape[1:]), place, wrong, numbers[hit], found)

    def _enter(
        self, seen: NDArray[np.uint8], places: I32, wrong: I64, numbers: I64, found: _Found
    ) -> None:
        """Compare windows with the field cell by cell, and enter the equal ones."""
        row, col = np.divmod(places, self._across_count)
        span = np.arange(self.window)
        held = self.field[
            row[:, None, None] + span[None, :, None], col[:, None, None] + span[None, None, :]
        ]
        for turn in range(self.turns):
            equal = (np.rot90(seen, turn, (1, 2)) == held).all((1, 2))
            found.enter(numbers[equal], places[equal], turn, wrong[equal])


class _Found:
    """The nearest place of each window so far."""

    def __init__(self, count: int) -> None:
        self.places = np.full(count, -1, np.int64)
        self._turns = np.full(count, -1, np.int64)
        self._distances = np.full(count, np.iinfo(np.int64).max)
        self._doubtful = np.zeros(count, bool)

    def enter(self, numbers: I64, places: I32, turn: int, distances: I64) -> None:
        """Enter places of windows (each at most once); equally near ones leave doubt."""
        other = (self.places[numbers] != places) | (self._turns[numbers] != turn)
        self._doubtful[numbers[other & (distances == self._distances[numbers])]] = True
        nearer = distances < self._distances[numbers]
        at = numbers[nearer]
        self.places[at], self._turns[at] = places[nearer], turn
        self._distances[at], self._doubtful[at] = distances[nearer], False

    def answer(self, across: int) -> Places:
        """The places in rows and columns; -1 where none or in doubt."""
        lost = self._doubtful | (self.places < 0)
        rows, cols = np.divmod(self.places, across)
        columns = (rows, cols, self._turns, self._distances)
        return Places(*(np.where(lost, -1, a).astype(np.int32) for a in columns))
