"""Opens the database, brings its tables to this version of the program, gives sessions."""

from __future__ import annotations

import contextlib
import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic_core import from_json
from sqlalchemy import URL, Connection, Engine, create_engine, event, inspect, make_url, text
from sqlalchemy.exc import ArgumentError, OperationalError, SQLAlchemyError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from sqlalchemy.orm import Session, sessionmaker

from padstudio.errors import BusyError, StorageError

#: What the database raises.
DatabaseFault = SQLAlchemyError
#: The last of the revisions in `padstudio.store.migrations`.
NEWEST_REVISION = "0009"
# Alembic keeps its context in a module of its own: one migration at a time in a process.
_migrating = threading.Lock()
_MIGRATIONS = Path(__file__).parents[1] / "migrations"
_WRITING = {"padstudio_writing": True}
# A PostgreSQL that does not answer is waited for so long, s.
_CONNECT_S = "10"
# What SQLite says of files that it cannot read, and both databases of tables in their way.
_DAMAGED = ("file is not a database", "malformed", "file is encrypted")
_FOREIGN = ("already exists", "no such column", "no such table", "UndefinedColumn")


class Sessions(sessionmaker[Session]):
    """Sessions of a database: those of `begin` are for writing, those of a call for reading.

    SQLite has one writer at a time. A transaction that begins by reading and then writes is
    refused at once where another has written in between, however long it would wait; so writers
    take the lock when they begin, and threads of this process queue for it.

    Parameters
    ----------
    engine : Engine
        As of `open_database`.
    """

    def __init__(self, engine: Engine) -> None:
        super().__init__(engine, expire_on_commit=False)
        self._writing = engine.execution_options(**_WRITING)
        one_writer = engine.dialect.name == "sqlite"
        self._turn = threading.Lock() if one_writer else contextlib.nullcontext()

    @contextlib.contextmanager
    def begin(self) -> Iterator[Session]:
        """A session in a transaction, which is committed at the end."""
        with self._turn, self(bind=self._writing) as session, session.begin():
            yield session


def sqlite_url(path: Path) -> URL:
    """The address of a database in a file, whatever the path is called."""
    return URL.create("sqlite", database=str(path))


def open_database(url: str | URL) -> Engine:
    """Connect to a database and migrate it.

    Parameters
    ----------
    url : str or URL
        SQLAlchemy URL; ``postgresql://`` takes psycopg.

    Raises
    ------
    StorageError
        If it cannot be opened, is no database of ours, or was written by a later version of the
        program.
    """
    try:
        address = _with_driver(make_url(url))
        # A database server may have been restarted since a connection was last used.
        is_server = address.get_backend_name() != "sqlite"
        engine = create_engine(address, pool_pre_ping=is_server, json_deserializer=_decode)
    except ArgumentError as error:
        raise StorageError(
            "PADSTUDIO_DATABASE_URL is no address of a database; write it as "
            "postgresql://user:password@host/name",
            code="invalid_database_url",
        ) from error
    except ModuleNotFoundError as error:
        raise StorageError(
            f"the database needs a further package ({error}): pip install padstudio[postgresql]"
        ) from error
    except (SQLAlchemyError, ImportError) as error:
        raise StorageError(f"the database URL cannot be used: {error}") from error
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _prepare_sqlite)
        event.listen(engine, "begin", _begin_sqlite)
    try:
        _migrate(engine)
    except SQLAlchemyError as error:
        engine.dispose()
        raise _unusable(error, address) from error
    except StorageError:
        engine.dispose()
        raise
    return engine


def _decode(text: str | bytes) -> Any:
    """A column's JSON, in a third of the time that `json` takes for the short texts of bins."""
    try:
        return from_json(text)
    except ValueError:
        # Half surrogates, which rows written before they were refused may hold.
        return json.loads(text)


def _unusable(error: SQLAlchemyError, address: URL) -> StorageError:
    """Why a database cannot be opened, and what to do; never its password or a statement."""
    cause = " ".join(str(error.__cause__ or error).split())
    is_file = address.get_backend_name() == "sqlite"
    host = address.host or address.query.get("host") or "this machine"
    place = f"the database {address.database}" if is_file else f"the database at {host}"
    if any(sign in cause for sign in _DAMAGED):
        return StorageError(
            f"{place} is damaged, or no database: put a copy of it from before back, or move it "
            "away to begin with an empty one",
            code="database_damaged",
        )
    if any(sign in cause for sign in _FOREIGN):
        return StorageError(
            f"{place} holds tables that are not Pad Studio's ({cause}); choose another database",
            code="foreign_database",
        )
    advice = (
        "see that its folder exists and can be written"
        if is_file
        else "see that the server runs, that PADSTUDIO_DATABASE_URL names it rightly, and that the "
        "user may make tables"
    )
    return StorageError(
        f"{place} cannot be opened ({cause}); {advice}", code="database_unreachable"
    )


def storage_error(error: SQLAlchemyError) -> StorageError | BusyError:
    """What a fault of the database means for who asked: a full disk, one that is away, others.

    Parameters
    ----------
    error : SQLAlchemyError
    """
    cause = str(error.__cause__ or error)
    if any(sign in cause.lower() for sign in ("disk is full", "disk full", "no space left")):
        return StorageError(
            "the disk that holds the database is full; make room and try again", code="disk_full"
        )
    if isinstance(error, OperationalError | PoolTimeoutError):
        return BusyError(
            f"the database does not answer: {cause}; try again in a moment", code="database_busy"
        )
    return StorageError(f"the database refused to store or to read: {cause}")


def _with_driver(url: URL) -> URL:
    """A URL that names no driver for PostgreSQL gets the one that we depend on."""
    if url.drivername in ("postgresql", "postgres"):
        url = url.set(drivername="postgresql+psycopg")
    if url.drivername == "postgresql+psycopg" and "connect_timeout" not in url.query:
        url = url.update_query_dict({"connect_timeout": _CONNECT_S})
    return url


def _prepare_sqlite(connection: Any, _record: object) -> None:
    """Readers beside one writer, and a wait instead of an error where two write."""
    # Transactions begin where `_begin_sqlite` says, and not at the driver's first guess.
    connection.isolation_level = None
    cursor = connection.cursor()
    # First, as the change of the journal may have to wait as well.
    cursor.execute("PRAGMA busy_timeout=30000")
    cursor.execute("PRAGMA journal_mode=WAL")
    cursor.execute("PRAGMA synchronous=NORMAL")
    cursor.execute("PRAGMA foreign_keys=ON")
    cursor.close()


def _begin_sqlite(connection: Connection) -> None:
    writing = connection.get_execution_options().keys() & _WRITING.keys()
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writing else "BEGIN")


def _migrate(engine: Engine) -> None:
    if _revision(engine) == NEWEST_REVISION:
        return
    # Alembic takes most of a second to import; most starts do without.
    from alembic import command
    from alembic.config import Config
    from alembic.util import CommandError

    config = Config()
    config.set_main_option("script_location", str(_MIGRATIONS).replace("%", "%%"))
    with _migrating, engine.execution_options(**_WRITING).begin() as connection:
        config.attributes["connection"] = connection
        try:
            command.upgrade(config, "head")
        except CommandError as error:
            raise StorageError(
                "the database was written by a later version of Pad Studio; update the program, "
                f"or choose another data folder ({error})",
                code="newer_database",
            ) from error


def _revision(engine: Engine) -> str | None:
    """The revision that a database is at; None for a new one."""
    if not inspect(engine).has_table("alembic_version"):
        return None
    with engine.connect() as connection:
        found: str | None = connection.scalar(text("SELECT version_num FROM alembic_version"))
        return found
