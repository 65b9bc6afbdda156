"""Points in time come back in UTC, whatever the database keeps."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

from store_fixtures import NewDatabase

from padstudio.store.store import Store
from padstudio.web.http import tus


def test_times_are_read_in_utc(tmp_path: Path, new_database: NewDatabase) -> None:
    store = Store(tmp_path / "data", new_database())
    upload = store.uploads.get(store.uploads.create("a.mp4", 10).id)
    assert upload.expires_at is not None
    assert upload.expires_at.tzinfo is UTC
    assert upload.expires_at > datetime.now(UTC)
    # As a header of HTTP, which knows no other zone.
    assert tus.describe(upload)["Upload-Expires"].endswith(" GMT")
    store.close()
