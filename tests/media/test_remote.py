"""Files where workers reach them: here, in a shared folder, or behind a URL."""

from __future__ import annotations

from pathlib import Path

import pytest

from padstudio.errors import StorageError
from padstudio.media.remote import Storage, local_path, open_source, read_bytes


@pytest.fixture
def upload(tmp_path: Path) -> Path:
    path = tmp_path / "uploads" / "ab12"
    path.parent.mkdir()
    path.write_bytes(b"frames")
    return path


def test_without_a_storage_files_stay_where_they_are(upload: Path) -> None:
    assert Storage().place(upload) == str(upload)


def test_files_are_copied_once_to_a_shared_folder(upload: Path, tmp_path: Path) -> None:
    storage = Storage(f"{tmp_path}/shared/")
    url = storage.place(upload)
    assert read_bytes(url, 100) == b"frames"
    first = Path(url).stat().st_mtime_ns
    assert storage.place(upload) == url
    assert Path(url).stat().st_mtime_ns == first
    # A copy that was cut short is made again.
    Path(url).write_bytes(b"fra")
    storage.place(upload)
    assert read_bytes(url, 100) == b"frames"


def test_urls(upload: Path) -> None:
    url = Storage("memory://bucket/flights").place(upload)
    assert url == "memory://bucket/flights/ab12"
    assert read_bytes(url, 100) == b"frames"
    assert read_bytes(url, 2) == b"fra"
    assert local_path(url) is None
    assert local_path(upload.as_uri()) == upload


@pytest.mark.parametrize("source", ["/nowhere/a.mp4", "memory://nowhere/a.mp4"])
def test_what_is_out_of_reach_says_what_to_set(source: str) -> None:
    with pytest.raises(StorageError, match="PADSTUDIO_STORAGE") as caught, open_source(source):
        raise AssertionError("there is nothing to open")
    assert caught.value.error_code == "source_unreachable"


def test_a_storage_that_cannot_be_written(upload: Path, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(StorageError, match="cannot copy"):
        Storage(f"{tmp_path}/file/folder").place(upload)
