"""Uploads of files that are on this machine already."""

from __future__ import annotations

from pathlib import Path

from padstudio.store.uploads.rows import Upload
from padstudio.store.uploads.uploads import Uploads

_BLOCK_BYTES = 1 << 20


def upload_file(uploads: Uploads, path: Path, name: str) -> Upload:
    """Copy a file into the uploads, as if it had been sent; a failed one leaves nothing.

    Parameters
    ----------
    uploads : Uploads
    path : Path
    name : str
        Shown to people.

    Raises
    ------
    ContentError, LimitError, StorageError, BusyError
        As `Uploads.create` and `Uploads.finish`.
    """
    upload = uploads.create(name, path.stat().st_size)
    try:
        append = uploads.append(upload.id, 0)
        try:
            with path.open("rb") as file:
                while block := file.read(_BLOCK_BYTES):
                    append.write(block)
            append.commit()
        finally:
            append.close()
    except BaseException:
        uploads.delete(upload.id)
        raise
    return uploads.finish(upload.id)
