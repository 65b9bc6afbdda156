"""More pads that a flight's frames may show."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("flights", sa.Column("other_pads", sa.JSON))


def downgrade() -> None:
    op.drop_column("flights", "other_pads")
