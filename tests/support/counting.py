"""Counts in a database, reading before writing as claims do: counting.py URL THREADS TIMES."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor

from sqlalchemy import select, update

from padstudio.store.database.engine import Sessions, open_database
from padstudio.store.database.tables import TraceRow


def count(sessions: Sessions, times: int) -> None:
    """Raise the size of the one trace by one, so many times."""
    for _ in range(times):
        with sessions.begin() as session:
            size = session.scalars(select(TraceRow.size_bytes)).one()
            session.execute(update(TraceRow).values(size_bytes=size + 1))


def count_in_threads(url: str, threads: int, times: int) -> None:
    """Count in several threads at once; raises what the first of them raises."""
    engine = open_database(url)
    sessions = Sessions(engine)
    with ThreadPoolExecutor(threads) as pool:
        for done in [pool.submit(count, sessions, times) for _ in range(threads)]:
            done.result()
    engine.dispose()


if __name__ == "__main__":
    count_in_threads(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
