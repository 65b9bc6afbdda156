"""The data folder: who may use it, and where its files lie."""

from __future__ import annotations

import errno
import fcntl
import secrets
import shutil
import tempfile
from pathlib import Path
from typing import IO

from padstudio.errors import ConflictError, StorageError


class DataFolder:
    """A folder that one process at a time may use.

    Parameters
    ----------
    root : Path
        Made, for its owner's eyes alone, where it is missing.

    Attributes
    ----------
    root : Path
    traces : Path
        One folder of pictures a trace.
    work : Path
        Work in progress; emptied when the folder is opened.
    uploads : Path
        What was uploaded, whole and in part.
    live : Path
        One folder a live session's recording, named by its id.
    experiments : Path
        One folder an experiment, named by its id.

    Raises
    ------
    StorageError
        If it cannot be made or written.
    ConflictError
        If another process uses it.
    """

    def __init__(self, root: Path) -> None:
        self.root, self.traces, self.work = root, root / "traces", root / "work"
        self.uploads, self.live = root / "uploads", root / "live"
        self.experiments = root / "experiments"
        try:
            root.mkdir(mode=0o700, parents=True, exist_ok=True)
            self.traces.mkdir(exist_ok=True)
            self.work.mkdir(exist_ok=True)
            self.uploads.mkdir(exist_ok=True)
            self.live.mkdir(exist_ok=True)
            self.experiments.mkdir(exist_ok=True)
            self._lock: IO[bytes] = (root / "lock").open("ab")
        except OSError as error:
            raise StorageError(
                f"cannot use the data folder {root}: {_why(error)}; choose another with --data "
                "or PADSTUDIO_DATA",
                code="data_folder_unusable",
            ) from error
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self._lock.close()
            raise ConflictError(
                f"another Pad Studio uses the data folder {root}; stop it, or choose another "
                "folder with --data",
                code="data_folder_in_use",
            ) from error
        # Whatever an earlier process left half done.
        keep_only(self.work, frozenset())

    def close(self) -> None:
        """Let another process use the folder."""
        self._lock.close()

    def work_folder(self) -> Path:
        """A new empty folder in `work`; the caller removes or moves it."""
        return Path(tempfile.mkdtemp(dir=self.work))


def _why(error: OSError) -> str:
    if isinstance(error, FileExistsError | NotADirectoryError):
        return "it, or what it lies in, is a file"
    if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
        return "it cannot be written"
    return error.strerror or str(error)


def new_id() -> str:
    """A new random id of 16 hexadecimal digits."""
    return secrets.token_hex(8)


def keep_only(folder: Path, names: frozenset[str]) -> None:
    """Remove everything in a folder but some names."""
    for entry in folder.iterdir():
        if entry.name not in names:
            remove(entry)


def remove(path: Path) -> None:
    """Remove a file or a folder; it may be gone already."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)
