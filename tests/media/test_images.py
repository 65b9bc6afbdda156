from __future__ import annotations

import io
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from padstudio.errors import ImageError, LimitError
from padstudio.media import images

NOISE = np.random.default_rng(1).integers(0, 255, (60, 90, 3), np.uint8)


def _encoded(suffix: str, *options: int) -> bytes:
    return cv2.imencode(suffix, NOISE, list(options))[1].tobytes()


def _jpeg_with_preview() -> bytes:
    """A JPEG with a whole smaller one in a segment of its own, as cameras write."""
    outer, preview = _encoded(".jpg"), cv2.imencode(".jpg", NOISE[:20, :20])[1].tobytes()
    segment = b"\xff\xe4" + (len(preview) + 2).to_bytes(2, "big") + preview
    return outer[:2] + segment + outer[2:]


FILES = {
    "JPEG": _encoded(".jpg"),
    "progressive": _encoded(".jpg", cv2.IMWRITE_JPEG_PROGRESSIVE, 1),
    "restarts": _encoded(".jpg", cv2.IMWRITE_JPEG_RST_INTERVAL, 2),
    "preview": _jpeg_with_preview(),
    "PNG": _encoded(".png"),
    "WEBP": _encoded(".webp", cv2.IMWRITE_WEBP_QUALITY, 101),
    "BMP": _encoded(".bmp"),
}


@pytest.mark.parametrize("suffix", [".png", ".bmp", ".tiff", ".webp"])
def test_lossless_formats_give_back_the_pixels(suffix: str) -> None:
    lossless = (cv2.IMWRITE_WEBP_QUALITY, 101) if suffix == ".webp" else ()
    decoded = images.decode(_encoded(suffix, *lossless))
    assert np.array_equal(decoded, NOISE)


@pytest.mark.parametrize("name", FILES)
def test_headers(name: str) -> None:
    header = images.read_header(FILES[name])
    assert (header.width, header.height) == (90, 60)
    assert header.format == (name if name in ("PNG", "WEBP", "BMP") else "JPEG")
    assert images.decode(FILES[name]).shape == (60, 90, 3)


@given(name=st.sampled_from(sorted(FILES)), share=st.floats(0, 1, exclude_max=True))
def test_no_part_of_a_file_passes_for_the_whole(name: str, share: float) -> None:
    whole = FILES[name]
    with pytest.raises(ImageError):
        images.decode(whole[: int(share * len(whole))])


@pytest.mark.parametrize("missing", [1, 2, 100])
def test_a_cut_off_file_is_called_so(missing: int) -> None:
    for name in ("JPEG", "progressive", "restarts", "preview", "PNG"):
        with pytest.raises(ImageError, match="cut off") as caught:
            images.decode(FILES[name][:-missing])
        assert caught.value.error_code == "truncated_image"


def test_what_follows_the_picture_does_not_matter() -> None:
    for name in ("JPEG", "PNG"):
        assert images.decode(FILES[name] + b"\x00trailer\xff\xd8").shape == (60, 90, 3)


@given(st.binary(max_size=300))
def test_other_content_is_no_picture(data: bytes) -> None:
    with pytest.raises(ImageError):
        images.decode(data)


def test_damage_is_refused() -> None:
    damaged = bytearray(FILES["PNG"])
    damaged[16:20] = (1000).to_bytes(4, "big")  # a width that the checksum does not fit
    with pytest.raises(ImageError):
        images.decode(bytes(damaged))


def test_orientation_tags_are_ignored() -> None:
    exif = Image.Exif()
    exif[0x0112] = 6
    out = io.BytesIO()
    Image.fromarray(NOISE).save(out, "JPEG", exif=exif)
    assert images.decode(out.getvalue()).shape == (60, 90, 3)


def test_grey_and_transparent_and_deep_pictures_become_bgr() -> None:
    for image in (NOISE[:, :, 0], np.dstack([NOISE, NOISE[:, :, :1]]), NOISE.astype(np.uint16)):
        decoded = images.decode(cv2.imencode(".png", image)[1].tobytes())
        assert (decoded.shape, decoded.dtype) == ((60, 90, 3), np.uint8)


def test_too_many_pixels_are_refused_from_the_header() -> None:
    assert images.decode(FILES["PNG"], 60 * 90).shape == (60, 90, 3)
    with pytest.raises(LimitError, match="90 x 60") as caught:
        images.decode(FILES["PNG"][:200], 60 * 90 - 1)
    assert caught.value.detail == {"width": 90, "height": 60, "max_pixels": 5399}


def test_read_names_the_file(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(FILES["PNG"])
    assert np.array_equal(images.read(tmp_path / "a.png"), NOISE)
    with pytest.raises(ImageError, match=r"b\.png"):
        images.read(tmp_path / "b.png")
