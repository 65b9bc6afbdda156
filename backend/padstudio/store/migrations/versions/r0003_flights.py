"""Flights, their chunks and frames."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

_key = sa.BigInteger().with_variant(sa.Integer, "sqlite")
_time = sa.DateTime(timezone=True)


def _flight(*, primary_key: bool) -> sa.Column[int]:
    return sa.Column(
        "flight",
        sa.BigInteger,
        sa.ForeignKey("flights.key", ondelete="CASCADE"),
        primary_key=primary_key,
        nullable=False,
    )


def upgrade() -> None:
    _create_flights()
    op.create_table(
        "flight_uploads",
        _flight(primary_key=True),
        sa.Column("place", sa.Integer, primary_key=True),
        sa.Column("upload", sa.String(32), sa.ForeignKey("uploads.id"), nullable=False),
    )
    op.create_index("ix_flight_uploads_upload", "flight_uploads", ["upload"])
    _create_chunks()
    _create_frames()


def _create_flights() -> None:
    op.create_table(
        "flights",
        sa.Column("key", _key, primary_key=True),
        sa.Column("id", sa.String(32), nullable=False, unique=True),
        sa.Column("created_at", _time, nullable=False),
        sa.Column("started_at", _time),
        sa.Column("finished_at", _time),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("state", sa.String(20), nullable=False),
        sa.Column("request", sa.JSON, nullable=False),
        sa.Column("sources", sa.JSON, nullable=False),
        sa.Column("frames_total", sa.Integer),
        sa.Column("frames_done", sa.Integer, nullable=False),
        sa.Column("frames_ok", sa.Integer, nullable=False),
        sa.Column("error", sa.JSON),
        sa.Column("rerun_of", sa.String(32)),
        sa.Column("pad", sa.Text, nullable=False),
        sa.Column("camera", sa.Text, nullable=False),
        sa.Column("telemetry", sa.JSON),
    )
    for column in ("created_at", "state", "rerun_of"):
        op.create_index(f"ix_flights_{column}", "flights", [column])


def _create_chunks() -> None:
    op.create_table(
        "chunks",
        sa.Column("id", _key, primary_key=True),
        _flight(primary_key=False),
        sa.Column("number", sa.Integer, nullable=False),
        sa.Column("state", sa.String(20), nullable=False),
        sa.Column("attempt", sa.Integer, nullable=False),
        sa.Column("failures", sa.Integer, nullable=False),
        sa.Column("lease_until", _time),
        sa.Column("source", sa.Integer, nullable=False),
        sa.Column("first_frame", sa.Integer, nullable=False),
        sa.Column("frames", sa.Integer, nullable=False),
        sa.Column("pts", sa.LargeBinary, nullable=False),
        sa.Column("error", sa.JSON),
    )
    op.create_index("ix_chunks_flight_number", "chunks", ["flight", "number"], unique=True)
    op.create_index("ix_chunks_state_flight", "chunks", ["state", "flight", "number"])


def _create_frames() -> None:
    op.create_table(
        "frames",
        _flight(primary_key=True),
        sa.Column("number", sa.Integer, primary_key=True),
        sa.Column("time_s", sa.Double),
        sa.Column("status", sa.String(10), nullable=False),
        sa.Column("stage", sa.String(20)),
        sa.Column("reason", sa.String(40)),
        sa.Column("layer", sa.String(10)),
        sa.Column("x_mm", sa.Double),
        sa.Column("y_mm", sa.Double),
        sa.Column("z_mm", sa.Double),
        sqlite_with_rowid=False,
    )
    for column in ("status", "reason", "time_s"):
        op.create_index(f"ix_frames_{column}", "frames", ["flight", column, "number"])
    op.create_table(
        "frame_details",
        _flight(primary_key=True),
        sa.Column("number", sa.Integer, primary_key=True),
        sa.Column("chunk", sa.Integer, nullable=False),
        sa.Column("body", sa.JSON, nullable=False),
        sqlite_with_rowid=False,
    )


def downgrade() -> None:
    for table in ("frame_details", "frames", "chunks", "flight_uploads", "flights"):
        op.drop_table(table)
