from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from sqlalchemy.exc import SQLAlchemyError

from padstudio.errors import ConflictError, NotFoundError, StorageError
from padstudio.store.store import Store, new_id

NewDatabase = Callable[[], str | None]
SUMMARY = {"name": "a", "seed": 10**30}


@pytest.fixture
def store(tmp_path: Path, new_database: NewDatabase) -> Iterator[Store]:
    store = Store(tmp_path / "data", new_database(), keep_traces=3, keep_trace_bytes=1000)
    yield store
    store.close()


def _trace(store: Store, size_bytes: int = 10) -> str:
    folder, trace_id = store.folder.work_folder(), new_id()
    (folder / "result.png").write_bytes(bytes(size_bytes))
    store.traces.add(trace_id, folder, {"id": trace_id})
    return trace_id


def test_add_get_list_delete(store: Store) -> None:
    first, second = store.pads.add("{1}", SUMMARY), store.pads.add("{2}", SUMMARY)
    assert store.pads.get(first.id) == first
    listed, total = store.pads.list(10, 0)
    assert [item.id for item in listed] == [second.id, first.id]
    assert (listed[0].content, listed[0].summary, total) == (None, SUMMARY, 2)
    assert [item.id for item in store.pads.list(1, 1)[0]] == [first.id]
    assert store.cameras.list(10, 0) == ([], 0)
    store.pads.delete(first.id)
    for act in (store.pads.get, store.pads.delete):
        with pytest.raises(NotFoundError, match="no pad"):
            act(first.id)


def test_the_same_file_again_is_the_one_that_is_there(store: Store) -> None:
    first = store.pads.add("{1}", SUMMARY)
    again = store.pads.add("{1}", {"name": "other"})
    assert (again.id, again.summary, again.was_known) == (first.id, SUMMARY, True)
    assert not store.cameras.add("{1}", SUMMARY).was_known
    assert store.pads.list(10, 0)[1] == 1
    store.pads.delete(first.id)
    assert store.pads.add("{1}", SUMMARY).id != first.id


def test_a_name_that_only_one_has_is_as_good_as_its_id(store: Store) -> None:
    roof = store.pads.add("{1}", {"name": "roof 'ü'"})
    twins = [store.pads.add(f"{{{number}}}", {"name": "yard"}) for number in (2, 3)]
    assert store.pads.get("roof 'ü'").id == roof.id
    with pytest.raises(ConflictError, match="several pads are called 'yard'") as refusal:
        store.pads.get("yard")
    assert refusal.value.error_code == "ambiguous_name"
    store.pads.delete(twins[0].id)
    assert store.pads.get("yard").id == twins[1].id
    named_as_id = store.pads.add("{4}", {"name": roof.id})
    assert store.pads.get(roof.id).id == roof.id
    assert store.pads.get(named_as_id.id).id == named_as_id.id
    for nobody in ("", "roo", "ROOF 'Ü'", "%"):
        with pytest.raises(NotFoundError):
            store.pads.get(nobody)


def test_everything_survives_a_restart(tmp_path: Path, new_database: NewDatabase) -> None:
    url = new_database()
    store = Store(tmp_path, url)
    pad, camera = store.pads.add("pad", SUMMARY), store.cameras.add("camera", SUMMARY)
    trace = _trace(store)
    store.close()
    store = Store(tmp_path, url)
    assert store.pads.get(pad.id) == pad
    assert store.pads.get(pad.id).created_at.utcoffset() is not None
    assert store.cameras.get(camera.id) == camera
    assert store.traces.body(trace) == {"id": trace}
    assert store.traces.picture(trace, "result.png").stat().st_size == 10
    store.close()


def test_a_folder_has_one_user_at_a_time(store: Store) -> None:
    with pytest.raises(ConflictError, match="--data"):
        Store(store.folder.root)


def test_the_folder_is_its_owners_alone(store: Store) -> None:
    assert store.folder.root.stat().st_mode & 0o077 == 0


def test_a_folder_that_cannot_be(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(StorageError, match="PADSTUDIO_DATA"):
        Store(tmp_path / "file")


def test_half_done_work_is_removed_when_opened(tmp_path: Path) -> None:
    store = Store(tmp_path)
    kept = _trace(store)
    (store.folder.work_folder() / "half").touch()
    (store.folder.traces / "stranger").mkdir()
    store.close()
    Store(tmp_path).close()
    assert [path.name for path in (tmp_path / "traces").iterdir()] == [kept]
    assert not list((tmp_path / "work").iterdir())


def test_the_oldest_traces_go_by_number(store: Store) -> None:
    ids = [_trace(store) for _ in range(5)]
    assert {path.name for path in store.folder.traces.iterdir()} == set(ids[2:])
    with pytest.raises(NotFoundError):
        store.traces.body(ids[1])


def test_the_oldest_traces_go_by_size_but_never_the_newest(store: Store) -> None:
    old, big = _trace(store, 600), _trace(store, 500)
    with pytest.raises(NotFoundError):
        store.traces.picture(old, "result.png")
    huge = _trace(store, 5000)
    assert {path.name for path in store.folder.traces.iterdir()} == {huge}
    assert big != huge


def test_a_trace_that_cannot_be_kept_leaves_nothing(store: Store) -> None:
    kept = _trace(store)
    folder = store.folder.work_folder()
    # Either driver's own error for what is no JSON.
    with pytest.raises((SQLAlchemyError, TypeError)):
        store.traces.add(new_id(), folder, {"not": object()})
    assert [path.name for path in store.folder.traces.iterdir()] == [kept]
    assert not list(store.folder.work.iterdir())


def test_pictures_are_found_by_name_only(store: Store) -> None:
    trace_id = _trace(store)
    for name in ("../../padstudio.db", "/etc/hostname", "", ".", "Result.png"):
        with pytest.raises(NotFoundError):
            store.traces.picture(trace_id, name)


def test_a_database_of_a_later_version_is_left_alone(tmp_path: Path) -> None:
    Store(tmp_path).close()
    with sqlite3.connect(tmp_path / "padstudio.db") as database:
        database.execute("UPDATE alembic_version SET version_num = '9999'")
    database.close()
    with pytest.raises(StorageError, match="later version"):
        Store(tmp_path)


@pytest.mark.parametrize("url", ["nonsense", "sqlite:////no/such/folder/a.db", "none://x/y"])
def test_databases_that_cannot_be_opened(tmp_path: Path, url: str) -> None:
    with pytest.raises(StorageError):
        Store(tmp_path, url)
    Store(tmp_path).close()


def test_a_file_that_is_no_database(tmp_path: Path) -> None:
    (tmp_path / "padstudio.db").write_bytes(b"not a database at all" * 100)
    with pytest.raises(StorageError, match="is damaged"):
        Store(tmp_path)
