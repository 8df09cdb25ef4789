"""Say of each session how many steps lie between its checkpoints: those to come are closer."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column(
        "sessions", sa.Column("checkpoint_every", sa.Integer(), nullable=False, server_default="64")
    )


def downgrade() -> None:
    op.drop_column("sessions", "checkpoint_every")
