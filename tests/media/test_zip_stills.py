from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path

import pytest

from padstudio.errors import ImageError, LimitError
from padstudio.media.content import ContentError
from padstudio.media.zip_stills import ZipLimits, list_stills, read_still


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "flight.zip"


def _pack(path: Path, entries: Mapping[str, bytes], kind: int = zipfile.ZIP_DEFLATED) -> None:
    with zipfile.ZipFile(path, "w", kind) as archive:
        for name, data in entries.items():
            archive.writestr(name, data)


def _alter(path: Path, old: bytes, new: bytes) -> None:
    data = path.read_bytes()
    assert old in data
    path.write_bytes(data.replace(old, new))


def test_pictures_by_number_and_nothing_else(path: Path) -> None:
    names = ["b/10.jpg", "b/9.JPG", "a.png", "__MACOSX/b/9.jpg", ".x.jpg", "notes.txt", "d.png/"]
    _pack(path, {name: name.encode() for name in names})
    assert list_stills(path) == ["a.png", "b/9.JPG", "b/10.jpg"]
    assert read_still(path, "b/9.JPG") == b"b/9.JPG"


def test_numbers_of_any_length_have_an_order(path: Path) -> None:
    names = [f"{number}.jpg" for number in ("2", "010", "1" + "0" * 4999, "2" + "0" * 4999)]
    _pack(path, dict.fromkeys(reversed(names), b""))
    assert list_stills(path) == names


@pytest.mark.parametrize("kind", [zipfile.ZIP_STORED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_ways_to_pack(path: Path, kind: int) -> None:
    _pack(path, {"a.jpg": b"data"}, kind)
    assert read_still(path, list_stills(path)[0]) == b"data"


@pytest.mark.parametrize(
    ("entries", "limits", "code"),
    [
        ({"a.png": bytes(100_000)}, ZipLimits(), "zip_bomb"),
        ({"a.png": bytes(range(200)), "b.txt": bytes(10**6)}, ZipLimits(), "zip_bomb"),
        ({f"{k}.png": b"x" for k in range(4)}, ZipLimits(files=3), "zip_too_many_files"),
        ({f"{k}.png": b"x" for k in range(90)}, ZipLimits(files=3), "zip_too_many_files"),
        ({"a.png": b"x" * 60, "b.png": b"y" * 60}, ZipLimits(unpacked_bytes=99), "zip_too_large"),
        ({"a.png": b"x" * 60}, ZipLimits(still_bytes=50), "zip_too_large"),
    ],
)
def test_limits(path: Path, entries: dict[str, bytes], limits: ZipLimits, code: str) -> None:
    _pack(path, entries)
    with pytest.raises(LimitError) as caught:
        list_stills(path, limits)
    assert caught.value.error_code == code


def test_a_directory_is_not_read_where_it_is_too_long(path: Path) -> None:
    _pack(path, {"a.png": b"x"})
    # The directory's size in the end record, as one of 16 MB would have it.
    data = bytearray(path.read_bytes())
    data[-10:-6] = (16_000_000).to_bytes(4, "little")
    path.write_bytes(data)
    with pytest.raises(LimitError, match="more than 10 files"):
        list_stills(path, ZipLimits(files=10))


def test_entries_that_share_their_data_are_counted_together(path: Path) -> None:
    data = bytes(range(256)) * 40
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("0.png", data)
        first = archive.infolist()[0]
        for k in range(1, 300):
            entry = zipfile.ZipInfo(f"{k}.png")
            entry.header_offset, entry.CRC = first.header_offset, first.CRC
            entry.file_size = entry.compress_size = len(data)
            archive.filelist.append(entry)
            archive.NameToInfo[entry.filename] = entry
        archive._didModify = True
    with pytest.raises(LimitError, match="unpacks to"):
        list_stills(path, ZipLimits(ratio=50))


def test_no_zip_and_damaged_zips(path: Path) -> None:
    path.write_bytes(b"PK\x03\x04 and no more")
    with pytest.raises(ContentError, match="damaged"):
        list_stills(path)
    _pack(path, {"notes.txt": b"x"})
    with pytest.raises(ContentError, match="no picture"):
        list_stills(path)
    _pack(path, {"a.jpg": b"one two three"}, zipfile.ZIP_STORED)
    _alter(path, b"two", b"owt")
    with pytest.raises(ImageError, match="CRC"):
        read_still(path, "a.jpg")
    with pytest.raises(ImageError):
        read_still(path, "b.jpg")


def test_encrypted_zips(path: Path) -> None:
    _pack(path, {"a.jpg": b"x"})
    data = bytearray(path.read_bytes())
    data[data.index(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(data)
    with pytest.raises(ContentError) as caught:
        list_stills(path)
    assert caught.value.error_code == "encrypted_zip"


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_two_of_one_name(path: Path) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("a.jpg", b"1")
        archive.writestr("a.jpg", b"2")
    with pytest.raises(ContentError, match="one name"):
        list_stills(path)


def test_no_more_is_unpacked_than_was_declared(path: Path) -> None:
    _pack(path, {"a.jpg": bytes(1000)})
    data = bytearray(path.read_bytes())
    for signature, at in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        place = data.index(signature) + at
        data[place : place + 4] = (10).to_bytes(4, "little")
    path.write_bytes(data)
    with pytest.raises(ImageError):
        read_still(path, "a.jpg")
