"""Opens recordings of whatever kind: files, folders of ROS 2 bags, zips and packed files."""

from __future__ import annotations

import contextlib
import hashlib
import heapq
import os
import shutil
import tempfile
import time
import zipfile
from collections.abc import Collection, Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from padstudio.errors import LimitError, StorageError
from padstudio.geometry.camera_files.parts import yaml_text
from padstudio.media.content import ContentError
from padstudio.media.recordings import bag1, mcap_file, sqlite_file
from padstudio.media.recordings.bag1 import Bag1File
from padstudio.media.recordings.mcap_file import McapFile
from padstudio.media.recordings.sqlite_file import SqliteFile
from padstudio.media.recordings.storage import Channel, Message, RecordingError, Storage, Tell
from padstudio.media.recordings.unpacking import ZSTD_MAGIC, UnpackError, unpack_file
from padstudio.media.remote import at_hand, unreachable
from padstudio.media.sources import by_number
from padstudio.media.zip_stills import ZipLimits, check_entry, entries_of, is_hidden

#: The file that says what a ROS 2 bag's folder holds.
METADATA = "metadata.yaml"
_SUFFIXES = (".bag", ".db3", ".mcap")
_MAX_METADATA_BYTES = 10_000_000
# What is unpacked and was not used for so long is removed.
_KEEP_S = 3 * 86_400.0


def open_recording(source: str, limits: ZipLimits | None = None) -> Storage:
    """A recording, ready to be read; opened once a process.

    Parameters
    ----------
    source : str
        A path, also of a ROS 2 bag's folder, or a URL that fsspec knows.
    limits : ZipLimits or None
        On what may come out of a zip or a packed file.

    Raises
    ------
    RecordingError
        If it is none, or so damaged that no topic is left.
    LimitError
        If it is beyond a limit.
    StorageError
        If it cannot be reached.
    """
    path = at_hand(source)
    try:
        about = path.stat()
    except OSError as error:
        raise unreachable(source) from error
    return _opened(path, about.st_size, about.st_mtime_ns, limits or ZipLimits())


@lru_cache(maxsize=4)
def _opened(path: Path, size: int, changed: int, limits: ZipLimits) -> Storage:
    if path.is_dir():
        return _folder(path, limits)
    with path.open("rb") as file:
        head = file.read(len(sqlite_file.MAGIC))
    if head.startswith(mcap_file.MAGIC):
        return McapFile(path)
    if head.startswith(bag1.MAGIC):
        return Bag1File(path)
    if head.startswith(sqlite_file.MAGIC):
        return SqliteFile(path)
    if head.startswith(ZSTD_MAGIC):
        (unpacked,) = _unpacked(path, size, changed, limits).iterdir()
        return open_recording(str(unpacked), limits)
    if head.startswith(b"PK"):
        return _folder(_unpacked(path, size, changed, limits), limits)
    raise RecordingError("the file is no recording: give a ROS bag or an MCAP file")


def members_of(path: Path, limits: ZipLimits) -> list[str]:
    """Names of the files of recordings in a zip; none where it holds something else.

    Raises
    ------
    ContentError, LimitError
        As `padstudio.media.zip_stills.list_stills`.
    """
    found = [
        entry
        for entry in entries_of(path, limits)
        if _is_storage(Path(entry.filename)) and not is_hidden(entry)
    ]
    for entry in found:
        check_entry(entry, limits, limits.unpacked_bytes)
    bags = [entry.filename for entry in found if entry.filename.lower().endswith(".bag")]
    if len(bags) > 1:
        raise ContentError(
            f"the zip holds {len(bags)} ROS 1 bags; upload each by itself, in the order of time"
        )
    if len({Path(entry.filename).parent for entry in found}) > 1:
        raise ContentError("the zip holds several recordings; upload each by itself")
    return [entry.filename for entry in found]


def _is_storage(path: Path) -> bool:
    suffixes = [suffix.lower() for suffix in path.suffixes]
    return suffixes[-1:] != [] and (
        suffixes[-1] in _SUFFIXES
        or (suffixes[-1] == ".zstd" and suffixes[-2:-1] != [] and suffixes[-2] in _SUFFIXES)
    )


def _folder(path: Path, limits: ZipLimits) -> Storage:
    """The files of a folder as one recording, in the order of its metadata, else of their names."""
    found = [each for each in path.iterdir() if each.is_file() and _is_storage(each)]
    files = sorted(found, key=lambda each: by_number(each.name))
    metadata = _metadata(path / METADATA)
    damage = []
    if metadata is not None:
        named = [Path(str(name)).name for name in metadata.get("relative_file_paths") or ()]
        there = {each.name for each in files} | {each.stem for each in files}
        missing = [name for name in named if name not in there]
        damage = [f"{name}, which {METADATA} names, is missing" for name in missing]
    elif files and any(each.suffix == ".db3" for each in files):
        damage = [f"{METADATA} is missing: the recorder did not come to its end"]
    if not files:
        raise RecordingError(f"{path.name} holds no .db3 or .mcap file of a ROS 2 bag")
    parts = [open_recording(str(each), limits) for each in files]
    if len(parts) == 1 and not damage:
        return parts[0]
    return Joined(parts, tuple(damage), _counts(metadata))


def _metadata(path: Path) -> dict[str, Any] | None:
    try:
        if path.stat().st_size > _MAX_METADATA_BYTES:
            return None
        loaded = yaml_text.parse(path.read_bytes().decode())
        found = loaded["rosbag2_bagfile_information"]
    except (OSError, ValueError, yaml.YAMLError, KeyError, TypeError):
        return None
    return found if isinstance(found, dict) else None


def _counts(metadata: dict[str, Any] | None) -> dict[str, int]:
    """Messages of each topic that a bag's metadata promise."""
    counts: dict[str, int] = {}
    with contextlib.suppress(KeyError, TypeError, ValueError):
        for entry in (metadata or {}).get("topics_with_message_count") or ():
            counts[str(entry["topic_metadata"]["name"])] = int(entry["message_count"])
    return counts


class Joined:
    """Several files of one recording; as of `padstudio.media.recordings.storage.Storage`."""

    def __init__(
        self, parts: Sequence[Storage], damage: tuple[str, ...], counts: dict[str, int]
    ) -> None:
        self._parts = parts
        self.container = parts[0].container
        self.damage = damage + tuple(each for part in parts for each in part.damage)
        keys: dict[tuple[str, str, str, bytes], Channel] = {}
        # From a part's numbers to those that are told, for each part.
        self._numbers: list[dict[int, int]] = []
        for part in parts:
            numbers = {}
            for channel in part.channels:
                key = channel.topic, channel.type, channel.encoding, channel.schema
                count = counts.get(channel.topic)
                known = keys.setdefault(key, Channel(len(keys), *key, count))
                numbers[channel.id] = known.id
            self._numbers.append(numbers)
        self.channels = tuple(keys.values())

    def messages(
        self,
        channels: Collection[int],
        start_ns: int | None = None,
        end_ns: int | None = None,
        tell: Tell = lambda _: None,
    ) -> Iterator[Message]:
        """As of `Storage.messages`."""
        wanted = frozenset(channels)

        def of_part(part: Storage, numbers: dict[int, int]) -> Iterator[Message]:
            mine = [number for number, known in numbers.items() if known in wanted]
            for message in part.messages(mine, start_ns, end_ns, tell) if mine else ():
                yield message._replace(channel=numbers[message.channel])

        streams = map(of_part, self._parts, self._numbers)
        yield from heapq.merge(*streams, key=lambda message: message.log_ns)


def _unpacked(path: Path, size: int, changed: int, limits: ZipLimits) -> Path:
    """A folder with a zip's recording, or with a packed file as it was; one a machine.

    It lies among the system's temporary files, and is made anew where it was removed.
    """
    root = _own_folder()
    name = hashlib.sha256(f"{path.resolve()} {size} {changed}".encode()).hexdigest()[:32]
    folder = root / name
    if folder.is_dir():
        os.utime(folder)
        return folder
    _remove_old(root)
    part = Path(tempfile.mkdtemp(prefix="part-", dir=root))
    try:
        if zipfile.is_zipfile(path):
            _unpack_zip(path, part, limits)
        else:
            with path.open("rb") as source, (part / path.stem).open("wb") as target:
                unpack_file(source, target, limits.unpacked_bytes)
            _name_by_content(part / path.stem)
        # Another process may have been quicker.
        with contextlib.suppress(OSError):
            part.replace(folder)
    except UnpackError as error:
        raise RecordingError(f"the packed recording is damaged ({error})") from error
    except OSError as error:
        raise StorageError(f"the recording cannot be unpacked: {error}") from error
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return folder


def _unpack_zip(path: Path, target: Path, limits: ZipLimits) -> None:
    wanted = members_of(path, limits)
    needed = 0
    with zipfile.ZipFile(path) as archive:
        folder = Path(wanted[0]).parent if wanted else Path()
        names = [*wanted, (folder / METADATA).as_posix()]
        present = set(archive.namelist())
        for name in (each for each in names if each in present):
            entry = archive.getinfo(name)
            needed += entry.file_size
            if needed > limits.unpacked_bytes:
                raise LimitError(
                    f"the recording unpacks to more than {limits.unpacked_bytes / 1e9:g} GB, the "
                    "limit",
                    code="zip_too_large",
                )
            try:
                # Its own name alone, whatever folders the zip gives it.
                with archive.open(entry) as source, (target / Path(name).name).open("wb") as file:
                    shutil.copyfileobj(source, file)
            except (zipfile.BadZipFile, EOFError, NotImplementedError, ValueError) as error:
                raise ContentError(
                    f"{name} cannot be read from the zip ({error}); pack it again",
                    code="damaged_zip",
                ) from error


def _name_by_content(path: Path) -> None:
    """Give a file the ending of its kind; uploads have none."""
    with path.open("rb") as file:
        head = file.read(len(sqlite_file.MAGIC))
    for magic, suffix in (
        (mcap_file.MAGIC, ".mcap"),
        (bag1.MAGIC, ".bag"),
        (sqlite_file.MAGIC, ".db3"),
    ):
        if head.startswith(magic) and path.suffix != suffix:
            path.rename(path.with_name(f"{path.name}{suffix}"))


def _own_folder() -> Path:
    """A folder that no other user of the machine can have made or can write to."""
    root = Path(tempfile.gettempdir()) / f"padstudio-recordings-{os.getuid()}"
    root.mkdir(mode=0o700, exist_ok=True)
    about = root.lstat()
    if about.st_uid != os.getuid() or about.st_mode & 0o077 or root.is_symlink():
        raise StorageError(f"{root} belongs to others; remove it")
    return root


def _remove_old(root: Path) -> None:
    for folder in root.iterdir():
        with contextlib.suppress(OSError):
            if time.time() - folder.stat().st_mtime > _KEEP_S:
                shutil.rmtree(folder, ignore_errors=True)
