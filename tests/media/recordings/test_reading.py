"""Recordings of all kinds: every frame found, timed and decoded; what is missing is told."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import recordings as made
import videos
import yaml
import zstandard
from recordings import LATE_NS, START_NS, STEP_NS, TOPIC, Scene

from padstudio.media.recordings.frames import read_frames
from padstudio.media.recordings.index import RecordingIndex, read_index
from padstudio.media.recordings.storage import RecordingError
from padstudio.store.uploads.limits import UploadLimits, examine

FRAMES = 12
VIDEO = Scene(kind="video")
PNG = Scene(kind="compressed")


def _zipped(folder: Path) -> Path:
    path = folder.with_suffix(".zip")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(folder.iterdir()):
            archive.write(file, f"flight/{file.name}")
    return path


def _packed(folder: Path) -> Path:
    """A bag whose recorder packed each file, as ``--compression-mode file`` does."""
    for file in folder.glob("*.db3"):
        packed = zstandard.compress(file.read_bytes())
        file.with_name(f"{file.name}.zstd").write_bytes(packed)
        file.unlink()
    return folder


Make = Callable[[Path], Path]
KINDS: dict[str, Make] = {
    "bag1": lambda p: made.write_bag1(p / "a.bag", Scene()),
    "bag1 lz4": lambda p: made.write_bag1(p / "a.bag", PNG, "lz4"),
    "bag1 bz2": lambda p: made.write_bag1(p / "a.bag", PNG, "bz2"),
    "bag2 sqlite": lambda p: made.write_bag2(p / "a", Scene()),
    "bag2 mcap": lambda p: made.write_bag2(p / "a", PNG, "mcap"),
    "bag2 video": lambda p: made.write_bag2(p / "a", VIDEO),
    "bag2 db3": lambda p: next(made.write_bag2(p / "a", PNG).glob("*.db3")),
    "bag2 zipped": lambda p: _zipped(made.write_bag2(p / "a", Scene())),
    "bag2 packed": lambda p: _packed(made.write_bag2(p / "a", PNG)),
    "mcap protobuf": lambda p: made.write_mcap(p / "a.mcap", Scene()),
    "mcap json": lambda p: made.write_mcap(p / "a.mcap", PNG, "json"),
    "mcap lz4": lambda p: made.write_mcap(p / "a.mcap", PNG, compression=made.PACKED["lz4"]),
    "mcap video": lambda p: made.write_mcap(p / "a.mcap", VIDEO),
    "mcap video json": lambda p: made.write_mcap(p / "a.mcap", VIDEO, "json"),
    "mcap loose": lambda p: made.write_mcap(p / "a.mcap", PNG, use_chunking=False),
    "mcap no index": lambda p: made.write_mcap(p / "a.mcap", Scene(), **made.UNINDEXED),
}


def _numbers(path: Path, index: RecordingIndex, chosen: list[int]) -> list[int | None]:
    pts = index.video.pts[chosen].tolist()
    pictures = list(read_frames(str(path), pts, index.times))
    assert [picture.pts for picture in pictures] == pts
    assert not any(picture.is_damaged for picture in pictures)
    return [None if p.bgr is None else videos.number_of(p.bgr) for p in pictures]


@pytest.mark.parametrize("kind", KINDS)
def test_every_frame_is_found_and_timed(kind: str, tmp_path: Path) -> None:
    path = KINDS[kind](tmp_path)
    index = read_index(str(path))
    info = index.video.info
    assert info.damage == ()
    assert (info.width, info.height, info.frames) == (videos.WIDTH, videos.HEIGHT, FRAMES)
    assert (info.fps, info.variable_rate) == (pytest.approx(25), False)
    assert index.video.pts.tolist() == [START_NS + n * STEP_NS for n in range(FRAMES)]
    assert index.video.times_s() == pytest.approx(np.arange(FRAMES) / 25)
    assert (index.times.topic, index.times.clock) == (TOPIC, "header")
    assert (index.times.least_ns, index.times.most_ns) == (LATE_NS, LATE_NS)
    assert _numbers(path, index, list(range(FRAMES))) == list(range(FRAMES))
    for chosen in ([7], [3, 4, 9], [FRAMES - 1]):
        assert _numbers(path, index, chosen) == chosen


@pytest.mark.parametrize("kind", [kind for kind in KINDS if "packed" not in kind])
def test_uploads_are_known_by_their_content(kind: str, tmp_path: Path) -> None:
    path = KINDS[kind](tmp_path)
    if path.is_dir():
        path = next(each for each in path.iterdir() if each.suffix != ".yaml")
    upload = tmp_path / "0123abcd"
    path.rename(upload)
    assert examine(upload, UploadLimits()).kind == "recording"
    index = read_index(str(upload))
    assert _numbers(upload, index, [5]) == [5]


def test_the_keyframes_of_a_stream_are_where_work_is_parted(tmp_path: Path) -> None:
    index = read_index(str(made.write_mcap(tmp_path / "a.mcap", VIDEO)))
    assert index.video.keyframes.tolist() == [0, 5, 10]
    index = read_index(str(made.write_mcap(tmp_path / "b.mcap", PNG)))
    assert index.video.keyframes.tolist() == list(range(FRAMES))


def test_without_stamps_the_recorders_times_count(tmp_path: Path) -> None:
    scene = Scene(kind="compressed")
    scene.frames[4].stamp_ns = 0
    path = made.write_mcap(tmp_path / "a.mcap", scene)
    index = read_index(str(path))
    assert index.times.clock == "recorder"
    assert index.video.pts.tolist() == [shot.log_ns for shot in scene.frames]
    (sentence,) = index.video.info.damage
    assert sentence.startswith("1 of 12 headers have no stamp: all frames have the times at which")
    assert _numbers(path, index, [3, 4, 5]) == [3, 4, 5]


def test_stamps_that_go_back_are_not_believed(tmp_path: Path) -> None:
    scene = Scene(kind="compressed")
    for shot in scene.frames[6:]:
        shot.stamp_ns -= 3600 * 10**9
    # Two were taken in one nanosecond.
    scene.frames[9].log_ns = scene.frames[8].log_ns
    path = made.write_bag2(tmp_path / "a", scene)
    index = read_index(str(path))
    assert index.times.clock == "recorder"
    assert "do not rise 1 times, first after frame 5" in index.video.info.damage[0]
    assert np.diff(index.video.pts)[8] == 1
    assert _numbers(path, index, list(range(FRAMES))) == list(range(FRAMES))
    assert _numbers(path, index, [9]) == [9]


@pytest.mark.parametrize("at_fault", ["a.bag", "a.mcap", "loose.mcap"])
def test_a_recording_that_was_cut_short_is_read_up_to_there(at_fault: str, tmp_path: Path) -> None:
    path = tmp_path / at_fault
    if at_fault == "a.bag":
        made.write_bag1(path, Scene())
    else:
        made.write_mcap(
            path, Scene(), compression=made.PACKED["none"], use_chunking=at_fault == "a.mcap"
        )
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * 0.7)])
    index = read_index(str(path))
    frames = index.video.info.frames
    assert 5 <= frames <= 8
    assert any("cut short" in sentence for sentence in index.video.info.damage)
    assert _numbers(path, index, list(range(frames))) == list(range(frames))
    assert _numbers(path, index, [frames - 1]) == [frames - 1]


def test_a_database_that_was_cut_short_is_read_up_to_there(tmp_path: Path) -> None:
    scene = Scene(made.shots(60))
    path = next(made.write_bag2(tmp_path / "a", scene).glob("*.db3"))
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * 0.7)])
    index = read_index(str(path))
    # Rows lie together by eight or so, of which none is found without the last.
    assert 32 <= index.video.info.frames <= 42
    assert "the database is damaged, or was cut short" in index.video.info.damage
    numbers = _numbers(path, index, list(range(index.video.info.frames)))
    assert numbers == list(range(index.video.info.frames))


def test_a_damaged_part_costs_its_frames_alone(tmp_path: Path) -> None:
    path = made.write_mcap(tmp_path / "a.mcap", Scene(), compression=made.PACKED["none"])
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)
    index = read_index(str(path))
    assert any("cannot be read" in sentence for sentence in index.video.info.damage)
    lost = FRAMES - index.video.info.frames
    assert 1 <= lost <= 3
    assert f"{lost} of {FRAMES} messages are missing" in index.video.info.damage
    numbers = _numbers(path, index, list(range(index.video.info.frames)))
    assert set(numbers) < set(range(FRAMES))
    assert numbers == sorted(n for n in numbers if n is not None)


def test_a_missing_file_of_a_bag_is_told(tmp_path: Path) -> None:
    folder = made.write_bag2(tmp_path / "a", PNG)
    metadata = folder / "metadata.yaml"
    told = yaml.safe_load(metadata.read_text())
    told["rosbag2_bagfile_information"]["relative_file_paths"].append("a_1.db3")
    metadata.write_text(yaml.safe_dump(told))
    info = read_index(str(folder)).video.info
    assert info.damage == ("a_1.db3, which metadata.yaml names, is missing",)
    metadata.unlink()
    (sentence,) = read_index(str(folder)).video.info.damage
    assert sentence.startswith("metadata.yaml is missing")


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.mcap", b"\x89MCAP0\r\n", "holds no topic"),
        ("a.bag", b"#ROSBAG V2.0\n", "holds no topic"),
        ("a.db3", b"SQLite format 3\0" + bytes(100), "no topics of a ROS 2 bag"),
        ("a.zstd", b"\x28\xb5\x2f\xfd" + b"\xff" * 20, "packed recording is damaged"),
    ],
)
def test_what_is_no_recording(name: str, data: bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(data)
    with pytest.raises(RecordingError, match=message):
        read_index(str(tmp_path / name))
