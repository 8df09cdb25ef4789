"""Add the log of what is no step: names of zones, and restrictions."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

row_number = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    # SQLite can only add a column by itself; what checks it must come along with it
    op.execute(
        "ALTER TABLE sessions ADD COLUMN revision INTEGER DEFAULT 0 NOT NULL"
        " CONSTRAINT ck_sessions_revision CHECK (revision >= 0)"
    )
    op.create_table(
        "changes",
        sa.Column("session", row_number, nullable=False),
        sa.Column("number", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("made_at", sa.Text(), nullable=False),
        sa.Column("kind", sa.Text(), nullable=False),
        sa.Column("document", sa.Text(), nullable=False),
        sa.CheckConstraint("number >= 1", name=op.f("ck_changes_number")),
        sa.CheckConstraint("seq >= 0", name=op.f("ck_changes_seq")),
        sa.ForeignKeyConstraint(
            ["session"],
            ["sessions.number"],
            name=op.f("fk_changes_session"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("session", "number", name=op.f("pk_changes")),
    )


def downgrade() -> None:
    op.drop_table("changes")
    op.drop_column("sessions", "revision")
