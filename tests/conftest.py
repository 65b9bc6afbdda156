"""Settings of the whole suite."""

from hypothesis import settings

#: A test that asks for a database runs on SQLite and on PostgreSQL.
pytest_plugins = ["store_fixtures"]

# The same examples every time, and no verdict by the clock: the suite must not depend on luck or
# on the machine's load.
settings.register_profile("padstudio", derandomize=True, deadline=None, max_examples=60)
settings.load_profile("padstudio")
