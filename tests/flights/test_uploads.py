from __future__ import annotations

import hashlib
import io
import os
import shutil
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import pytest

from padstudio.errors import (
    BusyError,
    ConflictError,
    ImageError,
    LimitError,
    NotFoundError,
    StorageError,
)
from padstudio.flights import upload_files
from padstudio.flights.content import ContentError
from padstudio.flights.store import Store
from padstudio.flights.upload_files import Checksum, ChecksumError
from padstudio.flights.upload_limits import UploadLimits
from padstudio.flights.uploads import Uploads

MP4 = b"\0\0\0\x20ftypisom" + bytes(range(256)) * 40
LIMITS = UploadLimits(
    file_bytes=100_000, total_bytes=200_000, unfinished=3, still_pixels=10_000, telemetry_bytes=500
)


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


def _append(uploads: Uploads, upload_id: str, offset: int, data: bytes) -> None:
    append = uploads.append(upload_id, offset)
    append.write(data)
    append.commit()
    append.close()


def _write_and_die(
    uploads: Uploads, upload_id: str, offset: int, data: bytes, checksum: Checksum | None = None
) -> None:
    """What a killed process does: neither committed nor closed, but by the system."""
    append = uploads.append(upload_id, offset, checksum)
    append.write(data)
    append._file.close()


def _send(uploads: Uploads, data: bytes, name: str = "a") -> str:
    upload_id = uploads.create(name, len(data)).id
    _append(uploads, upload_id, 0, data)
    uploads.finish(upload_id)
    return upload_id


def _files(tmp_path: Path) -> list[str]:
    root = tmp_path / "data" / "uploads"
    return sorted(path.relative_to(root).parts[0] for path in root.rglob("*") if path.is_file())


def _picture(width: int, height: int) -> bytes:
    return cv2.imencode(".png", np.zeros((height, width, 3), np.uint8))[1].tobytes()


def test_bytes_arrive_in_parts_and_become_a_file(uploads: Uploads) -> None:
    upload = uploads.create("flight.mp4", len(MP4))
    assert (upload.complete, upload.offset) == (False, 0)
    _append(uploads, upload.id, 0, MP4[:5000])
    assert uploads.finish(upload.id).complete is False
    assert uploads.get(upload.id).offset == 5000
    with pytest.raises(ConflictError, match="5000 of 10252") as caught:
        uploads.path(upload.id)
    assert caught.value.error_code == "upload_incomplete"
    _append(uploads, upload.id, 5000, MP4[5000:])
    done = uploads.finish(upload.id)
    assert (done.complete, done.kind, done.media_type) == (True, "video", "video/mp4")
    assert done.sha256 == hashlib.sha256(MP4).hexdigest()
    assert uploads.path(upload.id).read_bytes() == MP4
    assert uploads.finish(upload.id) == done
    assert uploads.list(10) == ([done], 1)


@pytest.mark.parametrize("offset", [0, 101, 99])
def test_another_offset_is_refused(uploads: Uploads, offset: int) -> None:
    upload_id = uploads.create("a", len(MP4)).id
    _append(uploads, upload_id, 0, MP4[:100])
    with pytest.raises(ConflictError) as caught:
        uploads.append(upload_id, offset)
    assert (caught.value.error_code, caught.value.detail) == ("offset_mismatch", {"offset": 100})


def test_nothing_is_added_to_a_complete_upload(uploads: Uploads) -> None:
    upload_id = _send(uploads, MP4)
    with pytest.raises(ConflictError) as caught:
        uploads.append(upload_id, len(MP4))
    assert caught.value.error_code == "upload_complete"


def test_more_than_announced_is_refused(uploads: Uploads) -> None:
    upload_id = uploads.create("a", 100).id
    append = uploads.append(upload_id, 0)
    with pytest.raises(ConflictError, match="more bytes"):
        append.write(MP4)
    append.close()
    assert uploads.get(upload_id).offset == 0


def test_a_killed_server_loses_nothing_that_is_on_disk(
    open_store: Callable[..., Store],
) -> None:
    uploads = open_store().uploads
    upload_id = uploads.create("a", len(MP4)).id
    _write_and_die(uploads, upload_id, 0, MP4[:7000])
    uploads = open_store().uploads
    assert uploads.get(upload_id).offset == 7000
    _append(uploads, upload_id, 7000, MP4[7000:])
    assert uploads.finish(upload_id).sha256 == hashlib.sha256(MP4).hexdigest()


@pytest.mark.parametrize("algorithm", upload_files.CHECKSUMS)
def test_a_checksum_is_compared(uploads: Uploads, algorithm: str) -> None:
    upload_id = uploads.create("a", len(MP4)).id
    _append(uploads, upload_id, 0, MP4[:10])
    digest = hashlib.new(algorithm, MP4[10:]).digest()
    append = uploads.append(upload_id, 10, Checksum(algorithm, digest))
    append.write(MP4[10:-1] + b"!")
    assert uploads.get(upload_id).offset == 10
    with pytest.raises(ChecksumError):
        append.commit()
    append.close()
    assert uploads.get(upload_id).offset == 10
    append = uploads.append(upload_id, 10, Checksum(algorithm, digest))
    append.write(MP4[10:])
    append.commit()
    append.close()
    assert uploads.finish(upload_id).sha256 == hashlib.sha256(MP4).hexdigest()


def test_bytes_that_wait_for_their_checksum_do_not_survive(
    open_store: Callable[..., Store],
) -> None:
    uploads = open_store().uploads
    upload_id = uploads.create("a", len(MP4)).id
    _append(uploads, upload_id, 0, MP4[:10])
    _write_and_die(uploads, upload_id, 10, MP4[10:900], Checksum("sha1", b""))
    uploads = open_store().uploads
    assert uploads.get(upload_id).offset == 10
    append = uploads.append(upload_id, 10, Checksum("sha1", b""))
    append.write(MP4[10:900])
    # As when the connection breaks.
    append.close()
    assert uploads.get(upload_id).offset == 10


def test_equal_files_are_kept_once(uploads: Uploads, tmp_path: Path) -> None:
    first, second = _send(uploads, MP4, "a"), _send(uploads, MP4, "b")
    assert uploads.path(first) == uploads.path(second)
    assert _files(tmp_path) == ["files"]
    found, total = uploads.list(10, sha256=hashlib.sha256(MP4).hexdigest())
    assert ({upload.id for upload in found}, total) == ({first, second}, 2)
    assert uploads.list(10, sha256="0" * 64) == ([], 0)
    uploads.delete(first)
    assert uploads.path(second).read_bytes() == MP4
    uploads.delete(second)
    assert _files(tmp_path) == []
    with pytest.raises(NotFoundError):
        uploads.delete(second)


def test_unfinished_uploads_expire(open_store: Callable[..., Store], tmp_path: Path) -> None:
    uploads = open_store().uploads
    done, started = _send(uploads, MP4), uploads.create("a", 10).id
    _append(uploads, started, 0, MP4[:5])
    uploads = open_store(UploadLimits(expires_s=-1)).uploads
    assert uploads.get(started).offset == 5
    append = uploads.append(started, 5)
    assert uploads.expire() == 0, "an upload that is being written"
    append.close()
    with pytest.raises(NotFoundError, match="time was over"):
        uploads.get(started)
    assert uploads.expire() == 1
    assert [upload.id for upload in uploads.list(10)[0]] == [done]
    assert _files(tmp_path) == ["files"]


def test_what_nobody_knows_is_removed_at_the_start(
    open_store: Callable[..., Store], tmp_path: Path
) -> None:
    uploads = open_store().uploads
    upload_id = _send(uploads, MP4)
    for folder in ("partial", "files"):
        (tmp_path / "data" / "uploads" / folder / "stray").write_bytes(b"x")
    uploads = open_store().uploads
    assert uploads.path(upload_id).read_bytes() == MP4
    assert _files(tmp_path) == ["files"]


@pytest.mark.parametrize("cut", ["before the move", "after the move", "after the last byte"])
def test_a_cut_while_finishing_is_mended(
    open_store: Callable[..., Store], monkeypatch: pytest.MonkeyPatch, cut: str
) -> None:
    uploads = open_store().uploads
    upload_id = uploads.create("a", len(MP4)).id
    _append(uploads, upload_id, 0, MP4)
    if cut != "after the last byte":
        real = upload_files.UploadFiles.finish

        def stop(self: upload_files.UploadFiles, upload_id: str, sha256: str) -> None:
            if cut == "after the move":
                real(self, upload_id, sha256)
            raise KeyboardInterrupt

        monkeypatch.setattr(upload_files.UploadFiles, "finish", stop)
        with pytest.raises(KeyboardInterrupt):
            uploads.finish(upload_id)
        monkeypatch.undo()
    uploads = open_store().uploads
    assert uploads.get(upload_id).offset == len(MP4)
    assert uploads.finish(upload_id).complete
    assert uploads.path(upload_id).read_bytes() == MP4


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
    _send(uploads, MP4)
    _send(uploads, MP4)
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
    _append(uploads, upload_id, 0, MP4[:10])
    append = uploads.append(upload_id, 10)
    append.write(MP4[10:100])
    with open("/dev/full", "ab", buffering=0) as full:
        monkeypatch.setattr(append, "_file", full)
        with pytest.raises(OSError, match=os.strerror(28)):
            append.write(MP4[100:200])
        monkeypatch.undo()
    append.close()
    assert uploads.get(upload_id).offset == 10
    _append(uploads, upload_id, 10, MP4[10:])
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
        (_picture(200, 100), LimitError, "too_many_pixels"),
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
    _append(uploads, upload_id, 0, data)
    with pytest.raises(error) as caught:
        uploads.finish(upload_id)
    assert getattr(caught.value, "error_code", None) == code
    assert _files(tmp_path) == []
    with pytest.raises(NotFoundError):
        uploads.get(upload_id)
