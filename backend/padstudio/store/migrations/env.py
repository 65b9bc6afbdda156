"""Alembic's entry: runs the revisions on the connection that `store_database` opened."""

from alembic import context

from padstudio.store.database.flight_tables import FlightRow

context.configure(
    connection=context.config.attributes["connection"],
    # That of all tables: this module knows the others.
    target_metadata=FlightRow.metadata,
    # SQLite cannot alter a column in place.
    render_as_batch=True,
)
with context.begin_transaction():
    context.run_migrations()
