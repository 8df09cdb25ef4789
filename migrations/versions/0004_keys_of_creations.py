"""Remember which session an Idempotency-Key began."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

row_number = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    op.create_table(
        "creations",
        sa.Column("scope", row_number, autoincrement=False, nullable=False),
        sa.Column("key", sa.Text(), nullable=False),
        sa.Column("session", row_number, nullable=False),
        sa.Column("fingerprint", sa.LargeBinary(), nullable=False),
        sa.ForeignKeyConstraint(
            ["session"], ["sessions.number"], name=op.f("fk_creations_session"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("scope", "key", name=op.f("pk_creations")),
    )
    op.create_index("ix_creations_session", "creations", ["session"], unique=False)


def downgrade() -> None:
    op.drop_index("ix_creations_session", "creations")
    op.drop_table("creations")
