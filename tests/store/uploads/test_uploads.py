from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import pytest
from upload_senders import MP4, add, files, send, write_and_die

from padstudio.errors import (
    ConflictError,
    NotFoundError,
)
from padstudio.store.store import Store
from padstudio.store.uploads import files as upload_files
from padstudio.store.uploads.files import Checksum, ChecksumError
from padstudio.store.uploads.limits import UploadLimits
from padstudio.store.uploads.uploads import Uploads


def test_bytes_arrive_in_parts_and_become_a_file(uploads: Uploads) -> None:
    upload = uploads.create("flight.mp4", len(MP4))
    assert (upload.complete, upload.offset) == (False, 0)
    add(uploads, upload.id, 0, MP4[:5000])
    assert uploads.finish(upload.id).complete is False
    assert uploads.get(upload.id).offset == 5000
    with pytest.raises(ConflictError, match="5000 of 10252") as caught:
        uploads.path(upload.id)
    assert caught.value.error_code == "upload_incomplete"
    add(uploads, upload.id, 5000, MP4[5000:])
    done = uploads.finish(upload.id)
    assert (done.complete, done.kind, done.media_type) == (True, "video", "video/mp4")
    assert done.sha256 == hashlib.sha256(MP4).hexdigest()
    assert uploads.path(upload.id).read_bytes() == MP4
    assert uploads.finish(upload.id) == done
    assert uploads.list(10) == ([done], 1)


@pytest.mark.parametrize("offset", [0, 101, 99])
def test_another_offset_is_refused(uploads: Uploads, offset: int) -> None:
    upload_id = uploads.create("a", len(MP4)).id
    add(uploads, upload_id, 0, MP4[:100])
    with pytest.raises(ConflictError) as caught:
        uploads.append(upload_id, offset)
    assert (caught.value.error_code, caught.value.detail) == ("offset_mismatch", {"offset": 100})


def test_nothing_is_added_to_a_complete_upload(uploads: Uploads) -> None:
    upload_id = send(uploads, MP4)
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
    write_and_die(uploads, upload_id, 0, MP4[:7000])
    uploads = open_store().uploads
    assert uploads.get(upload_id).offset == 7000
    add(uploads, upload_id, 7000, MP4[7000:])
    assert uploads.finish(upload_id).sha256 == hashlib.sha256(MP4).hexdigest()


@pytest.mark.parametrize("algorithm", upload_files.CHECKSUMS)
def test_a_checksum_is_compared(uploads: Uploads, algorithm: str) -> None:
    upload_id = uploads.create("a", len(MP4)).id
    add(uploads, upload_id, 0, MP4[:10])
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
    add(uploads, upload_id, 0, MP4[:10])
    write_and_die(uploads, upload_id, 10, MP4[10:900], Checksum("sha1", b""))
    uploads = open_store().uploads
    assert uploads.get(upload_id).offset == 10
    append = uploads.append(upload_id, 10, Checksum("sha1", b""))
    append.write(MP4[10:900])
    # As when the connection breaks.
    append.close()
    assert uploads.get(upload_id).offset == 10


def test_equal_files_are_kept_once(uploads: Uploads, tmp_path: Path) -> None:
    first, second = send(uploads, MP4, "a"), send(uploads, MP4, "b")
    assert uploads.path(first) == uploads.path(second)
    assert files(tmp_path) == ["files"]
    found, total = uploads.list(10, sha256=hashlib.sha256(MP4).hexdigest())
    assert ({upload.id for upload in found}, total) == ({first, second}, 2)
    assert uploads.list(10, sha256="0" * 64) == ([], 0)
    uploads.delete(first)
    assert uploads.path(second).read_bytes() == MP4
    uploads.delete(second)
    assert files(tmp_path) == []
    with pytest.raises(NotFoundError):
        uploads.delete(second)


def test_unfinished_uploads_expire(open_store: Callable[..., Store], tmp_path: Path) -> None:
    uploads = open_store().uploads
    done, started = send(uploads, MP4), uploads.create("a", 10).id
    add(uploads, started, 0, MP4[:5])
    uploads = open_store(UploadLimits(expires_s=-1)).uploads
    assert uploads.get(started).offset == 5
    append = uploads.append(started, 5)
    assert uploads.expire() == 0, "an upload that is being written"
    append.close()
    with pytest.raises(NotFoundError, match="time was over"):
        uploads.get(started)
    assert uploads.expire() == 1
    assert [upload.id for upload in uploads.list(10)[0]] == [done]
    assert files(tmp_path) == ["files"]


def test_what_nobody_knows_is_removed_at_the_start(
    open_store: Callable[..., Store], tmp_path: Path
) -> None:
    uploads = open_store().uploads
    upload_id = send(uploads, MP4)
    for folder in ("partial", "files"):
        (tmp_path / "data" / "uploads" / folder / "stray").write_bytes(b"x")
    uploads = open_store().uploads
    assert uploads.path(upload_id).read_bytes() == MP4
    assert files(tmp_path) == ["files"]


@pytest.mark.parametrize("cut", ["before the move", "after the move", "after the last byte"])
def test_a_cut_while_finishing_is_mended(
    open_store: Callable[..., Store], monkeypatch: pytest.MonkeyPatch, cut: str
) -> None:
    uploads = open_store().uploads
    upload_id = uploads.create("a", len(MP4)).id
    add(uploads, upload_id, 0, MP4)
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
