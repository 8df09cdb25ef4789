"""Run migrations on the connection that the caller opened, or on SEMTOPO_DATABASE."""

from __future__ import annotations

import os

from alembic import context
from sqlalchemy import Connection, create_engine


def run(connection: Connection) -> None:
    """Run all migrations in one transaction, so that a failure leaves the schema as it was."""
    context.configure(
        connection=connection,
        target_metadata=context.config.attributes.get("target_metadata"),
        render_as_batch=True,
        transactional_ddl=True,
    )
    with context.begin_transaction():
        context.run_migrations()


given = context.config.attributes.get("connection")
if given is not None:
    run(given)
else:
    url = os.environ["SEMTOPO_DATABASE"].replace("postgresql://", "postgresql+psycopg://", 1)
    with create_engine(url).begin() as own:
        run(own)
