"""Keep worlds apart from what changes with every step: SQLite writes a row as a whole."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None

row_number = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    op.create_table(
        "worlds",
        sa.Column("session", row_number, autoincrement=False, nullable=False),
        sa.Column("world", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["session"], ["sessions.number"], name=op.f("fk_worlds_session"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("session", name=op.f("pk_worlds")),
    )
    op.execute(
        "INSERT INTO worlds (session, world)"
        " SELECT number, world FROM sessions WHERE world IS NOT NULL"
    )
    op.drop_column("sessions", "world")


def downgrade() -> None:
    op.add_column("sessions", sa.Column("world", sa.Text(), nullable=True))
    op.execute(
        "UPDATE sessions SET world ="
        " (SELECT world FROM worlds WHERE worlds.session = sessions.number)"
    )
    op.drop_table("worlds")
