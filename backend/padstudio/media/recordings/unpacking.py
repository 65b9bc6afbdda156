"""Takes recordings' compressed parts apart, never to more bytes than a limit."""

from __future__ import annotations

import bz2
import io
from collections.abc import Iterator
from typing import IO

from padstudio.errors import LimitError, shown

#: Begins Zstandard's frames (RFC 8878, 3.1.1); no serialised ROS 2 message begins so.
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
# Unpacked at a time, so that memory grows with what really comes out.
_BLOCK_BYTES = 4 << 20


class UnpackError(ValueError):
    """Compressed bytes are damaged, or more than they should be."""


def unpack(data: bytes, compression: str, limit: int) -> bytes:
    """Decompress.

    Parameters
    ----------
    data : bytes
    compression : str
        ``zstd``, ``lz4`` (frames), ``bz2``, or ``none`` or empty.
    limit : int
        Bytes that may come out.

    Raises
    ------
    UnpackError
        If more would come out, they are damaged, or the compression is unknown.
    """
    if compression in ("", "none"):
        return data
    if compression not in _BLOCKS:
        raise UnpackError(f"its compression {shown(compression)} is unknown")
    out = bytearray()
    try:
        for block in _BLOCKS[compression](data):
            out += block
            if len(out) > limit:
                raise UnpackError(f"it unpacks to more than {limit / 1e6:.3g} MB")
    except (OSError, EOFError, RuntimeError) as error:
        raise UnpackError(str(error)) from error
    return bytes(out)


def _zstd(data: bytes) -> Iterator[bytes]:
    yield from _zstd_blocks(io.BytesIO(data))


def _zstd_blocks(file: IO[bytes]) -> Iterator[bytes]:
    import zstandard

    try:
        with zstandard.ZstdDecompressor().stream_reader(file, closefd=False) as reader:
            while block := reader.read(_BLOCK_BYTES):
                yield block
    except zstandard.ZstdError as error:
        raise UnpackError(str(error)) from error


def _lz4(data: bytes) -> Iterator[bytes]:
    import lz4.frame

    reader = lz4.frame.LZ4FrameDecompressor()
    yield reader.decompress(data, _BLOCK_BYTES)
    while not (reader.eof or reader.needs_input):
        yield reader.decompress(b"", _BLOCK_BYTES)


def _bz2(data: bytes) -> Iterator[bytes]:
    reader = bz2.BZ2Decompressor()
    yield reader.decompress(data, _BLOCK_BYTES)
    while not (reader.eof or reader.needs_input):
        yield reader.decompress(b"", _BLOCK_BYTES)


_BLOCKS = {"zstd": _zstd, "lz4": _lz4, "bz2": _bz2}


def unpack_file(source: IO[bytes], target: IO[bytes], limit: int) -> None:
    """Decompress a file of Zstandard into another, as far as it is whole.

    Raises
    ------
    UnpackError
        If nothing of it is.
    LimitError
        If more than `limit` bytes would come out.
    """
    written = 0
    try:
        for block in _zstd_blocks(source):
            written += len(block)
            if written > limit:
                raise LimitError(
                    f"the recording unpacks to more than {limit / 1e9:g} GB, the limit",
                    code="recording_too_large",
                )
            target.write(block)
    except UnpackError:
        if not written:
            raise
