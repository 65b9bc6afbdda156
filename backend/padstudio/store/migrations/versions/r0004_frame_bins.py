"""Frames summed up by the hundred, also those of flights that were analysed before."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import groupby, pairwise
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

_flights = sa.table("flights", sa.column("key"), sa.column("request", sa.JSON))
_FRAME = ("flight", "number", "time_s", "status", "stage", "reason", "layer", "z_mm")
_frames = sa.table("frames", *map(sa.column, _FRAME))
_details = sa.table(
    "frame_details", sa.column("flight"), sa.column("number"), sa.column("body", sa.JSON)
)
# Frames at a time.
_READ_ROWS = 10_000
# Frames of a whole bin.
_BIN_FRAMES = 100


def upgrade() -> None:
    bins = op.create_table(
        "frame_bins",
        sa.Column(
            "flight",
            sa.BigInteger,
            sa.ForeignKey("flights.key", ondelete="CASCADE"),
            primary_key=True,
        ),
        sa.Column("first_frame", sa.Integer, primary_key=True),
        sa.Column("last_frame", sa.Integer, nullable=False),
        sa.Column("frames", sa.Integer, nullable=False),
        sa.Column("ok", sa.Integer, nullable=False),
        sa.Column("time_s", sa.Double),
        sa.Column("z_min_mm", sa.Double),
        sa.Column("z_max_mm", sa.Double),
        sa.Column("body", sa.JSON, nullable=False),
        sqlite_with_rowid=False,
    )
    connection = op.get_bind()
    for key, request in connection.execute(sa.select(_flights.c.key, _flights.c.request)).all():
        mine = (
            sa.select(_frames, _details.c.body)
            .join(
                _details,
                (_details.c.flight == _frames.c.flight) & (_details.c.number == _frames.c.number),
            )
            .where(_frames.c.flight == key)
            .order_by(_frames.c.number)
        )
        after = -1
        while some := connection.execute(
            mine.where(_frames.c.number > after).limit(_READ_ROWS)
        ).all():
            rows = [row._asdict() for row in some]
            damaged = {row["number"] for row in rows if row["body"].get("damaged")}
            connection.execute(sa.insert(bins), list(_bins_of(rows, request, damaged)))
            after = rows[-1]["number"]


def downgrade() -> None:
    op.drop_table("frame_bins")


def _bins_of(
    frames: Sequence[Mapping[str, Any]], request: Mapping[str, Any], damaged: Collection[int]
) -> Iterator[dict[str, Any]]:
    """Rows of the table, as this revision's program made them."""
    origin = int(request.get("first_frame", 0))
    width = _BIN_FRAMES * int(request.get("stride", 1))
    for _, some in groupby(frames, key=lambda frame: (frame["number"] - origin) // width):
        yield _sum_up(list(some), damaged)


def _sum_up(frames: Sequence[Mapping[str, Any]], damaged: Collection[int]) -> dict[str, Any]:
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
        },
    }
