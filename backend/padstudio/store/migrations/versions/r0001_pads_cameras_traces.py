"""Pads, cameras and traces."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    for table in ("pads", "cameras"):
        op.create_table(
            table,
            sa.Column("id", sa.String(32), primary_key=True),
            sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
            sa.Column("summary", sa.JSON, nullable=False),
            sa.Column("content", sa.Text, nullable=False),
        )
        op.create_index(f"ix_{table}_created_at", table, ["created_at"])
    op.create_table(
        "traces",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("size_bytes", sa.BigInteger, nullable=False),
        sa.Column("body", sa.JSON, nullable=False),
    )
    op.create_index("ix_traces_created_at", "traces", ["created_at"])


def downgrade() -> None:
    for table in ("traces", "cameras", "pads"):
        op.drop_table(table)
