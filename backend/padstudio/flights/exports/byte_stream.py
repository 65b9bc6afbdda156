"""A place for writers of files to write to, from which the bytes are taken as they come."""

from __future__ import annotations


class ByteStream:
    """Collects what is written; cannot be sought, so that nothing taken has to change."""

    def __init__(self) -> None:
        self._waiting = bytearray()
        self._written = 0

    def write(self, data: bytes | bytearray | memoryview) -> int:
        """Add bytes; how many."""
        size = memoryview(data).nbytes
        self._waiting += data
        self._written += size
        return size

    def tell(self) -> int:
        """How many bytes were written in all."""
        return self._written

    def flush(self) -> None:
        """Nothing waits for this."""

    def close(self) -> None:
        """Nothing to close."""

    def take(self) -> bytes:
        """What was written since the last time."""
        data = bytes(self._waiting)
        self._waiting.clear()
        return data
