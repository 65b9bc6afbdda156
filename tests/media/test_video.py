"""Videos of all kinds: every frame found, timed and decoded exactly; bad ones refused by name."""

from __future__ import annotations

import random
import re
from itertools import accumulate
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
import videos
from videos import number_of

from padstudio.arrays import YuvFrame
from padstudio.errors import LimitError, StorageError
from padstudio.media import content
from padstudio.media.sources import find_frames
from padstudio.media.video import VideoError
from padstudio.media.video_frames import read_frames
from padstudio.media.video_index import VideoIndex, read_index
from padstudio.pad.spec import Channel
from padstudio.vision.cells import cells_kernel
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.yuv import YuvPyramid

FRAMES = 40
KINDS: dict[str, dict[str, Any]] = {
    "h264.mp4": {},
    "h264.mov": {},
    "h264.mkv": {},
    "h264.avi": {},
    "h264.ts": {},
    "mpeg4.avi": {"codec": "mpeg4"},
    "vp9.webm": {"codec": "libvpx-vp9"},
    "h265.mp4": {"codec": "libx265"},
    "h265-10bit.mp4": {"codec": "libx265", "pixel_format": "yuv420p10le"},
    "h265-10bit.mkv": {"codec": "libx265", "pixel_format": "yuv420p10le"},
    "open-gop.mp4": {"options": {"x264-params": "open-gop=1"}, "b_frames": 3},
}


def read(path: Path, index: VideoIndex, numbers: list[int]) -> list[int | None]:
    """What stands in frames asked for by number."""
    pictures = read_frames(str(path), index.pts[numbers].tolist(), is_counted=index.is_counted)
    return [None if p.bgr is None else number_of(p.bgr) for p in pictures]


@pytest.fixture(scope="module")
def long_video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """200 frames whose index stands before them."""
    path = tmp_path_factory.mktemp("videos") / "long.mp4"
    return videos.write(path, 200, faststart=True, size=(320, 192))


PLANES = {
    "full.mp4": {"pixel_format": "yuvj420p"},
    "bt709.mp4": {"options": {"x264-params": "colorprim=bt709:transfer=bt709:colormatrix=bt709"}},
    "plain.mp4": {},
}


@pytest.mark.parametrize("name", PLANES)
def test_frames_in_planes_are_their_pictures(name: str, tmp_path: Path) -> None:
    """As FFmpeg's own conversion shows them, whatever range and standard the file tells."""
    path = videos.write(tmp_path / name, 3, size=(194, 130), **PLANES[name])
    index = read_index(str(path))
    for picture in read_frames(str(path), index.pts.tolist()):
        assert isinstance(picture.frame, YuvFrame)
        assert picture.frame.standard == ("bt709" if "709" in name else "bt601")
        assert picture.frame.full_range == ("full" in name)
        assert picture.bgr is not None
        assert picture.bgr.shape == picture.frame.shape == (130, 194, 3)
        found, plain = YuvPyramid(picture.frame), Pyramid(picture.bgr)
        channels: tuple[Channel, ...] = ("red", "blue")
        for channel in channels:
            for level in (1, 2):
                wide, high = (side >> level for side in (194, 130))
                y, x = np.mgrid[1 : high - 1, 1 : wide - 1].astype(float)
                windows = [pyramid.window(channel, level) for pyramid in (found, plain)]
                xy = windows[1].to_frame(np.stack([x, y], axis=-1))
                seen = np.ones(x.shape, bool)
                values = [cells_kernel.sample(window, xy, seen) for window in windows]
                off = np.abs(values[0] - values[1])
                # Where colours clip, a mean of pixels clips otherwise.
                assert np.median(off) <= 2
                assert (off <= 4).mean() > 0.9


@pytest.mark.parametrize("name", KINDS)
def test_every_frame_is_found_and_reached(name: str, tmp_path: Path) -> None:
    path = videos.write(tmp_path / name, FRAMES, **KINDS[name])
    index = read_index(str(path))
    assert (index.info.frames, index.info.width, index.info.height) == (FRAMES, 192, 128)
    assert index.info.damage == ()
    assert index.info.fps == pytest.approx(25)
    assert index.info.duration_s == pytest.approx(FRAMES / 25)
    assert not index.info.variable_rate
    np.testing.assert_allclose(index.times_s(), np.arange(FRAMES) / 25, atol=1e-6)
    assert read(path, index, list(range(FRAMES))) == list(range(FRAMES))
    for numbers in ([39], [17], [0], [8, 9, 10, 11], [3, 21, 22]):
        assert read(path, index, numbers) == numbers


@pytest.mark.parametrize("name", ["h264.mp4", "open-gop.mp4", "h265-10bit.mp4"])
def test_chunks_from_keyframes_are_the_same_to_the_bit(name: str, tmp_path: Path) -> None:
    path = videos.write(tmp_path / name, FRAMES, **KINDS[name])
    index = read_index(str(path))
    assert index.keyframes.tolist() == [0, 10, 20, 30]
    whole = [p.bgr for p in read_frames(str(path), index.pts.tolist())]
    for start in index.keyframes.tolist():
        part = read_frames(str(path), index.pts[start : start + 10].tolist())
        for expected, picture in zip(whole[start : start + 10], part, strict=True):
            np.testing.assert_array_equal(picture.bgr, expected)


@pytest.mark.parametrize("name", ["a.mp4", "a.mkv"])
def test_variable_rates_keep_their_times(name: str, tmp_path: Path) -> None:
    steps = random.Random(1).choices((20, 33, 40, 100), k=FRAMES - 1)
    times_ms = [0, *accumulate(steps)]
    index = read_index(str(videos.write(tmp_path / name, FRAMES, times_ms=times_ms)))
    assert index.info.variable_rate
    np.testing.assert_allclose(1000 * index.times_s(), times_ms, atol=0.6)
    assert read(tmp_path / name, index, [5, 6, 35]) == [5, 6, 35]


@pytest.mark.parametrize(
    ("degrees", "corner"), [(0, (0, 0)), (90, (0, -1)), (180, (-1, -1)), (270, (-1, 0))]
)
def test_rotation_is_told_and_applied_on_demand(
    degrees: int, corner: tuple[int, int], tmp_path: Path
) -> None:
    path = videos.write(tmp_path / "a.mp4", 3, rotation_deg=degrees)
    index = read_index(str(path))
    assert index.info.rotation_deg == degrees
    plain = next(read_frames(str(path), index.pts[:1].tolist())).bgr
    turned = next(read_frames(str(path), index.pts[:1].tolist(), rotation_deg=degrees)).bgr
    assert plain is not None
    assert turned is not None
    assert plain.shape[:2] == (128, 192)
    assert (turned.shape[1], turned.shape[0]) == index.info.shown_size
    red = [(place, turned[place]) for place in ((0, 0), (0, -1), (-1, 0), (-1, -1))]
    assert [place for place, (b, g, r) in red if r > 200 and g < 60 and b < 60] == [corner]


@pytest.mark.parametrize("name", ["a.mp4", "a.mkv", "a.ts"])
def test_cut_files_are_read_as_far_as_they_go(name: str, tmp_path: Path) -> None:
    path = videos.write(tmp_path / name, 200, faststart=name == "a.mp4", size=(320, 192))
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    index = read_index(str(path))
    assert 60 < index.info.frames < 140
    found = read(path, index, list(range(index.info.frames)))
    sure = index.info.frames - 3
    assert found[:sure] == list(range(sure))
    # MPEG-TS has no header that would tell how long it was.
    assert name == "a.ts" or any("missing" in sentence for sentence in index.info.damage)


def test_damage_within_costs_only_what_it_hits(long_video: Path, tmp_path: Path) -> None:
    data = bytearray(long_video.read_bytes())
    middle = len(data) // 2
    data[middle : middle + 3000] = np.random.default_rng(1).bytes(3000)
    path = tmp_path / "hurt.mp4"
    path.write_bytes(data)
    index = read_index(str(path))
    assert index.info.frames == 200
    pictures = list(read_frames(str(path), index.pts.tolist()))
    assert len(pictures) == 200
    lost = [n for n, picture in enumerate(pictures) if picture.bgr is None]
    assert 0 < len(lost) < 60
    # Keyframes stand every ten frames: up to the next one, all that follows rests on what is lost.
    for n in lost:
        resting = range(n + 1, n // 10 * 10 + 10)
        assert all(pictures[each].is_damaged for each in resting if pictures[each].bgr is not None)
    assert not any(picture.is_damaged for picture in pictures[:70] + pictures[160:])
    read_well = [n for n, p in enumerate(pictures) if p.bgr is not None and number_of(p.bgr) == n]
    assert len(read_well) > 140
    assert set(range(70)) | set(range(160, 200)) <= set(read_well)


@pytest.mark.parametrize("name", ["a.mp4", "a.mkv"])
def test_frames_missing_between_others_are_told(name: str, tmp_path: Path) -> None:
    times_ms = [40 * n for n in range(46) if n not in (20, 21, 22, 31)]
    path = videos.write(tmp_path / name, len(times_ms), times_ms=times_ms)
    assert read_index(str(path)).info.damage == (
        "4 frames are missing between others, the first of them after frame 19",
    )


@pytest.mark.parametrize("start_s", [0, 100])
def test_matroska_may_begin_late(start_s: int, tmp_path: Path) -> None:
    times_ms = [1000 * start_s + 40 * n for n in range(200)]
    path = videos.write(tmp_path / "a.mkv", 200, times_ms=times_ms)
    index = read_index(str(path))
    assert index.info.damage == ()
    assert (index.info.frames, index.info.duration_s) == (200, pytest.approx(8.0))
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    info = read_index(str(path)).info
    (sentence,) = (each for each in info.damage if "are missing" in each)
    missing_s, whole_s = (float(word) for word in re.findall(r"[0-9.]+(?= s)", sentence))
    assert whole_s == pytest.approx(8.0, abs=0.1)
    assert missing_s == pytest.approx(8.0 - info.duration_s, abs=0.1)


def test_transport_streams_of_camcorders(tmp_path: Path) -> None:
    plain = videos.write(tmp_path / "a.ts", FRAMES).read_bytes()
    packets = (plain[at : at + 188] for at in range(0, len(plain), 188))
    data = b"".join(n.to_bytes(4, "big") + packet for n, packet in enumerate(packets))
    path = tmp_path / "a.m2ts"
    path.write_bytes(data)
    assert content.identify(data[: content.HEAD_BYTES]) == content.M2TS
    assert find_frames([str(tmp_path / "*.m2ts")]) == [path]
    index = read_index(str(path))
    assert (index.info.frames, index.info.damage) == (FRAMES, ())
    pictures = read_frames(str(path), index.pts.tolist())
    assert [number_of(p.bgr) for p in pictures if p.bgr is not None] == list(range(FRAMES))


def test_a_video_whose_index_was_never_written(tmp_path: Path) -> None:
    path = videos.write(tmp_path / "a.mp4", 200, size=(320, 192))
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    with pytest.raises(VideoError, match="cut short") as caught:
        read_index(str(path))
    assert caught.value.error_code == "truncated_video"


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (b"", "empty_file"),
        (b"a text, whatever it is called\n" * 50, "not_a_video"),
        (b"#EXTM3U\n#EXTINF:10,\nfile:///etc/hostname\n", "not_a_video"),
        (b"ffconcat version 1.0\nfile /etc/hostname\n", "not_a_video"),
        (bytes(5000), "not_a_video"),
    ],
)
def test_files_that_are_no_video(content: bytes, code: str, tmp_path: Path) -> None:
    path = tmp_path / "flight.mp4"
    path.write_bytes(content)
    with pytest.raises(VideoError) as caught:
        read_index(str(path))
    assert caught.value.error_code == code


def test_sound_alone_is_no_video(tmp_path: Path) -> None:
    path = tmp_path / "sound.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("aac", rate=48000)
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 4800), np.float32), "fltp", "mono")
        frame.rate, frame.pts = 48000, 0
        container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    with pytest.raises(VideoError, match="no video stream") as caught:
        read_index(str(path))
    assert caught.value.error_code == "no_video_stream"


def test_a_video_without_a_frame(tmp_path: Path) -> None:
    path = tmp_path / "none.mkv"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=25)
        stream.width, stream.height, stream.pix_fmt = 64, 64, "yuv420p"
        container.start_encoding()
    with pytest.raises(VideoError) as caught:
        read_index(str(path))
    assert caught.value.error_code == "no_frames"


def test_limits_on_pixels_and_frames(long_video: Path) -> None:
    with pytest.raises(LimitError, match="320 x 192"):
        read_index(str(long_video), max_pixels=320 * 192 - 1)
    with pytest.raises(LimitError, match="more than 100 frames"):
        read_index(str(long_video), max_frames=100)
    index = read_index(str(long_video), max_pixels=320 * 192, max_frames=200)
    assert index.info.frames == 200


@pytest.mark.parametrize("side", [9000, 16384])
def test_frames_that_no_memory_holds_are_refused_by_their_size(side: int, tmp_path: Path) -> None:
    size = {"size": (1280, 720), "codec": "mjpeg", "pixel_format": "yuvj420p"}
    path = videos.write(tmp_path / "a.mkv", 2, **size)
    data, much = path.read_bytes(), side.to_bytes(2, "big")
    # Matroska's PixelWidth and PixelHeight, then both in the header of each JPEG.
    for place, value in (
        ("b0820500", much),
        ("ba8202d0", much),
        ("ffc0001108" + "02d00500", 2 * much),
    ):
        old = bytes.fromhex(place)
        assert old in data
        data = data.replace(old, old[: -len(value)] + value)
    path.write_bytes(data)
    with pytest.raises(LimitError, match=f"{side} x {side}") as caught:
        read_index(str(path))
    assert caught.value.error_code == "too_many_pixels"


def test_cover_pictures_do_not_count(tmp_path: Path) -> None:
    path = tmp_path / "cover.mp4"
    with av.open(str(path), "w") as container:
        cover = container.add_stream("mjpeg", rate=1)
        cover.width, cover.height, cover.pix_fmt = 640, 480, "yuvj420p"
        cover.disposition = av.stream.Disposition.attached_pic
        video = container.add_stream("libx264", rate=25, options={"preset": "ultrafast"})
        video.width, video.height, video.pix_fmt = 192, 128, "yuv420p"
        still = av.VideoFrame.from_ndarray(videos.picture(0, 640, 480), format="bgr24")
        container.mux(cover.encode(still))
        for number in range(5):
            frame = av.VideoFrame.from_ndarray(videos.picture(number), format="bgr24")
            container.mux(video.encode(frame))
        container.mux(video.encode(None))
    index = read_index(str(path))
    assert (index.info.codec, index.info.width, index.info.frames) == ("h264", 192, 5)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match="PADSTUDIO_STORAGE") as caught:
        read_index(str(tmp_path / "gone.mp4"))
    assert caught.value.error_code == "source_unreachable"
    # Pages tell it, whose readers have no business with the server's folders.
    assert str(tmp_path) not in str(caught.value)


def test_urls_are_read_through_fsspec(long_video: Path) -> None:
    import fsspec

    with fsspec.open("memory://bucket/flight.mp4", "wb") as file:
        file.write(long_video.read_bytes())
    index = read_index("memory://bucket/flight.mp4")
    assert index.info.frames == 200
    pictures = list(read_frames("memory://bucket/flight.mp4", index.pts[120:123].tolist()))
    assert [number_of(p.bgr) for p in pictures if p.bgr is not None] == [120, 121, 122]
    assert read_index(long_video.as_uri()).info.frames == 200


def test_nothing_asked_for_is_nothing_read(tmp_path: Path) -> None:
    assert list(read_frames(str(tmp_path / "gone.mp4"), [])) == []
