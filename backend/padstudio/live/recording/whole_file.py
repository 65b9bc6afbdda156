"""A file that is whole at any moment: what was begun and not ended can be cut away."""

from __future__ import annotations

import os
from pathlib import Path
from typing import IO


def open_new(path: Path) -> IO[bytes]:
    """A new file for writing, each write at once."""
    return path.open("xb", buffering=0)


class WholeFile:
    """Written to the end only.

    Parameters
    ----------
    path : Path
        Must not be there.

    Attributes
    ----------
    size : int
        Bytes in it.
    """

    def __init__(self, path: Path) -> None:
        self.size = 0
        self._path = path
        self._whole = 0
        self._fault: OSError | None = None
        self._file: IO[bytes] | None = open_new(path)

    def write(self, data: bytes) -> int:
        """Add bytes; nothing happens once it is closed, or could not be written once."""
        rest = memoryview(data)
        try:
            while rest and self._file is not None and self._fault is None:
                count = self._file.write(rest)
                self.size += count
                rest = rest[count:]
        except OSError as error:
            self._fault = error
            raise
        return len(data)

    def mark(self) -> None:
        """What is there is whole.

        Raises
        ------
        OSError
            That of a write that failed, whoever met it.
        """
        if self._fault is not None:
            raise self._fault
        self._whole = self.size

    def sync(self) -> None:
        """Have what is there survive a power cut."""
        if self._file is not None:
            os.fsync(self._file.fileno())

    def cut(self) -> None:
        """Close it at the last mark; a file without one goes."""
        if self._file is None:
            return
        file, self._file = self._file, None
        try:
            os.truncate(file.fileno(), self._whole)
        finally:
            file.close()
        self.size = self._whole
        if not self._whole:
            self._path.unlink(missing_ok=True)

    def close(self) -> None:
        """Keep all of it."""
        if self._file is not None:
            file, self._file = self._file, None
            file.close()
