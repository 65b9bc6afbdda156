"""Revisions of the database: what they build, and what they make of an older one's rows."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.migration import MigrationContext
from sqlalchemy import insert, select

from padstudio.store import migrations
from padstudio.store.database.engine import NEWEST_REVISION, open_database
from padstudio.store.database.flight_tables import (
    ChunkRow,
    FlightRow,
    FrameBinRow,
    FrameDetailRow,
    FrameRow,
)
from padstudio.store.database.tables import Base

NewDatabase = Callable[[], str | None]
FOLDER = Path(migrations.__file__).parent
FIRST_FRAME, STRIDE, FRAMES, DAMAGED = 5, 2, 250, 145


def test_a_revision_takes_nothing_from_the_program_which_goes_on_changing() -> None:
    sources = [path.read_text(encoding="utf-8") for path in FOLDER.rglob("*.py")]
    assert len(sources) >= 7
    assert not [source for source in sources if "padstudio" in source]


def test_revisions_build_what_the_program_expects(
    tmp_path: Path, new_database: NewDatabase
) -> None:
    engine = open_database(new_database() or f"sqlite:///{tmp_path / 'a.db'}")
    with engine.connect() as connection:
        context = MigrationContext.configure(connection)
        assert compare_metadata(context, Base.metadata) == []
        assert context.get_current_revision() == NEWEST_REVISION
    engine.dispose()


def frame(place: int) -> dict[str, Any]:
    """A row of the table of frames; every third has no pose, and so have those from 30 to 40."""
    ok = place % 3 > 0 and not 30 <= place <= 40
    return {
        "flight": 1,
        "number": FIRST_FRAME + STRIDE * place,
        "time_s": place / 4,
        "status": "ok" if ok else "failed",
        "stage": None if ok else ("lines", "grid")[place % 2],
        "reason": None if ok else "no_lattice",
        "layer": "red" if ok else None,
        "x_mm": 0.0 if ok else None,
        "y_mm": 0.0 if ok else None,
        "z_mm": 1000.0 + place if ok else None,
    }


def body(place: int) -> dict[str, Any]:
    """The rest of it: how sure the first frames and the last are, of others nothing."""
    number = FIRST_FRAME + STRIDE * place
    told = {"damaged": True} if number == DAMAGED else {}
    if place < 10:
        return told | {"position_sigma_mm": [20.0, 20.0, 1.0], "attitude_sigma_deg": [1.0] * 3}
    if place >= FRAMES - 10:
        return told | {"position_sigma_mm": [40.0, 40.0, 1.0], "attitude_sigma_deg": [1.0] * 3}
    return told


def older_database(url: str) -> None:
    """One flight as the third revision kept it."""
    engine = open_database(url)
    config = Config()
    config.set_main_option("script_location", str(FOLDER))
    flight = {
        "key": 1, "id": "old", "created_at": datetime.now(UTC), "name": "old", "state": "done",
        "request": {"first_frame": FIRST_FRAME, "stride": STRIDE}, "sources": [], "pad": "",
        "camera": "",
    }  # fmt: skip
    chunk = {"id": 1, "flight": 1, "number": 1, "state": "done"}
    rows = [frame(place) for place in range(FRAMES)]
    details = [
        {
            "flight": 1,
            "number": row["number"],
            "chunk": 1,
            "body": body(place),
        }
        for place, row in enumerate(rows)
    ]
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.downgrade(config, "0003")
        connection.execute(insert(FlightRow), [flight])
        connection.execute(insert(ChunkRow), [chunk])
        connection.execute(insert(FrameRow), rows)
        connection.execute(insert(FrameDetailRow), details)
    engine.dispose()


def test_flights_of_an_older_database_get_their_bins(
    tmp_path: Path, new_database: NewDatabase
) -> None:
    url = new_database() or f"sqlite:///{tmp_path / 'studio.db'}"
    older_database(url)
    engine = open_database(url)
    with engine.connect() as connection:
        chosen = select(*FrameBinRow.__table__.c).order_by(FrameBinRow.first_frame)
        found = [dict(row) for row in connection.execute(chosen).mappings()]
        qualities = connection.scalars(select(FrameRow.quality).order_by(FrameRow.number)).all()
    engine.dispose()
    assert [(row["first_frame"], row["last_frame"], row["frames"]) for row in found] == [
        (5, 203, 100),
        (205, 403, 100),
        (405, 503, 50),
    ]
    first = found[0]
    assert (first["flight"], first["ok"], first["time_s"]) == (1, 59, 0.0)
    assert (first["z_min_mm"], first["z_max_mm"]) == (1001.0, 1098.0)
    assert first["body"] == {
        "layers": {"red": 59},
        "stages": {"lines": 21, "grid": 20},
        "reasons": {"no_lattice": 41},
        # The first pose, the two farthest apart, the last.
        "poses": [7, 63, 87, 201],
        "damaged": 1,
        "bearings": {},
        "unknown": 53,
    }
    assert qualities[:10] == ["full" if place % 3 else None for place in range(10)]
    assert set(qualities[10:-10]) == {None}
    assert qualities[-10:] == ["bearing" if place % 3 else None for place in range(240, 250)]
    assert found[-1]["body"]["bearings"] == {"red": 6}
    assert [row["body"]["damaged"] for row in found[1:]] == [0, 0]
    assert sum(row["ok"] for row in found) == 159
