"""Begin with sessions, steps and maps."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None

row_number = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    op.create_table(
        "api_keys",
        sa.Column("number", row_number, autoincrement=True, nullable=False),
        sa.Column("id", sa.Text(), nullable=False),
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("digest", sa.LargeBinary(), nullable=False),
        sa.Column("created_at", sa.Text(), nullable=False),
        sa.Column("revoked_at", sa.Text(), nullable=True),
        sa.PrimaryKeyConstraint("number", name=op.f("pk_api_keys")),
        sa.UniqueConstraint("id", name=op.f("uq_api_keys_id")),
        sa.UniqueConstraint("name", name=op.f("uq_api_keys_name")),
    )
    op.create_table(
        "sessions",
        sa.Column("number", row_number, autoincrement=True, nullable=False),
        sa.Column("id", sa.Text(), nullable=False),
        sa.Column("owner", row_number, nullable=True),
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("created_at", sa.Text(), nullable=False),
        sa.Column("world", sa.Text(), nullable=True),
        sa.Column("sensor", sa.Text(), nullable=False),
        sa.Column("mapping", sa.Text(), nullable=False),
        sa.Column("engine", sa.Text(), nullable=False),
        sa.Column("version", sa.Integer(), nullable=False),
        sa.CheckConstraint("version >= 0", name=op.f("ck_sessions_version")),
        sa.ForeignKeyConstraint(["owner"], ["api_keys.number"], name=op.f("fk_sessions_owner")),
        sa.PrimaryKeyConstraint("number", name=op.f("pk_sessions")),
        sa.UniqueConstraint("id", name=op.f("uq_sessions_id")),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_sessions_owner_number", "sessions", ["owner", "number"], unique=False)
    op.create_table(
        "steps",
        sa.Column("session", row_number, nullable=False),
        sa.Column("seq", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("taken_at", sa.Text(), nullable=False),
        sa.Column("key", sa.Text(), nullable=True),
        sa.Column("fingerprint", sa.LargeBinary(), nullable=False),
        sa.Column("input", sa.Text(), nullable=False),
        sa.Column("answer", sa.Text(), nullable=False),
        sa.CheckConstraint("seq >= 1", name=op.f("ck_steps_seq")),
        sa.ForeignKeyConstraint(
            ["session"], ["sessions.number"], name=op.f("fk_steps_session"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("session", "seq", name=op.f("pk_steps")),
    )
    op.create_index("uq_steps_session_key", "steps", ["session", "key"], unique=True)
    op.create_table(
        "zones",
        sa.Column("session", row_number, nullable=False),
        sa.Column("zone_id", sa.Text(), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("label", sa.Text(), nullable=False),
        sa.Column("since", sa.Integer(), nullable=False),
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("region", sa.LargeBinary(), nullable=False),
        sa.Column("border", sa.LargeBinary(), nullable=False),
        sa.CheckConstraint("1 <= since AND since <= seq", name=op.f("ck_zones_seq")),
        sa.ForeignKeyConstraint(
            ["session"], ["sessions.number"], name=op.f("fk_zones_session"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("session", "zone_id", name=op.f("pk_zones")),
        sa.UniqueConstraint("session", "position", name=op.f("uq_zones_session_position")),
    )
    op.create_table(
        "passages",
        sa.Column("session", row_number, nullable=False),
        sa.Column("source", sa.Text(), nullable=False),
        sa.Column("target", sa.Text(), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("x", sa.Float(precision=53), nullable=False),
        sa.Column("y", sa.Float(precision=53), nullable=False),
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.CheckConstraint("source <> target", name=op.f("ck_passages_no_loop")),
        sa.ForeignKeyConstraint(
            ["session", "source"],
            ["zones.session", "zones.zone_id"],
            name="fk_passages_source",
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["session", "target"],
            ["zones.session", "zones.zone_id"],
            name="fk_passages_target",
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["session"], ["sessions.number"], name=op.f("fk_passages_session"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("session", "source", "target", name=op.f("pk_passages")),
        sa.UniqueConstraint("session", "position", name=op.f("uq_passages_session_position")),
    )
    op.create_index("ix_passages_session_target", "passages", ["session", "target"], unique=False)
    op.create_table(
        "zone_versions",
        sa.Column("session", row_number, nullable=False),
        sa.Column("zone_id", sa.Text(), nullable=False),
        sa.Column("checkpoint", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("region", sa.LargeBinary(), nullable=False),
        sa.Column("border", sa.LargeBinary(), nullable=False),
        sa.ForeignKeyConstraint(
            ["session", "zone_id"],
            ["zones.session", "zones.zone_id"],
            name="fk_zone_versions_zone",
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["session"],
            ["sessions.number"],
            name=op.f("fk_zone_versions_session"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("session", "zone_id", "checkpoint", name=op.f("pk_zone_versions")),
    )


def downgrade() -> None:
    op.drop_table("zone_versions")
    op.drop_index("ix_passages_session_target", "passages")
    op.drop_table("passages")
    op.drop_table("zones")
    op.drop_index("uq_steps_session_key", "steps")
    op.drop_table("steps")
    op.drop_index("ix_sessions_owner_number", "sessions")
    op.drop_table("sessions")
    op.drop_table("api_keys")
