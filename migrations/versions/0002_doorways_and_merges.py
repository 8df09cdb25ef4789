"""Keep doorways, parallel passages, and what was merged into something else."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None

row_number = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    # zones are not made anew, since that would take along all that refers to them
    op.add_column("zones", sa.Column("until", sa.Integer(), nullable=True))
    op.add_column("zones", sa.Column("merged_into", sa.Text(), nullable=True))
    with op.batch_alter_table("passages") as passages:
        passages.add_column(sa.Column("number", sa.Integer(), server_default="0", nullable=False))
        passages.add_column(sa.Column("moved", sa.Integer(), server_default="0", nullable=False))
        passages.add_column(sa.Column("until", sa.Integer(), nullable=True))
        passages.drop_constraint("pk_passages", type_="primary")
        passages.create_primary_key("pk_passages", ["session", "source", "target", "number"])
    with op.batch_alter_table("passages") as passages:
        passages.alter_column("number", existing_type=sa.Integer(), server_default=None)
        passages.alter_column("moved", existing_type=sa.Integer(), server_default=None)
    op.create_table(
        "doorways",
        sa.Column("session", row_number, nullable=False),
        sa.Column("one", sa.Text(), nullable=False),
        sa.Column("other", sa.Text(), nullable=False),
        sa.Column("number", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("since", sa.Integer(), nullable=False),
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("region", sa.LargeBinary(), nullable=False),
        sa.Column("until", sa.Integer(), nullable=True),
        sa.Column("became_one", sa.Text(), nullable=True),
        sa.Column("became_other", sa.Text(), nullable=True),
        sa.Column("became_number", sa.Integer(), nullable=True),
        sa.CheckConstraint("1 <= since AND since <= seq", name=op.f("ck_doorways_seq")),
        sa.ForeignKeyConstraint(
            ["session", "one"],
            ["zones.session", "zones.zone_id"],
            name="fk_doorways_one",
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["session", "other"],
            ["zones.session", "zones.zone_id"],
            name="fk_doorways_other",
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["session"], ["sessions.number"], name=op.f("fk_doorways_session"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("session", "one", "other", "number", name=op.f("pk_doorways")),
        sa.UniqueConstraint("session", "position", name=op.f("uq_doorways_session_position")),
    )
    op.create_index("ix_doorways_session_other", "doorways", ["session", "other"], unique=False)
    op.create_table(
        "doorway_versions",
        sa.Column("session", row_number, nullable=False),
        sa.Column("one", sa.Text(), nullable=False),
        sa.Column("other", sa.Text(), nullable=False),
        sa.Column("number", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("checkpoint", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("region", sa.LargeBinary(), nullable=False),
        sa.ForeignKeyConstraint(
            ["session", "one", "other", "number"],
            ["doorways.session", "doorways.one", "doorways.other", "doorways.number"],
            name="fk_doorway_versions_doorway",
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["session"],
            ["sessions.number"],
            name=op.f("fk_doorway_versions_session"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint(
            "session", "one", "other", "number", "checkpoint", name=op.f("pk_doorway_versions")
        ),
    )


def downgrade() -> None:
    op.drop_table("doorway_versions")
    op.drop_index("ix_doorways_session_other", "doorways")
    op.drop_table("doorways")
    op.execute("DELETE FROM passages WHERE number > 0 OR until IS NOT NULL")
    with op.batch_alter_table("passages") as passages:
        passages.drop_constraint("pk_passages", type_="primary")
        passages.create_primary_key("pk_passages", ["session", "source", "target"])
        passages.drop_column("until")
        passages.drop_column("moved")
        passages.drop_column("number")
    op.drop_column("zones", "merged_into")
    op.drop_column("zones", "until")
