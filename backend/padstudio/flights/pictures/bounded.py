"""A folder of files that can be made again, and may take so much disk."""

from __future__ import annotations

import contextlib
import shutil
import threading
import time
from pathlib import Path

# What all files take is summed up no more often.
_TRIM_EVERY_S = 10.0


class BoundedFolder:
    """Folders of files; those that were not looked at for longest go first.

    Who reads a file sets its time of change.

    Parameters
    ----------
    root : Path
        Made where it is missing.
    keep_bytes : int
        What all files may take.
    is_emptied : bool
        Begin with nothing.
    """

    def __init__(self, root: Path, keep_bytes: int, *, is_emptied: bool = False) -> None:
        if is_emptied:
            shutil.rmtree(root, ignore_errors=True)
        root.mkdir(parents=True, exist_ok=True)
        self.root, self._keep_bytes = root, keep_bytes
        self._lock = threading.Lock()
        self._trimmed_s = -_TRIM_EVERY_S

    def trim(self) -> None:
        """Remove what is too much; called often, looks seldom."""
        with self._lock:
            now_s = time.monotonic()
            if now_s - self._trimmed_s < _TRIM_EVERY_S:
                return
            self._trimmed_s = now_s
            files = sorted(self._files())
            size = sum(bytes_ for _, bytes_, _ in files)
            for _, bytes_, path in files:
                if size <= self._keep_bytes:
                    return
                path.unlink(missing_ok=True)
                size -= bytes_

    def _files(self) -> list[tuple[float, int, Path]]:
        """Time of the last look, bytes and path of each file."""
        found = []
        for path in self.root.glob("*/*"):
            with contextlib.suppress(OSError):
                stat = path.stat()
                found.append((stat.st_mtime, stat.st_size, path))
        return found
