"""Frames summed up by the hundred, also those of flights that were analysed before."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

from padstudio.flights.results.bins import bins_of

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
            connection.execute(sa.insert(bins), list(bins_of(rows, request, damaged)))
            after = rows[-1]["number"]


def downgrade() -> None:
    op.drop_table("frame_bins")
