"""Uploads that find no room, or are of no use."""

from __future__ import annotations

import hashlib
import io
import os
import shutil
import zipfile
from pathlib import Path
from typing import NamedTuple

import pytest
from upload_senders import MP4, add, files, picture, send

from padstudio.errors import (
    BusyError,
    ImageError,
    LimitError,
    NotFoundError,
    StorageError,
)
from padstudio.media.content import ContentError
from padstudio.store.uploads.uploads import Uploads


class _Usage(NamedTuple):
    total: int
    used: int
    free: int


def test_room_is_reserved(uploads: Uploads, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(LimitError) as caught:
        uploads.create("a", 100_001)
    assert caught.value.detail == {"max_bytes": 100_000}
    with pytest.raises(ContentError) as empty:
        uploads.create("a", 0)
    assert empty.value.error_code == "empty_file"
    send(uploads, MP4)
    send(uploads, MP4)
    uploads.create("a", 100_000)
    with pytest.raises(StorageError) as full:
        uploads.create("b", 100_000 - len(MP4) + 1)
    assert full.value.error_code == "quota_exceeded"
    monkeypatch.setattr(shutil, "disk_usage", lambda _: _Usage(10**6, 0, 150_000))
    with pytest.raises(StorageError) as full:
        uploads.create("b", 50_001)
    assert full.value.error_code == "disk_full"
    uploads.create("b", 50_000)
    monkeypatch.undo()
    uploads.create("c", 1)
    with pytest.raises(BusyError) as busy:
        uploads.create("d", 1)
    assert busy.value.error_code == "too_many_uploads"


def test_a_full_disk_takes_back_what_it_did_not_take_whole(
    uploads: Uploads, monkeypatch: pytest.MonkeyPatch
) -> None:
    upload_id = uploads.create("a", len(MP4)).id
    add(uploads, upload_id, 0, MP4[:10])
    append = uploads.append(upload_id, 10)
    append.write(MP4[10:100])
    with open("/dev/full", "ab", buffering=0) as full:
        monkeypatch.setattr(append, "_file", full)
        with pytest.raises(OSError, match=os.strerror(28)):
            append.write(MP4[100:200])
        monkeypatch.undo()
    append.close()
    assert uploads.get(upload_id).offset == 10
    add(uploads, upload_id, 10, MP4[10:])
    assert uploads.finish(upload_id).sha256 == hashlib.sha256(MP4).hexdigest()


def test_content_of_no_use_is_known_by_its_first_bytes(uploads: Uploads) -> None:
    upload_id = uploads.create("flight.mp4", 90_000).id
    append = uploads.append(upload_id, 0)
    append.write(b"Dear diary" * 400)
    with pytest.raises(ContentError, match="no kind that can be read"):
        append.write(b"Dear diary" * 100)
    append.close()


def _zip(**entries: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries.items():
            archive.writestr(name.replace("_", "."), data)
    return file.getvalue()


@pytest.mark.parametrize(
    ("data", "error", "code"),
    [
        (b"Dear diary", ContentError, "unknown_content"),
        (picture(200, 100), LimitError, "too_many_pixels"),
        (b"\xff\xd8\xff and no more", ImageError, "not_an_image"),
        (b"1\n00:00:00,000 --> 00:00:00,033\n" + b"x" * 500, LimitError, "limit_exceeded"),
        (_zip(a_png=bytes(90_000)), LimitError, "zip_bomb"),
        (_zip(a_txt=b"text"), ContentError, "empty_zip"),
    ],
)
def test_content_of_no_use_is_not_kept(
    uploads: Uploads, tmp_path: Path, data: bytes, error: type[Exception], code: str
) -> None:
    upload_id = uploads.create("flight.mp4", len(data)).id
    add(uploads, upload_id, 0, data)
    with pytest.raises(error) as caught:
        uploads.finish(upload_id)
    assert getattr(caught.value, "error_code", None) == code
    assert files(tmp_path) == []
    with pytest.raises(NotFoundError):
        uploads.get(upload_id)
