"""Databases for tests: every test that asks for one runs on SQLite and on PostgreSQL."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Iterator

import postgres_server
import pytest

NewDatabase = Callable[[], str | None]


@pytest.fixture(scope="session")
def postgresql() -> Iterator[str]:
    """URL of a PostgreSQL server."""
    with postgres_server.running() as url:
        yield url


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def new_database(request: pytest.FixtureRequest) -> Iterator[NewDatabase]:
    """Makes an empty database; its URL, or None for SQLite in a store's own folder."""
    if request.param == "sqlite":
        yield lambda: None
        return
    server = request.getfixturevalue("postgresql")
    names: list[str] = []

    def create() -> str:
        names.append(f"test-{uuid.uuid4().hex}")
        return postgres_server.create(server, names[-1])

    yield create
    for name in names:
        postgres_server.drop(server, name)
