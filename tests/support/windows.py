"""The truth about a field's windows, by comparing each with each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def all_windows(field: NDArray[np.uint8], window: int) -> NDArray[np.uint8]:
    """(N, b, b), in reading order."""
    views = np.lib.stride_tricks.sliding_window_view(field, (window, window))
    return views.reshape(-1, window, window)


def nearest_distances(
    field: NDArray[np.uint8], window: int, *, rotation: bool
) -> NDArray[np.int64]:
    """(N,) cells in which each window differs from the nearest other, or from itself turned."""
    upright = all_windows(field, window)
    count = len(upright)
    nearest = np.full(count, window * window + 1)
    for turn in range(4 if rotation else 1):
        turned = np.rot90(upright, turn, (1, 2)).reshape(count, -1)
        differing = (upright.reshape(count, 1, -1) != turned[None]).sum(2)
        if turn == 0:
            np.fill_diagonal(differing, window * window + 1)
        nearest = np.minimum(nearest, differing.min(1))
    return nearest


def all_differ(field: NDArray[np.uint8], window: int, *, rotation: bool) -> bool:
    """Whether no two windows, nor one and itself turned, are equal: quicker than distances."""
    upright = all_windows(field, window)
    turned = [np.rot90(upright, turn, (1, 2)) for turn in range(4 if rotation else 1)]
    every = np.concatenate(turned).reshape(len(turned) * len(upright), -1)
    return len(np.unique(every, axis=0)) == len(every)


def lines_visible(field: NDArray[np.uint8], window: int) -> bool:
    """Whether every window has a level change across each of its inner grid lines."""
    windows = all_windows(field, window).astype(int)
    down = (np.diff(windows, axis=1) != 0).any(2).all()
    across = (np.diff(windows, axis=2) != 0).any(1).all()
    return bool(down and across)


def least_apart(one: NDArray[np.uint8], other: NDArray[np.uint8], window: int) -> int:
    """Least number of cells in which a window of one field differs from one of another turned."""
    upright = all_windows(one, window).reshape(-1, 1, window * window)
    turned = [np.rot90(all_windows(other, window), turn, (1, 2)) for turn in range(4)]
    return min(int((upright != t.reshape(1, -1, window**2)).sum(2).min()) for t in turned)
