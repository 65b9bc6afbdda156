"""Settings of the whole suite."""

from __future__ import annotations

import logging
import os
from pathlib import Path

import pytest
from hypothesis import settings

#: Network cameras; a test that asks for a database runs on SQLite and on PostgreSQL.
pytest_plugins = ["store_fixtures", "camera_server", "http_camera"]

# The same examples every time, and no verdict by the clock: the suite must not depend on luck or
# on the machine's load.
settings.register_profile("padstudio", derandomize=True, deadline=None, max_examples=60)
settings.load_profile("padstudio")

#: Folders whose files take long, in the order in which they begin; short ones even out the end.
_FIRST = ("browser", "flights", "cli", "live", "web", "workers", "simulate", "media")


@pytest.fixture(autouse=True)
def logs_as_before() -> None:
    """Commands with ``--quiet`` silence the log of their process, which is that of other tests."""
    logging.getLogger("padstudio").setLevel(logging.NOTSET)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files that take long begin first, those of a folder one after the other.

    What a folder's tests share is then made once by each worker.
    """
    here = Path(__file__).parent

    def place(item: pytest.Item) -> int:
        folder = item.path.relative_to(here).parts[0]
        return _FIRST.index(folder) if folder in _FIRST else len(_FIRST)

    items.sort(key=place)


def pytest_xdist_auto_num_workers() -> int:
    """One worker more than processors: tests wait for browsers, cameras and other processes."""
    return (os.cpu_count() or 1) + 1
