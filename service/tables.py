"""The schema of the database: what the invariants of a map look like as constraints.

State rows (`zones`, `passages`, `doorways`, a session's `version`) are authoritative; the log
(`steps`) is for audit, replay and answers to retries. `zone_versions` and `doorway_versions` hold,
at every checkpoint, what changed since the one before, so that an earlier map is a short replay
away. What proved to be part of something else keeps its row; `until` is the step since which it is
no more. `changes` is the log of what is no step: names of zones, and restrictions.
"""

from __future__ import annotations

from sqlalchemy import (
    BigInteger,
    CheckConstraint,
    Column,
    Float,
    ForeignKey,
    ForeignKeyConstraint,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    Table,
    Text,
    UniqueConstraint,
)

metadata = MetaData(
    naming_convention={
        "pk": "pk_%(table_name)s",
        "fk": "fk_%(table_name)s_%(column_0_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "ck": "ck_%(table_name)s_%(constraint_name)s",
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
    }
)

# SQLite numbers rows by themselves only where the type is plain INTEGER
RowNumber = BigInteger().with_variant(Integer, "sqlite")


def _session_column() -> Column[int]:
    """Return the column that says to which session a row belongs."""
    owner = ForeignKey("sessions.number", ondelete="CASCADE")
    return Column("session", RowNumber, owner, primary_key=True)


api_keys = Table(
    "api_keys",
    metadata,
    Column("number", RowNumber, primary_key=True, autoincrement=True),
    Column("id", Text, nullable=False, unique=True),  # the part of a key that is no secret
    Column("name", Text, nullable=False, unique=True),
    Column("digest", LargeBinary, nullable=False),  # SHA-256 of the secret part
    Column("created_at", Text, nullable=False),  # ISO 8601, UTC
    Column("revoked_at", Text),
)

sessions = Table(
    "sessions",
    metadata,
    Column("number", RowNumber, primary_key=True, autoincrement=True),
    Column("id", Text, nullable=False, unique=True),
    Column("owner", RowNumber, ForeignKey("api_keys.number")),  # none: made without a key
    Column("name", Text, nullable=False),
    Column("created_at", Text, nullable=False),  # ISO 8601, UTC
    Column("sensor", Text, nullable=False),  # JSON
    Column("mapping", Text, nullable=False),  # JSON
    Column("engine", Text, nullable=False),  # version of the code that began the map
    Column("version", Integer, nullable=False),  # seq of the last step
    Column("revision", Integer, nullable=False, server_default="0"),  # number of changes
    Column("checkpoint_every", Integer, nullable=False, server_default="64"),  # steps
    CheckConstraint("version >= 0", name="version"),
    CheckConstraint("revision >= 0", name="revision"),
    Index("ix_sessions_owner_number", "owner", "number"),
    sqlite_autoincrement=True,  # a number is never used again
)

worlds = Table(
    "worlds",  # apart, since SQLite writes a row as a whole, and each step changes its session's
    metadata,
    _session_column(),
    Column("world", Text, nullable=False),  # JSON
)

creations = Table(
    "creations",
    metadata,
    # the owner's number, or 0: unlike NULL, it is the same as itself
    Column("scope", RowNumber, primary_key=True, autoincrement=False),
    Column("key", Text, primary_key=True),  # Idempotency-Key
    Column("session", RowNumber, ForeignKey("sessions.number", ondelete="CASCADE"), nullable=False),
    Column("fingerprint", LargeBinary, nullable=False),  # SHA-256 of what was asked for
    Index("ix_creations_session", "session"),
)

steps = Table(
    "steps",
    metadata,
    _session_column(),
    Column("seq", Integer, primary_key=True, autoincrement=False),
    Column("taken_at", Text, nullable=False),  # ISO 8601, UTC
    Column("key", Text),  # Idempotency-Key
    Column("fingerprint", LargeBinary, nullable=False),  # SHA-256 of the input
    Column("input", Text, nullable=False),  # JSON: pose, and scan if there was one
    Column("answer", Text, nullable=False),  # JSON, to the byte
    CheckConstraint("seq >= 1", name="seq"),
    Index("uq_steps_session_key", "session", "key", unique=True),
)

zones = Table(
    "zones",
    metadata,
    _session_column(),
    Column("zone_id", Text, primary_key=True),
    Column("position", Integer, nullable=False),  # in the order of finding
    Column("label", Text, nullable=False),
    Column("since", Integer, nullable=False),
    Column("seq", Integer, nullable=False),
    Column("region", LargeBinary, nullable=False),  # WKB, m
    Column("border", LargeBinary, nullable=False),
    Column("until", Integer),
    Column("merged_into", Text),  # the zone of which it is a part since then
    UniqueConstraint("session", "position"),
    CheckConstraint("1 <= since AND since <= seq", name="seq"),
)

zone_versions = Table(
    "zone_versions",
    metadata,
    _session_column(),
    Column("zone_id", Text, primary_key=True),
    Column("checkpoint", Integer, primary_key=True, autoincrement=False),
    Column("seq", Integer, nullable=False),
    Column("region", LargeBinary, nullable=False),
    Column("border", LargeBinary, nullable=False),
    ForeignKeyConstraint(
        ["session", "zone_id"],
        ["zones.session", "zones.zone_id"],
        name="fk_zone_versions_zone",
        ondelete="CASCADE",
    ),
)

passages = Table(
    "passages",
    metadata,
    _session_column(),
    Column("source", Text, primary_key=True),
    Column("target", Text, primary_key=True),
    Column("number", Integer, primary_key=True, autoincrement=False),
    Column("position", Integer, nullable=False),  # in the order of finding
    Column("x", Float(53), nullable=False),  # m; 53 bits, so that PostgreSQL keeps every one
    Column("y", Float(53), nullable=False),
    Column("seq", Integer, nullable=False),
    Column("moved", Integer, nullable=False),  # the step since which it has its key; 0: `seq`
    Column("until", Integer),
    UniqueConstraint("session", "position"),
    CheckConstraint("source <> target", name="no_loop"),
    ForeignKeyConstraint(
        ["session", "source"],
        ["zones.session", "zones.zone_id"],
        name="fk_passages_source",
        ondelete="CASCADE",
    ),
    ForeignKeyConstraint(
        ["session", "target"],
        ["zones.session", "zones.zone_id"],
        name="fk_passages_target",
        ondelete="CASCADE",
    ),
    Index("ix_passages_session_target", "session", "target"),
)

doorways = Table(
    "doorways",
    metadata,
    _session_column(),
    Column("one", Text, primary_key=True),
    Column("other", Text, primary_key=True),
    Column("number", Integer, primary_key=True, autoincrement=False),
    Column("position", Integer, nullable=False),  # in the order of finding
    Column("since", Integer, nullable=False),
    Column("seq", Integer, nullable=False),
    Column("region", LargeBinary, nullable=False),  # WKB, m
    Column("until", Integer),
    Column("became_one", Text),  # the doorway of which it is a part since then
    Column("became_other", Text),
    Column("became_number", Integer),
    UniqueConstraint("session", "position"),
    CheckConstraint("1 <= since AND since <= seq", name="seq"),
    ForeignKeyConstraint(
        ["session", "one"],
        ["zones.session", "zones.zone_id"],
        name="fk_doorways_one",
        ondelete="CASCADE",
    ),
    ForeignKeyConstraint(
        ["session", "other"],
        ["zones.session", "zones.zone_id"],
        name="fk_doorways_other",
        ondelete="CASCADE",
    ),
    Index("ix_doorways_session_other", "session", "other"),
)

doorway_versions = Table(
    "doorway_versions",
    metadata,
    _session_column(),
    Column("one", Text, primary_key=True),
    Column("other", Text, primary_key=True),
    Column("number", Integer, primary_key=True, autoincrement=False),
    Column("checkpoint", Integer, primary_key=True, autoincrement=False),
    Column("seq", Integer, nullable=False),
    Column("region", LargeBinary, nullable=False),
    ForeignKeyConstraint(
        ["session", "one", "other", "number"],
        ["doorways.session", "doorways.one", "doorways.other", "doorways.number"],
        name="fk_doorway_versions_doorway",
        ondelete="CASCADE",
    ),
)

changes = Table(
    "changes",
    metadata,
    _session_column(),
    Column("number", Integer, primary_key=True, autoincrement=False),  # 1, 2, 3 in each session
    Column("seq", Integer, nullable=False),  # the last step before it
    Column("made_at", Text, nullable=False),  # ISO 8601, UTC
    Column("kind", Text, nullable=False),  # zone, restriction or lifted
    Column("document", Text, nullable=False),  # JSON
    CheckConstraint("number >= 1", name="number"),
    CheckConstraint("seq >= 0", name="seq"),
)
