"""The quality of a frame's pose, also of flights that were analysed before."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None

_FRAME = ("flight", "number", "status", "layer", "quality", "x_mm", "y_mm", "z_mm")
_frames = sa.table("frames", *map(sa.column, _FRAME))
_details = sa.table(
    "frame_details", sa.column("flight"), sa.column("number"), sa.column("body", sa.JSON)
)
_bins = sa.table(
    "frame_bins",
    *(sa.column(name) for name in ("flight", "first_frame", "last_frame")),
    sa.column("body", sa.JSON),
)
# Most one standard deviation of a full pose, as this revision's program had it.
_POSITION_SHARE, _ATTITUDE_DEG = 0.03, 3.0


def upgrade() -> None:
    op.add_column("frames", sa.Column("quality", sa.String(10)))
    connection = op.get_bind()
    places = (_bins.c.flight, _bins.c.first_frame, _bins.c.last_frame)
    for flight, first, last in connection.execute(sa.select(*places)).all():
        _fill_bin(connection, flight, first, last)


def downgrade() -> None:
    connection = op.get_bind()
    for row in connection.execute(sa.select(_bins)).all():
        body = {key: row.body[key] for key in row.body if key not in ("bearings", "unknown")}
        _write_body(connection, row.flight, row.first_frame, body)
    op.drop_column("frames", "quality")


def _fill_bin(connection: sa.Connection, flight: int, first: int, last: int) -> None:
    """Give the frames of a bin their quality, and the bin its counts of them."""
    here = (_frames.c.flight == flight) & _frames.c.number.between(first, last)
    joined = (_details.c.flight == _frames.c.flight) & (_details.c.number == _frames.c.number)
    chosen = sa.select(_frames, _details.c.body).join(_details, joined)
    poses = connection.execute(chosen.where(here, _frames.c.status == "ok")).all()
    qualities = [_quality([row.x_mm, row.y_mm, row.z_mm], row.body) for row in poses]
    for quality in ("full", "bearing"):
        numbers = [
            row.number for row, told in zip(poses, qualities, strict=True) if told == quality
        ]
        if numbers:
            mine = sa.update(_frames).where(here, _frames.c.number.in_(numbers))
            connection.execute(mine.values(quality=quality))
    layers = [row.layer for row, told in zip(poses, qualities, strict=True) if told == "bearing"]
    place = (_bins.c.flight == flight) & (_bins.c.first_frame == first)
    body = connection.execute(sa.select(_bins.c.body).where(place)).scalar_one()
    counts = {"bearings": Counter(layers), "unknown": qualities.count(None)}
    _write_body(connection, flight, first, body | counts)


def _quality(position_mm: Sequence[float | None], body: Mapping[str, Any]) -> str | None:
    shift, turn = body.get("position_sigma_mm"), body.get("attitude_sigma_deg")
    if not shift or not turn or None in position_mm:
        return None
    most_mm = _POSITION_SHARE * math.hypot(*(mm for mm in position_mm if mm is not None))
    is_full = math.hypot(*shift) <= most_mm and math.hypot(*turn) <= _ATTITUDE_DEG
    return "full" if is_full else "bearing"


def _write_body(
    connection: sa.Connection, flight: int, first: int, body: Mapping[str, Any]
) -> None:
    place = (_bins.c.flight == flight) & (_bins.c.first_frame == first)
    connection.execute(sa.update(_bins).where(place).values(body=body))
