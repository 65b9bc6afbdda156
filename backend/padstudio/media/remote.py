"""Where the files that workers read lie: a folder, or whatever else fsspec reaches by URL."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO
from urllib.parse import unquote, urlsplit

from padstudio.errors import StorageError

# They have no folders, and would make a bucket of whatever name.
_OBJECT_STORES = frozenset({"s3", "s3a", "gs", "gcs", "az", "abfs"})


def unreachable(source: str) -> StorageError:
    """The error for a stored file that is not there; it goes to pages, so it names no folder."""
    return StorageError(
        f"the file {source.rstrip('/').rsplit('/', 1)[-1]} is gone, or cannot be read from here: "
        "send it again, or, where workers run on other machines, set PADSTUDIO_STORAGE to a folder "
        "or bucket that all of them reach",
        code="source_unreachable",
    )


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
            with _open_remote(source) as remote:
                yield remote
    except (FileNotFoundError, PermissionError) as error:
        raise unreachable(source) from error
    except ImportError as error:
        raise StorageError(
            f"{urlsplit(source).scheme} URLs need a further package: pip install padstudio[s3]",
            code="source_unreachable",
        ) from error


@contextlib.contextmanager
def _open_remote(source: str) -> Iterator[IO[bytes]]:
    import fsspec

    with contextlib.ExitStack() as stack:
        try:
            remote = stack.enter_context(fsspec.open(source, "rb"))
        except (FileNotFoundError, PermissionError, ImportError):
            raise
        # Each of fsspec's file systems has errors of its own, for lost networks and lost keys.
        except Exception as error:
            raise StorageError(
                f"a worker cannot reach {source}: {error}", code="source_unreachable"
            ) from error
        yield remote


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


def at_hand(source: str) -> Path:
    """A file that is read here and there: the path that a source names, or that of a copy of it."""
    path = local_path(source)
    if path is not None:
        return path
    import fsspec

    # One copy a machine, kept while the process lives.
    return Path(fsspec.open_local(f"simplecache::{source}"))


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
                if urlsplit(url).scheme not in _OBJECT_STORES:
                    system.makedirs(target.rpartition("/")[0], exist_ok=True)
                system.put_file(str(path), target)
        # As in `_open_remote`.
        except Exception as error:
            raise StorageError(f"cannot copy an upload to {self._base}: {error}") from error
        return url
