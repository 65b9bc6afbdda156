from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from videos import write

from padstudio.arrays import YuvFrame
from padstudio.media.video_frames import read_frames
from padstudio.media.video_index import read_index
from padstudio.media.video_shelf import FrameShelf, shelve

PIXELS = 1_000_000


def _laid(shelf: FrameShelf, video: Path, pts: Sequence[int]) -> list[int]:
    return list(
        shelve(shelf, pts, lambda keep: read_frames(str(video), pts, max_pixels=PIXELS, keep=keep))
    )


@pytest.mark.parametrize("rotation", [0, 90])
@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("a.mp4", {}),
        ("a.mp4", {"pixel_format": "yuvj420p"}),
        ("a.mkv", {"pixel_format": "yuv444p", "keyframe_every": 100}),
        ("a.mp4", {"codec": "libx265", "pixel_format": "yuv420p10le"}),
        ("a.mp4", {"size": (190, 126)}),
    ],
)
def test_frames_are_the_decoders_to_the_bit(
    tmp_path: Path, name: str, options: dict[str, object], rotation: int
) -> None:
    video = write(tmp_path / name, 12, **options)
    pts = [int(value) for value in read_index(str(video)).pts[3:9]]
    shelf = FrameShelf(tmp_path / "shelf")
    assert shelf.missing(pts) == pts
    assert _laid(shelf, video, pts) == pts
    assert shelf.missing(pts) == []
    lying = list(shelf.read(pts, rotation, PIXELS))
    decoded = list(read_frames(str(video), pts, rotation_deg=rotation))
    for one, other in zip(lying, decoded, strict=True):
        assert (one.pts, one.is_damaged) == (other.pts, other.is_damaged)
        np.testing.assert_array_equal(one.bgr, other.bgr)
        assert type(one.frame) is type(other.frame)
        if isinstance(one.frame, YuvFrame) and isinstance(other.frame, YuvFrame):
            assert one.frame.standard == other.frame.standard
            assert one.frame.full_range == other.frame.full_range
            width = one.frame.width
            np.testing.assert_array_equal(one.frame.y[:, :width], other.frame.y[:, :width])
            for plane in ("u", "v"):
                a, b = (getattr(each.frame, plane)[:, : width // 2] for each in (one, other))
                np.testing.assert_array_equal(a, b)


def test_only_what_lacks_is_laid_and_lost_frames_are_known(tmp_path: Path) -> None:
    video = write(tmp_path / "a.mp4", 12)
    pts = [int(value) for value in read_index(str(video)).pts]
    shelf = FrameShelf(tmp_path / "shelf")
    _laid(shelf, video, pts[2:5])
    before = shelf.path(pts[3]).stat().st_ino
    beyond = pts[-1] + 1000
    _laid(shelf, video, [*pts[1:7], beyond])
    assert shelf.path(pts[3]).stat().st_ino == before
    assert shelf.missing([*pts, beyond]) == [pts[0], *pts[7:]]
    [lost] = shelf.read([beyond], 0, PIXELS)
    assert lost.frame is None
    with pytest.raises(FileNotFoundError):
        list(shelf.read(pts[:1], 0, PIXELS))
