"""Alembic's entry: runs the revisions on the connection that `open_database` opened."""

from alembic import context

# SQLite cannot alter a column in place.
context.configure(connection=context.config.attributes["connection"], render_as_batch=True)
with context.begin_transaction():
    context.run_migrations()
