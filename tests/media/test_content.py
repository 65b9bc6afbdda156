from __future__ import annotations

import contextlib
import io
import zipfile
from pathlib import Path

import av
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from padstudio.errors import ImageError
from padstudio.media import content, images
from padstudio.media.content import HEAD_BYTES, Content, ContentError, identify

SRT_LINE = "1\r\n00:00:00,000 --> 00:00:00,033\r\nFrameCnt: 1\r\n"


def _picture(name: str) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", (30, 20)).save(file, name)
    return file.getvalue()


def _video(path: Path, codec: str) -> bytes:
    with av.open(str(path), "w") as container:
        stream = container.add_stream(codec, 10)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        frame = av.VideoFrame.from_ndarray(np.zeros((48, 64, 3), np.uint8), "rgb24")
        container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return path.read_bytes()


@pytest.mark.parametrize(
    ("suffix", "codec", "expected"),
    [
        (".mp4", "libx264", content.MP4),
        (".mov", "libx264", content.MOV),
        (".mkv", "libx264", content.MKV),
        (".avi", "mpeg4", content.AVI),
        (".webm", "libvpx", content.WEBM),
        (".ts", "mpeg2video", content.MPEGTS),
    ],
)
def test_videos_as_a_writer_makes_them(
    tmp_path: Path, suffix: str, codec: str, expected: Content
) -> None:
    assert identify(_video(tmp_path / f"a{suffix}", codec)[:HEAD_BYTES]) == expected


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("JPEG", content.JPEG),
        ("PNG", content.PNG),
        ("WEBP", content.WEBP),
        ("TIFF", content.TIFF),
        ("BMP", content.BMP),
    ],
)
def test_stills_as_a_writer_makes_them(name: str, expected: Content) -> None:
    assert identify(_picture(name)[:HEAD_BYTES]) == expected


def test_zips() -> None:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("a.jpg", b"x")
    assert identify(file.getvalue()) == content.ZIP


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
def test_telemetry(encoding: str) -> None:
    assert identify(SRT_LINE.encode(encoding)) == content.SRT


def test_a_quicktime_file_without_a_type_box() -> None:
    assert identify(b"\0\0\0\x08wide" + bytes(50)) == content.MOV


def _tiff(tag: int, value: int) -> bytes:
    """A TIFF of 4 x 4 grey pixels with one tag more."""
    file = io.BytesIO()
    Image.new("L", (4, 4), 128).save(file, "TIFF", tiffinfo={tag: value})
    return file.getvalue()


@pytest.mark.parametrize(
    ("tag", "value", "name"),
    [(0xC612, 0x0401, "a DNG file"), (0x00FE, 1, "a camera's raw file"), (0x00FE, 0, None)],
)
def test_raw_files_are_no_pictures(tag: int, value: int, name: str | None) -> None:
    data = _tiff(tag, value)
    if name is None:
        assert identify(data) == content.TIFF
        assert images.decode(data).shape == (4, 4, 3)
        return
    for read, error in ((identify, ContentError), (images.decode, ImageError)):
        with pytest.raises(error, match=f"{name} cannot be read, and the preview"):
            read(data)


@pytest.mark.parametrize(("brand", "name"), [("heic", "HEIC"), ("mif1", "HEIC"), ("crx ", "CR3")])
def test_pictures_in_boxes_are_refused_by_name(brand: str, name: str) -> None:
    data = b"\0\0\0\x18ftyp" + brand.encode() + bytes(20)
    for read, error in ((identify, ContentError), (images.decode, ImageError)):
        with pytest.raises(error, match=f"a {name} picture cannot be read; convert it"):
            read(data)


@pytest.mark.parametrize(
    ("head", "code"),
    [
        (b"", "empty_file"),
        (b"hello, I am flight.mp4", "unknown_content"),
        (b"\0\0\0\x18ftypheic" + bytes(20), "unknown_content"),
        (b"PK\x05\x06" + bytes(18), "empty_zip"),
        (b"RIFF\x10\0\0\0WAVE", "unknown_content"),
        (b"BM is how this text begins", "unknown_content"),
        (b"\x1a\x45\xdf\xa3\x42\x82\x84what", "unknown_content"),
    ],
)
def test_what_cannot_be_read(head: bytes, code: str) -> None:
    with pytest.raises(ContentError) as caught:
        identify(head)
    assert caught.value.error_code == code


@given(st.binary(min_size=1, max_size=200))
def test_any_bytes_get_an_answer(head: bytes) -> None:
    with contextlib.suppress(ContentError):
        assert identify(head).kind in ("video", "still", "stills", "telemetry")
