"""Alembic's entry: runs the revisions on the connection that `store_database` opened."""

from alembic import context

from padstudio.flights.store_tables import Base

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,
    # SQLite cannot alter a column in place.
    render_as_batch=True,
)
with context.begin_transaction():
    context.run_migrations()
