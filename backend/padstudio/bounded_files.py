"""Reads small files whole: never more than can be one, and no device or pipe."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO


@contextmanager
def open_regular(path: Path) -> Iterator[BinaryIO]:
    """A file to be read; what ``path`` names is looked at once it is open.

    Raises
    ------
    OSError
        If it cannot be opened, or is no regular file.
    """
    # A pipe would otherwise be waited for until somebody writes.
    opened = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    with open(opened, "rb") as file:
        if not stat.S_ISREG(os.fstat(opened).st_mode):
            raise OSError(errno.EINVAL, "it is no regular file", str(path))
        yield file


def read_whole(path: Path, most_bytes: int) -> bytes:
    """The bytes of a file; of a longer one, one more than the most; raises as `open_regular`."""
    with open_regular(path) as file:
        return file.read(most_bytes + 1)
