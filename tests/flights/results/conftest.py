from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from known_flights import store_flight
from sqlalchemy.orm import Session, sessionmaker

from padstudio.store.database.engine import Sessions, open_database
from padstudio.store.database.flight_tables import FlightRow


@pytest.fixture(scope="module")
def session(
    tmp_path_factory: pytest.TempPathFactory, new_database: Callable[[], str | None]
) -> Iterator[sessionmaker[Session]]:
    folder = tmp_path_factory.mktemp("figures")
    engine = open_database(new_database() or f"sqlite:///{folder}/studio.db")
    yield Sessions(engine)
    engine.dispose()


@pytest.fixture(scope="module")
def flown(session: sessionmaker[Session]) -> tuple[FlightRow, list[dict[str, Any]]]:
    """A flight with its frames."""
    return store_flight(session)
