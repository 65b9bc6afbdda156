"""Raw pictures by their encodings against what was drawn, padded, in either byte order."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
import recordings as made
from hypothesis import given
from hypothesis import strategies as st

from padstudio.errors import ImageError, LimitError
from padstudio.media.recordings.messages import PictureKind, RecordedPicture
from padstudio.media.recordings.pictures import ENCODINGS, check_format, to_bgr
from padstudio.media.recordings.storage import RecordingError

PIXELS = 1_000_000


def _picture(seed: int = 0, width: int = 16, height: int = 10) -> made.Image:
    return np.random.default_rng(seed).integers(0, 256, (height, width, 3), np.uint8)


def _recorded(
    rows: made.Image, encoding: str, size: tuple[int, int], **more: int
) -> RecordedPicture:
    kind: PictureKind = "raw"
    told = {"step": rows.shape[1]} | more
    return RecordedPicture(kind, 1, encoding, rows.tobytes(), *size, **told)


@given(
    encoding=st.sampled_from(["bgr8", "rgb8", "bgra8", "rgba8"]),
    size=st.tuples(st.integers(1, 9), st.integers(1, 9)),
    padding=st.integers(0, 7),
    has_last_padding=st.booleans(),
)
def test_colours_and_rows_are_where_the_encoding_says(
    encoding: str, size: tuple[int, int], padding: int, has_last_padding: bool
) -> None:
    bgr = _picture(padding, *size)
    rows = np.pad(made.encode(bgr, encoding), ((0, 0), (0, padding)), constant_values=77)
    data = rows.tobytes()
    if padding and not has_last_padding:
        data = data[:-padding]
    picture = RecordedPicture("raw", 1, encoding, data, *size, rows.shape[1])
    assert np.array_equal(to_bgr(picture, PIXELS), bgr)


@pytest.mark.parametrize("is_big", [False, True])
@pytest.mark.parametrize(("name", "channels"), [("mono16", 1), ("rgb16", 3), ("bgra16", 4)])
def test_of_sixteen_bits_the_upper_eight_count(name: str, channels: int, is_big: bool) -> None:
    bgr = _picture()
    shown = np.repeat(bgr[:, :, :1], 3, axis=2) if channels == 1 else bgr
    order = {"mono16": [0], "rgb16": [2, 1, 0], "bgra16": [0, 1, 2, 2]}[name]
    wide = (bgr[:, :, order].astype(np.uint16) << 8) + 5
    rows = wide.astype(">u2" if is_big else "<u2", order="C").view(np.uint8).reshape(len(bgr), -1)
    picture = _recorded(rows, name, (16, 10), is_big_endian=is_big)
    assert np.array_equal(to_bgr(picture, PIXELS), shown)


@pytest.mark.parametrize("order", ["rggb", "bggr", "gbrg", "grbg"])
def test_mosaics_have_their_colours(order: str) -> None:
    # Flat areas, so that each mosaic says the colour exactly.
    bgr = np.zeros((16, 32, 3), np.uint8)
    bgr[:, :16], bgr[:, 16:] = (30, 90, 200), (180, 60, 20)
    picture = _recorded(made.bayer(bgr, order), f"bayer_{order}8", (32, 16))
    found = to_bgr(picture, PIXELS)
    for columns in (slice(4, 12), slice(20, 28)):
        assert np.array_equal(found[4:12, columns], bgr[4:12, columns])


@pytest.mark.parametrize("encoding", ["yuv422", "uyvy", "yuv422_yuy2", "yuyv"])
def test_pixels_that_share_their_colours(encoding: str) -> None:
    bgr = np.repeat(_picture()[:, ::2], 2, axis=1) // 2 + 60
    as_written = {"uyvy": "yuv422", "yuyv": "yuv422_yuy2"}.get(encoding, encoding)
    rows = made.encode(bgr, as_written)
    found = to_bgr(_recorded(rows, encoding, (16, 10)), PIXELS)
    assert np.abs(found.astype(int) - bgr).max() <= 4


def test_grey_pictures() -> None:
    grey = _picture()[:, :, 0]
    for name in ("mono8", "8UC1"):
        found = to_bgr(_recorded(grey, name, (16, 10)), PIXELS)
        assert np.array_equal(found, np.repeat(grey[:, :, None], 3, axis=2))


@pytest.mark.parametrize("encoding", ["8UC3", "32FC1", "nv12", "", "BGR8"])
def test_other_encodings_are_refused_by_name(encoding: str) -> None:
    picture = _recorded(_picture().reshape(10, -1), encoding, (16, 10))
    with pytest.raises(RecordingError, match=f"encoding '{encoding}' is not read") as caught:
        to_bgr(picture, PIXELS)
    assert all(name in caught.value.message for name in ENCODINGS)


def test_bytes_that_do_not_make_up_the_picture() -> None:
    rows = made.encode(_picture(), "bgr8")
    with pytest.raises(ImageError, match="fewer bytes"):
        to_bgr(_recorded(rows[:-1], "bgr8", (16, 10)), PIXELS)
    with pytest.raises(ImageError, match="rows of 40 bytes"):
        to_bgr(_recorded(rows, "bgr8", (16, 10), step=40), PIXELS)
    with pytest.raises(ImageError, match="cannot be"):
        to_bgr(_recorded(rows, "bgr8", (0, 10)), PIXELS)
    with pytest.raises(LimitError, match="100000 x 100000"):
        to_bgr(_recorded(rows, "bgr8", (100_000, 100_000)), PIXELS)


@pytest.mark.parametrize(
    ("told", "is_swapped"),
    [
        ("png", False),
        ("rgb8; png compressed bgr8", False),
        ("mono8; jpeg compressed ", False),
        # So publishers wrote it before they named the order.
        ("rgb8; png compressed ", True),
    ],
)
def test_compressed_pictures_have_their_colours(told: str, is_swapped: bool) -> None:
    bgr = _picture()
    data = cv2.imencode(".png", bgr)[1].tobytes()
    found = to_bgr(RecordedPicture("compressed", 1, told, data), PIXELS)
    assert np.array_equal(found, bgr[:, :, ::-1] if is_swapped else bgr)


@pytest.mark.parametrize("told", ["16UC1; compressedDepth png", "bayer_rggb8; jpeg compressed "])
def test_compressed_pictures_that_are_none(told: str) -> None:
    with pytest.raises(RecordingError, match="are not read: they are no pictures in colours"):
        check_format(RecordedPicture("compressed", 1, told, b""))
