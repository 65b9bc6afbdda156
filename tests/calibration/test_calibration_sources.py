"""What a calibration takes as pictures, what it refuses, and what it says of that."""

from __future__ import annotations

import zipfile
from pathlib import Path

import cv2
import numpy as np
import pytest
import recordings

from padstudio.calibration import sources
from padstudio.calibration.calibrate import MOST_PICTURES
from padstudio.calibration.sources import CLIP_PICTURES, DecodedInTurn, read_pictures
from padstudio.errors import CalibrationError, ImageError, LimitError, StudioError
from padstudio.simulate.video_writer import VideoWriter


def still(folder: Path, name: str, width: int = 64, height: int = 48) -> tuple[str, Path]:
    rng = np.random.default_rng(len(name))
    path = folder / name
    assert cv2.imwrite(path.as_posix(), rng.integers(0, 256, (height, width, 3), np.uint8))
    return name, path


def zipped(folder: Path, files: list[tuple[str, Path]]) -> tuple[str, Path]:
    path = folder / "stills.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for name, file in files:
            archive.write(file, name)
    return path.name, path


@pytest.mark.parametrize("as_zip", [False, True])
def test_a_file_that_cannot_be_read_is_named(tmp_path: Path, as_zip: bool) -> None:
    files = [still(tmp_path, f"{k}.jpg") for k in range(4)]
    cut = files[2][1]
    cut.write_bytes(cut.read_bytes()[:-200])
    with pytest.raises(ImageError, match=r"2\.jpg: .*cut off") as caught:
        read_pictures([zipped(tmp_path, files)] if as_zip else files)
    assert caught.value.error_code == "truncated_image"


def test_what_is_no_picture_is_named(tmp_path: Path) -> None:
    files = [still(tmp_path, f"{k}.png") for k in range(3)]
    notes = tmp_path / "notes.txt"
    notes.write_text("the weather was fine\n" * 9)
    with pytest.raises(StudioError, match=r"notes\.txt"):
        read_pictures([*files, (notes.name, notes)])


def test_a_picture_of_another_size_is_named(tmp_path: Path) -> None:
    files = [still(tmp_path, f"{k}.png") for k in range(3)]
    turned = still(tmp_path, "turned.png", 48, 64)
    with pytest.raises(CalibrationError, match=r"turned\.png is 48 x 64, 0\.png 64 x 48"):
        read_pictures([*files, turned])


def test_more_pictures_than_fit_into_a_worker_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = [still(tmp_path, f"{k}.png") for k in range(5)]
    monkeypatch.setattr(sources, "MOST_PIXELS", 4 * 64 * 48)
    with pytest.raises(LimitError, match="more than 4 pictures of 64 x 48"):
        read_pictures(files)
    assert len(read_pictures(files[:4])) == 4


def test_a_zip_of_too_many_stills_is_refused_before_one_is_decoded(tmp_path: Path) -> None:
    one = still(tmp_path, "0.png")[1]
    files = [(f"{k}.png", one) for k in range(MOST_PICTURES + 1)]
    read: list[None] = []
    with pytest.raises(CalibrationError, match=f"more than {MOST_PICTURES} pictures"):
        read_pictures([zipped(tmp_path, files)], read=lambda: read.append(None))
    assert not read


def test_pictures_are_decoded_anew_and_are_the_same(tmp_path: Path) -> None:
    files = [still(tmp_path, f"{k}.png") for k in range(3)]
    shown = read_pictures(files)
    images = DecodedInTurn(shown)
    assert len(images) == len(shown) == 3
    for (_, path), image, part in zip(files, images, images[0:3], strict=True):
        assert np.array_equal(image, cv2.imread(path.as_posix()))
        assert np.array_equal(image, part)
    files[1][1].unlink()
    with pytest.raises(ImageError, match=r"1\.png"):
        _ = images[1]


def clip(folder: Path, frames: int) -> tuple[str, Path]:
    path = folder / "clip.mp4"
    rng = np.random.default_rng(1)
    with VideoWriter(path, width=64, height=48, fps=30.0) as writer:
        for number in range(frames):
            noise = rng.integers(0, 256, (48, 64, 3), np.uint8)
            # Every third frame is sharp, the others are not.
            writer.write(noise if number % 3 == 1 else cv2.GaussianBlur(noise, (0, 0), 2.5))
    return path.name, path


def test_of_a_clip_the_sharpest_frames_are_taken_evenly(tmp_path: Path) -> None:
    shown = read_pictures([clip(tmp_path, 3 * CLIP_PICTURES)])
    numbers = [int(picture.name.rsplit("#", 1)[1]) for picture in shown]
    assert len(shown) == CLIP_PICTURES
    assert {number % 3 for number in numbers} == {1}
    assert max(np.diff(numbers)) <= 6


def test_a_clip_of_one_frame_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CalibrationError, match=r"^1 picture; give 3"):
        read_pictures([clip(tmp_path, 1)])


@pytest.mark.parametrize("is_zipped", [False, True])
def test_a_recording_is_a_clip(tmp_path: Path, is_zipped: bool) -> None:
    scene = recordings.Scene(recordings.shots(4), "compressed")
    bag = recordings.write_bag2(tmp_path / "bag", scene)
    if is_zipped:
        bag = zipped(tmp_path, [(f"bag/{file.name}", file) for file in bag.iterdir()])[1]
    shown = read_pictures([("bag", bag)])
    assert [picture.name for picture in shown] == [f"bag #{n}" for n in range(4)]
    assert [recordings.videos.number_of(picture.image) for picture in shown] == list(range(4))
