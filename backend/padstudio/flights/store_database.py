"""Opens the database and brings its tables to this version of the program."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

from sqlalchemy import Engine, create_engine, event, inspect, text
from sqlalchemy.exc import SQLAlchemyError

from padstudio.errors import StorageError

#: The last of the revisions in `padstudio.flights.migrations`.
NEWEST_REVISION = "0003"
# Alembic keeps its context in a module of its own: one migration at a time in a process.
_migrating = threading.Lock()
_MIGRATIONS = Path(__file__).parent / "migrations"


def open_database(url: str) -> Engine:
    """Connect to a database and migrate it.

    Parameters
    ----------
    url : str
        SQLAlchemy URL.

    Raises
    ------
    StorageError
        If it cannot be opened, or was written by a later version of the program.
    """
    try:
        engine = create_engine(url)
    except (SQLAlchemyError, ImportError) as error:
        raise StorageError(f"the database URL cannot be used: {error}") from error
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _prepare_sqlite)
    try:
        _migrate(engine)
    except SQLAlchemyError as error:
        engine.dispose()
        raise StorageError(f"cannot open the database: {error}") from error
    return engine


def _prepare_sqlite(connection: Any, _record: object) -> None:
    """Readers beside one writer, and a wait instead of an error where two write."""
    cursor = connection.cursor()
    cursor.execute("PRAGMA journal_mode=WAL")
    cursor.execute("PRAGMA synchronous=NORMAL")
    cursor.execute("PRAGMA busy_timeout=10000")
    cursor.execute("PRAGMA foreign_keys=ON")
    cursor.close()


def _migrate(engine: Engine) -> None:
    if _revision(engine) == NEWEST_REVISION:
        return
    # Alembic takes most of a second to import; most starts do without.
    from alembic import command
    from alembic.config import Config
    from alembic.util import CommandError

    config = Config()
    config.set_main_option("script_location", str(_MIGRATIONS).replace("%", "%%"))
    with _migrating, engine.begin() as connection:
        config.attributes["connection"] = connection
        try:
            command.upgrade(config, "head")
        except CommandError as error:
            raise StorageError(
                "the database was written by a later version of Pad Studio; update the program, "
                f"or choose another data folder ({error})"
            ) from error


def _revision(engine: Engine) -> str | None:
    """The revision that a database is at; None for a new one."""
    if not inspect(engine).has_table("alembic_version"):
        return None
    with engine.connect() as connection:
        found: str | None = connection.scalar(text("SELECT version_num FROM alembic_version"))
        return found
