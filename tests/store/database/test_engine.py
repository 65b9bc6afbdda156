"""Opening databases, and writing to one from many threads and processes at once."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import counting
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from sqlalchemy import JSON, Engine, select, type_coerce
from sqlalchemy.exc import IntegrityError, OperationalError

from padstudio.errors import StorageError
from padstudio.store.database.engine import Sessions, open_database, storage_error
from padstudio.store.database.tables import TraceRow

THREADS, TIMES = 6, 40


def test_nobody_is_refused_or_overwritten_where_many_write(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'studio.db'}"
    engine = open_database(url)
    sessions = Sessions(engine)
    with sessions.begin() as session:
        session.add(TraceRow(id="a", created_at=datetime.now(UTC), size_bytes=0, body={}))
    script = Path(counting.__file__)
    command = [sys.executable, str(script), url, str(THREADS), str(TIMES)]
    others = [subprocess.Popen(command, cwd=script.parent) for _ in range(2)]
    counting.count_in_threads(url, THREADS, TIMES)
    assert [other.wait(120) for other in others] == [0, 0]
    with sessions() as session:
        assert session.scalars(select(TraceRow.size_bytes)).one() == 3 * THREADS * TIMES
    engine.dispose()


def test_readers_do_not_wait_for_a_writer(tmp_path: Path) -> None:
    engine = open_database(f"sqlite:///{tmp_path / 'studio.db'}")
    sessions = Sessions(engine)
    with sessions.begin() as writer:
        writer.add(TraceRow(id="a", created_at=datetime.now(UTC), size_bytes=0, body={}))
        writer.flush()
        with sessions() as reader:
            assert reader.scalars(select(TraceRow.id)).all() == []
    with sessions() as reader:
        assert reader.scalars(select(TraceRow.id)).all() == ["a"]
        assert reader.connection().exec_driver_sql("PRAGMA journal_mode").scalar() == "wal"
    engine.dispose()


def test_a_transaction_that_fails_leaves_nothing_and_lets_others_write(tmp_path: Path) -> None:
    engine = open_database(f"sqlite:///{tmp_path / 'studio.db'}")
    sessions = Sessions(engine)

    def add(trace: str) -> None:
        with sessions.begin() as session:
            session.add(TraceRow(id=trace, created_at=datetime.now(UTC), size_bytes=0, body={}))

    add("a")
    with pytest.raises(IntegrityError):
        add("a")
    add("b")
    with sessions() as session:
        assert session.scalars(select(TraceRow.id)).all() == ["a", "b"]
    engine.dispose()


@pytest.mark.parametrize(
    ("says", "code", "status"),
    [
        ("database or disk is full", "disk_full", 507),
        ("could not extend file: No space left on device", "disk_full", 507),
        ("database is locked", "database_busy", 503),
        ("server closed the connection unexpectedly", "database_busy", 503),
    ],
)
def test_faults_are_told_by_name(says: str, code: str, status: int) -> None:
    error = storage_error(OperationalError("UPDATE", {}, Exception(says)))
    assert (error.error_code, error.status) == (code, status)


def test_a_server_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match="cannot be opened"):
        open_database(f"postgres://padstudio@/none?host={tmp_path}")


@pytest.fixture(scope="module")
def engine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Engine]:
    engine = open_database(f"sqlite:///{tmp_path_factory.mktemp('json') / 'studio.db'}")
    yield engine
    engine.dispose()


_TEXTS = st.text(st.characters(exclude_categories=[]))
_JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | _TEXTS,
    lambda inner: st.lists(inner) | st.dictionaries(_TEXTS, inner),
    max_leaves=12,
)


@given(st.lists(_JSON))
@example(["a half surrogate: \ud800"])
def test_columns_of_json_come_back_as_they_were_written(engine: Engine, value: list[Any]) -> None:
    with engine.begin() as connection:
        found = connection.scalar(select(type_coerce(value, JSON)))
    assert repr(found) == repr(value)
