"""Where the files that workers read lie: a folder, or whatever else fsspec reaches by URL."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO
from urllib.parse import unquote, urlsplit

from padstudio.errors import StorageError


@contextlib.contextmanager
def open_source(source: str, *, as_file: bool = False) -> Iterator[str | IO[bytes]]:
    """A stored file, ready to be read.

    Parameters
    ----------
    source : str
        A path, or a URL such as ``s3://bucket/key``.
    as_file : bool
        Give a file object in any case.

    Yields
    ------
    str or file
        The path where the file is local, which readers take faster; else a seekable file.

    Raises
    ------
    StorageError
        If it cannot be reached from here.
    """
    path = local_path(source)
    try:
        if path is not None and not as_file:
            path.stat()
            yield str(path)
        elif path is not None:
            with path.open("rb") as file:
                yield file
        else:
            import fsspec

            with fsspec.open(source, "rb") as remote:
                yield remote
    except (FileNotFoundError, PermissionError) as error:
        raise StorageError(
            f"a worker cannot read {source}: where workers run on other machines, set "
            "PADSTUDIO_STORAGE to a folder or bucket that all of them reach",
            code="source_unreachable",
        ) from error
    except ImportError as error:
        raise StorageError(
            f"{urlsplit(source).scheme} URLs need a further package: pip install padstudio[s3]",
            code="source_unreachable",
        ) from error


def read_bytes(source: str, max_bytes: int) -> bytes:
    """A whole stored file, at most `max_bytes` and one more; raises as `open_source`."""
    with open_source(source, as_file=True) as file:
        assert not isinstance(file, str)
        return file.read(max_bytes + 1)


def local_path(source: str) -> Path | None:
    """The path that a source names; None where it is not on this machine."""
    scheme, _, rest = source.partition("://")
    if not rest:
        return Path(source)
    return Path(unquote(urlsplit(source).path)) if scheme == "file" else None


class Storage:
    """Brings files where the workers reach them.

    Parameters
    ----------
    base : str or None
        A folder or URL that all workers read; None where they run on this machine, and read the
        files where they are.
    """

    def __init__(self, base: str | None = None) -> None:
        self._base = base.rstrip("/") if base else None

    def place(self, path: Path) -> str:
        """The URL of a file for workers; it is copied there where it is not yet.

        Parameters
        ----------
        path : Path
            Named by its content, so that equal names mean equal files.

        Raises
        ------
        StorageError
            If it cannot be copied.
        """
        if self._base is None:
            return str(path)
        import fsspec

        url = f"{self._base}/{path.name}"
        try:
            system, target = fsspec.core.url_to_fs(url)
            if not system.exists(target) or system.size(target) != path.stat().st_size:
                system.makedirs(target.rpartition("/")[0], exist_ok=True)
                system.put_file(str(path), target)
        except (OSError, ImportError, ValueError) as error:
            raise StorageError(f"cannot copy an upload to {self._base}: {error}") from error
        return url
