"""Databases and stores; a test that asks for a database runs on SQLite and on PostgreSQL."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Iterator
from pathlib import Path

import postgres_server
import pytest
from upload_senders import LIMITS

from padstudio.store.store import Store
from padstudio.store.uploads.limits import UploadLimits
from padstudio.store.uploads.uploads import Uploads

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


@pytest.fixture
def open_store(tmp_path: Path) -> Iterator[Callable[..., Store]]:
    """Opens the store of one folder, as often as a server starts."""
    stores: list[Store] = []

    def open_it(limits: UploadLimits = LIMITS) -> Store:
        for store in stores:
            store.close()
        stores.append(Store(tmp_path / "data", upload_limits=limits))
        return stores[-1]

    yield open_it
    stores[-1].close()


@pytest.fixture
def uploads(open_store: Callable[..., Store]) -> Uploads:
    return open_store().uploads
