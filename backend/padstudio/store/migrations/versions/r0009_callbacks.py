"""Callbacks of flights that have ended, and keys under which flights are ordered once."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("flights", sa.Column("order_key", sa.String(64)))
    op.create_index("ix_flights_order_key", "flights", ["order_key"], unique=True)
    op.create_table(
        "callbacks",
        sa.Column(
            "flight",
            sa.BigInteger,
            sa.ForeignKey("flights.key", ondelete="CASCADE"),
            primary_key=True,
        ),
        sa.Column("delivery", sa.String(32), nullable=False),
        sa.Column("url", sa.Text, nullable=False),
        sa.Column("state", sa.String(20), nullable=False),
        sa.Column("attempts", sa.Integer, nullable=False),
        sa.Column("next_at", sa.DateTime(timezone=True)),
        sa.Column("delivered_at", sa.DateTime(timezone=True)),
        sa.Column("error", sa.Text),
    )
    op.create_index("ix_callbacks_state", "callbacks", ["state"])


def downgrade() -> None:
    op.drop_table("callbacks")
    op.drop_index("ix_flights_order_key", "flights")
    with op.batch_alter_table("flights") as flights:
        flights.drop_column("order_key")
