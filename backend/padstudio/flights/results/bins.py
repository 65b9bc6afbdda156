"""Frames summed up by the hundred, so that figures over a million of them are read at once.

Bins are made when a chunk is finished, from its frames alone: a bin that two chunks share stands
in the table as two parts, and whoever reads bins adds parts up.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Any

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from padstudio.store.database.flight_tables import FlightRow, FrameBinRow, FrameRow

#: Frames of a whole bin.
BIN_FRAMES = 100
# Bins that are fetched from the database at once.
_AT_ONCE = 100

Row = dict[str, Any]


@dataclass(frozen=True)
class Grid:
    """Where the bins of a flight begin: at ``origin`` and every ``width`` frame numbers on."""

    origin: int
    width: int

    def start_of(self, number: int) -> int:
        """The first number of the bin that a frame belongs to."""
        return number - (number - self.origin) % self.width


def grid_of(request: Mapping[str, Any]) -> Grid:
    """The bins of a flight's request: of `BIN_FRAMES` frames each, whatever the stride."""
    return Grid(int(request.get("first_frame", 0)), BIN_FRAMES * int(request.get("stride", 1)))


def bins_of(
    frames: Sequence[Mapping[str, Any]],
    request: Mapping[str, Any],
    damaged: Collection[int] = frozenset(),
) -> Iterator[Row]:
    """Rows of the table ``frame_bins``.

    Parameters
    ----------
    frames : sequence of mapping
        Rows of the table ``frames`` of one flight, ascending by number.
    request : mapping
        The flight's.
    damaged : collection of int
        Numbers of the frames of which the decoder made up a part.
    """
    grid = grid_of(request)
    for _, some in groupby(frames, key=lambda frame: grid.start_of(frame["number"])):
        yield _sum_up(list(some), damaged)


def _sum_up(frames: Sequence[Mapping[str, Any]], damaged: Collection[int]) -> Row:
    poses = [frame["number"] for frame in frames if frame["status"] == "ok"]
    heights = [frame["z_mm"] for frame in frames if frame["z_mm"] is not None]
    gap = max(pairwise(poses), key=lambda pair: pair[1] - pair[0], default=None)
    counts = {
        f"{name}s": Counter(frame[name] for frame in frames if frame[name] is not None)
        for name in ("layer", "stage", "reason")
    }
    return {
        "flight": frames[0]["flight"],
        "first_frame": frames[0]["number"],
        "last_frame": frames[-1]["number"],
        "frames": len(frames),
        "ok": len(poses),
        "time_s": frames[0]["time_s"],
        "z_min_mm": min(heights, default=None),
        "z_max_mm": max(heights, default=None),
        "body": {
            **counts,
            "poses": [poses[0], *(gap or ()), poses[-1]] if poses else [],
            "damaged": sum(frame["number"] in damaged for frame in frames),
            "bearings": Counter(f["layer"] for f in frames if f.get("quality") == "bearing"),
            "unknown": sum(f["status"] == "ok" and f.get("quality") is None for f in frames),
        },
    }


def sum_up_again(session: Session, flight: int, first: int, last: int) -> None:
    """Bring bins up to date whose frames, from `first` to `last`, have changed.

    How many of them are damaged does not change.
    """
    mine = FrameBinRow.flight == flight
    parts = session.execute(
        select(FrameBinRow.first_frame, FrameBinRow.last_frame, FrameBinRow.body).where(
            mine, FrameBinRow.first_frame <= last, FrameBinRow.last_frame >= first
        )
    ).all()
    for part in parts:
        rows = session.execute(
            select(*FrameRow.__table__.c)
            .where(
                FrameRow.flight == flight,
                FrameRow.number.between(part.first_frame, part.last_frame),
            )
            .order_by(FrameRow.number)
        )
        found = _sum_up([dict(row) for row in rows.mappings()], frozenset())
        found["body"]["damaged"] = part.body["damaged"]
        session.execute(
            update(FrameBinRow).where(mine, FrameBinRow.first_frame == part.first_frame),
            {key: found[key] for key in ("z_min_mm", "z_max_mm", "body")},
        )


def read_bins(
    session: Session, flight: FlightRow, first: int | None = None, last: int | None = None
) -> Iterator[Any]:
    """The bins of a flight in order, or those that begin from `first` to `last`.

    Yields
    ------
    row
        With the columns of `FrameBinRow`. Whoever keeps ten thousand of them has Python's garbage
        collector walk through all that they hold, which takes as long as to read them.
    """
    chosen = select(*FrameBinRow.__table__.c).where(FrameBinRow.flight == flight.key)
    if first is not None:
        chosen = chosen.where(FrameBinRow.first_frame >= first)
    if last is not None:
        chosen = chosen.where(FrameBinRow.first_frame <= last)
    chosen = chosen.order_by(FrameBinRow.first_frame).execution_options(yield_per=_AT_ONCE)
    yield from session.execute(chosen)


def add_up(total: dict[str, int], counts: Mapping[str, int]) -> None:
    """Add frames by ``layers``, ``stages`` or the like of a bin's body to those of others."""
    # A counter's own update takes three times as long for the few keys of a bin.
    for key, count in counts.items():
        total[key] = total.get(key, 0) + count


def pose_gaps(bins: Iterable[Sequence[int]]) -> Iterator[tuple[int | None, int | None]]:
    """Numbers of successive poses, of each bin only those farthest apart.

    Parameters
    ----------
    bins : iterable of sequence of int
        ``poses`` of successive bins.

    Yields
    ------
    (before, after)
        None before the first pose and after the last one.
    """
    last: int | None = None
    for poses in bins:
        if poses:
            first, *inner, end = poses
            yield last, first
            if inner:
                yield inner[0], inner[1]
            last = end
    yield last, None
