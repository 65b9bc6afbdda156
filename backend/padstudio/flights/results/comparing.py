"""Two runs of the same frames: which were won, lost, read by both but otherwise."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.flights.results.rows import Record
from padstudio.geometry.pose import rotation_angle_deg, rotation_from_quaternion

#: What became of a frame, from the first run to the second.
KINDS = ("neither", "both", "won", "lost")
_NEITHER, _BOTH, _WON, _LOST = range(4)


@dataclass(frozen=True, eq=False)
class RunColumns:
    """The frames of one run.

    Attributes
    ----------
    key : (N,) array
        What tells frames apart, each once.
    ok : (N,) bool
        With a pose.
    position_mm : (N, 3) float64
        Of the camera in the pad frame; NaN without a pose.
    """

    key: NDArray[Any]
    ok: NDArray[np.bool_]
    position_mm: Array


@dataclass(frozen=True, eq=False)
class Changes:
    """What a second run does otherwise than a first, on the frames that both read.

    Attributes
    ----------
    key : (N,) array
        Ascending.
    kind : (N,) int8
        Places in `KINDS`: won where the second alone has a pose.
    moved_mm : (N,) float64
        From one position to the other; NaN where not both have one.
    moved_share : (N,) float64
        Of the first one's distance from the pad's centre.
    only_first, only_second : int
        Frames that one run alone reads.
    """

    key: NDArray[Any]
    kind: NDArray[np.int8]
    moved_mm: Array
    moved_share: Array
    only_first: int
    only_second: int

    def summary(self) -> dict[str, Any]:
        """Counts, and how far poses moved; JSON-serialisable."""
        counts = np.bincount(self.kind, minlength=len(KINDS)).tolist()
        return {
            "frames": len(self.key),
            "only_first": self.only_first,
            "only_second": self.only_second,
            **dict(zip(KINDS, counts, strict=True)),
            "moved": self._moved(),
        }

    def _moved(self) -> dict[str, Any] | None:
        both = np.flatnonzero(self.kind == _BOTH)
        if not len(both):
            return None
        moved = self.moved_mm[both]
        worst = both[int(np.argmax(moved))]
        return {
            "median_mm": round(float(np.median(moved)), 4),
            "p95_mm": round(float(np.quantile(moved, 0.95)), 4),
            "worst_mm": round(float(self.moved_mm[worst]), 4),
            "worst_share": round(float(self.moved_share[worst]), 6),
            "worst_frame": self.key[worst].item(),
        }

    def columns(self, most: int) -> list[dict[str, Any]]:
        """The frames, keys of which are numbers, in at most so many columns, empty ones left out.

        Returns
        -------
        list of dict
            first_frame, last_frame, won, lost, both, neither, moved_max_mm (None without).
        """
        if not len(self.key):
            return []
        first, last = int(self.key[0]), int(self.key[-1])
        width = -(-(last - first + 1) // most)
        found = []
        for place in np.split(
            np.arange(len(self.key)), np.flatnonzero(np.diff((self.key - first) // width)) + 1
        ):
            counts = np.bincount(self.kind[place], minlength=len(KINDS)).tolist()
            moved = self.moved_mm[place][self.kind[place] == _BOTH]
            found.append(
                {
                    "first_frame": int(self.key[place[0]]),
                    "last_frame": int(self.key[place[-1]]),
                    **dict(zip(KINDS, counts, strict=True)),
                    "moved_max_mm": round(float(moved.max()), 4) if len(moved) else None,
                }
            )
        return found


def compare_runs(first: RunColumns, second: RunColumns) -> Changes:
    """Compare two runs frame by frame."""
    key, a, b = np.intersect1d(first.key, second.key, assume_unique=True, return_indices=True)
    was, now = first.ok[a], second.ok[b]
    kind = np.select([was & now, now, was], [_BOTH, _WON, _LOST], _NEITHER).astype(np.int8)
    moved = np.linalg.norm(second.position_mm[b] - first.position_mm[a], axis=-1)
    moved[kind != _BOTH] = np.nan
    away = np.linalg.norm(first.position_mm[a], axis=-1)
    share = np.divide(moved, away, out=np.full(len(key), np.nan), where=away > 0)
    return Changes(key, kind, moved, share, len(first.key) - len(key), len(second.key) - len(key))


def kind_of(first: Record, second: Record) -> str:
    """What became of one frame, of `KINDS`."""
    was, now = first["status"] == "ok", second["status"] == "ok"
    return KINDS[_BOTH if was and now else _WON if now else _LOST if was else _NEITHER]


def moved_between(first: Record, second: Record) -> dict[str, float | None]:
    """How far a pose moved: ``moved_mm``, ``moved_share``, ``turned_deg``; None without two."""
    if kind_of(first, second) != "both":
        return dict.fromkeys(("moved_mm", "moved_share", "turned_deg"))
    was, now = (np.array(record["position_mm"], float) for record in (first, second))
    moved, away = float(np.linalg.norm(now - was)), float(np.linalg.norm(was))
    turned = rotation_angle_deg(
        *(rotation_from_quaternion(record["quaternion_xyzw"]) for record in (first, second))
    )
    return {
        "moved_mm": round(moved, 4),
        "moved_share": round(moved / away, 6) if away else None,
        "turned_deg": round(float(turned), 4),
    }


def columns_of(records: Iterable[Record], key: Callable[[Record], str]) -> RunColumns:
    """A run's columns from its records; of several of one key the first with a pose counts."""
    found: dict[str, Array | None] = {}
    for record in records:
        name = key(record)
        if found.get(name) is None:
            is_ok = record["status"] == "ok"
            found[name] = np.array(record["position_mm"], float) if is_ok else None
    nowhere = np.full(3, np.nan)
    return RunColumns(
        np.array(list(found), dtype=str),
        np.array([place is not None for place in found.values()], dtype=bool),
        np.array([nowhere if place is None else place for place in found.values()]).reshape(-1, 3),
    )
