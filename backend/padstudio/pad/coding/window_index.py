"""Find windows in a field: which place, in which turn.

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
from padstudio.pad.spec import MAX_LEVELS, MAX_WINDOW

U64 = NDArray[np.uint64]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]

# Rows of windows keyed at a time, and windows looked up at a time: bounds the memory in use.
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
    """

    rows: I32
    cols: I32
    turns: I32


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
        self._down, self._across = _weights(window, levels)
        self._across_count = field.shape[1] - window + 1
        marks = np.concatenate(
            [
                _mark(self._strip_keys(field[top : top + _STRIP + window - 1]))
                for top in range(0, field.shape[0] - window + 1, _STRIP)
            ]
        )
        order = np.argsort(marks)
        self._places = order.astype(np.int32)
        self._marks = marks[order]
        self._longest = _longest_run(self._marks)

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
        read = self._checked(windows)
        known = np.all((read >= 0) & (read < self.levels), axis=(1, 2))
        found = _Found(len(read))
        for first in range(0, len(read), _BATCH):
            numbers = first + np.flatnonzero(known[first : first + _BATCH])
            self._search(read[numbers].astype(np.uint8), numbers, found)
        return found.answer(self._across_count)

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

    def _search(self, read: NDArray[np.uint8], numbers: I64, found: _Found) -> None:
        """Look for windows (N, b, b) of known cells, and enter where they are."""
        flat = read.reshape(-1, self.window**2).astype(np.uint64)
        turned = (np.outer(*self._turn_weights(turn)) for turn in range(self.turns))
        marks = _mark(np.min([flat @ weights.ravel() for weights in turned], axis=0))
        at = np.searchsorted(self._marks, marks)
        for step in range(self._longest):
            slot = np.minimum(at + step, len(self._marks) - 1)
            hit = np.flatnonzero(self._marks[slot] == marks)
            if not len(hit):
                break
            self._enter(read[hit], self._places[slot[hit]], numbers[hit], found)

    def _enter(self, seen: NDArray[np.uint8], places: I32, numbers: I64, found: _Found) -> None:
        """Compare windows with the field cell by cell, and enter the equal ones."""
        row, col = np.divmod(places, self._across_count)
        span = np.arange(self.window)
        held = self.field[
            row[:, None, None] + span[None, :, None], col[:, None, None] + span[None, None, :]
        ]
        for turn in range(self.turns):
            equal = (np.rot90(seen, turn, (1, 2)) == held).all((1, 2))
            found.enter(numbers[equal], places[equal], turn)


class _Found:
    """The place of each window so far."""

    def __init__(self, count: int) -> None:
        self._places = np.full(count, -1, np.int64)
        self._turns = np.full(count, -1, np.int64)
        self._doubtful = np.zeros(count, bool)

    def enter(self, numbers: I64, places: I32, turn: int) -> None:
        """Enter places of windows (each at most once); a second place leaves doubt."""
        other = (self._places[numbers] != places) | (self._turns[numbers] != turn)
        self._doubtful[numbers[other & (self._places[numbers] >= 0)]] = True
        self._places[numbers], self._turns[numbers] = places, turn

    def answer(self, across: int) -> Places:
        """The places in rows and columns; -1 where none or in doubt."""
        lost = self._doubtful | (self._places < 0)
        rows, cols = np.divmod(self._places, across)
        return Places(*(np.where(lost, -1, a).astype(np.int32) for a in (rows, cols, self._turns)))


def _weights(b: int, levels: int) -> tuple[U64, U64]:
    """Weights of a window's rows and columns; their products weigh its cells."""
    if levels ** (b * b) <= 2**64:
        powers = [levels**k for k in range(b - 1, -1, -1)]
        return np.array([p**b for p in powers], np.uint64), np.array(powers, np.uint64)
    # Odd numbers keep every bit of a level; any fixed random ones do.
    words = np.random.SeedSequence(0).generate_state(2 * b, np.uint64) | np.uint64(1)
    return words[:b], words[b:]


def _mark(keys: U64) -> NDArray[np.uint32]:
    """32 well-mixed bits of keys."""
    mixed = (keys ^ (keys >> np.uint64(31))) * np.uint64(0x9E3779B97F4A7C15)
    mixed = (mixed ^ (mixed >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    return (mixed >> np.uint64(32)).astype(np.uint32)


def _longest_run(ordered: NDArray[np.uint32]) -> int:
    """Length of the longest run of equal numbers."""
    ends = np.flatnonzero(np.diff(ordered, append=ordered[-1] + np.uint32(1)))
    return int(np.diff(ends, prepend=-1).max())
