from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
from places import FOOTAGE

from padstudio.arrays import YuvFrame
from padstudio.flights.tasks.proxies import (
    GROUP_FRAMES,
    MOST_WIDTH_PX,
    Proxy,
    ProxyTarget,
    ProxyWriter,
    encode,
    packed,
    unpacked,
)
from padstudio.media.video_frames import read_frames
from padstudio.media.video_index import read_index

VIDEO = str(FOOTAGE / "flights" / "landing.mp4")


def _decoded(proxy: Proxy) -> np.ndarray:
    return cv2.imdecode(np.frombuffer(proxy.jpeg, np.uint8), cv2.IMREAD_COLOR)


def _planes(bgr: np.ndarray, matrix: np.ndarray, full_range: bool, standard: str) -> YuvFrame:
    """4:2:0 planes of a picture by the standard's own matrix."""
    yuv = bgr[:, :, ::-1].astype(float) @ matrix.T
    if full_range:
        yuv += (0, 128, 128)
    else:
        yuv = yuv * (219 / 255, 224 / 255, 224 / 255) + (16, 128, 128)
    y, u, v = np.moveaxis(yuv.round().clip(0, 255).astype(np.uint8), 2, 0)
    half = [np.ascontiguousarray(plane[::2, ::2]) for plane in (u, v)]
    return YuvFrame(y.copy(), *half, bgr.shape[1], standard, full_range, lambda: bgr)


@pytest.mark.parametrize("full_range", [True, False])
@pytest.mark.parametrize(
    ("standard", "red", "blue"), [("bt601", 0.299, 0.114), ("bt709", 0.2126, 0.0722)]
)
@pytest.mark.parametrize("size", [(300, 201), (2001, 1501), (3840, 1080)])
def test_planes_give_the_picture_s_colours_and_place(
    size: tuple[int, int], standard: str, red: float, blue: float, full_range: bool
) -> None:
    width, height = size
    bgr = np.zeros((height, width, 3), np.uint8)
    bgr[:] = (60, 120, 180)
    bgr[height // 4 : height // 2, width // 4 : width // 2] = (180, 90, 40)
    green = 1 - red - blue
    brightness = np.array([red, green, blue])
    matrix = np.array(
        [
            brightness,
            (np.array([0, 0, 1]) - brightness) / (2 * (1 - blue)),
            (np.array([1, 0, 0]) - brightness) / (2 * (1 - red)),
        ]
    )
    proxy = encode(0, None, _planes(bgr, matrix, full_range, standard))
    small = _decoded(proxy)
    assert proxy.size == size
    assert small.shape[1] <= MOST_WIDTH_PX
    assert small.shape[1] == width // proxy.scale
    for x, y in ((0.1, 0.1), (0.375, 0.375), (0.8, 0.8)):
        seen = small[int(y * small.shape[0]), int(x * small.shape[1])].astype(int)
        assert np.abs(seen - bgr[int(y * height), int(x * width)]).max() <= 6
    edge = np.diff(small[int(0.375 * small.shape[0])].astype(int)[:, 0])
    assert abs((np.argmax(edge) + 1) * proxy.scale - width / 4) <= proxy.scale + 1


def test_a_frame_of_a_video_looks_as_its_whole_picture() -> None:
    picture = next(read_frames(VIDEO, read_index(VIDEO).pts[:1]))
    proxy = encode(0, 0.0, picture.frame)
    whole = cv2.resize(
        picture.bgr, None, fx=1 / proxy.scale, fy=1 / proxy.scale, interpolation=cv2.INTER_AREA
    )
    small = _decoded(proxy)
    difference = small.astype(int) - whole[: small.shape[0], : small.shape[1]]
    assert np.abs(difference).mean() < 12
    assert np.abs(difference.mean(axis=(0, 1))).max() < 2.5


def test_files_hold_what_was_packed() -> None:
    proxies = [encode(4, 0.5, np.full((40, 60, 3), 90, np.uint8)), Proxy(5, 0.6)]
    assert unpacked(packed(proxies, {"complete": True})) == proxies


@pytest.mark.parametrize(
    ("first", "stride", "count"), [(0, 1, 40), (7, 1, 9), (5, 3, 20), (33, 2, 1)]
)
def test_groups_are_written_as_far_as_frames_came(
    tmp_path: Path, first: int, stride: int, count: int
) -> None:
    target = ProxyTarget(str(tmp_path / "made"), first % stride, stride)
    frames = range(first, first + count * stride, stride)
    picture = np.full((40, 60, 3), 90, np.uint8)
    with ProxyWriter(target) as writer:
        for frame in frames:
            writer.add(frame, frame / 10, picture if frame % 4 else None)
    kept = {
        proxy.frame: (group, bool(proxy.jpeg))
        for group, files in target.files().items()
        for path in files
        for proxy in unpacked(path.read_bytes())
    }
    assert sorted(kept) == list(frames)
    for frame, (group, has_picture) in kept.items():
        assert frame in target.frames(group)
        assert has_picture == bool(frame % 4)
    groups = [kept[frame][0] for frame in frames]
    assert all(b - a in (0, 1) for a, b in pairwise(groups))
    assert max(map(groups.count, groups)) <= GROUP_FRAMES


def test_what_is_there_is_not_made_again(tmp_path: Path) -> None:
    target = ProxyTarget(str(tmp_path), 0, 1)
    picture = np.full((40, 60, 3), 90, np.uint8)
    for frames in (range(5, 20), range(24)):
        with ProxyWriter(target) as writer:
            for frame in frames:
                writer.add(frame, None, picture)
    sizes = [
        len(unpacked(path.read_bytes())) for files in target.files().values() for path in files
    ]
    assert sum(sizes) == 24


def test_a_folder_that_cannot_be_written_costs_no_frame(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("a file")
    target = ProxyTarget(str(tmp_path / "taken" / "below"), 0, 1)
    picture = np.full((40, 60, 3), 90, np.uint8)
    with ProxyWriter(target) as writer:
        writer.add(15, None, picture)
    with pytest.raises(NotADirectoryError), ProxyWriter(target, must=True) as writer:
        writer.add(15, None, picture)
