"""A flight's work in chunks that begin at keyframes, whatever range and stride are asked for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import flight_orders
import numpy as np
import pytest
import videos

from padstudio.errors import SpecError, StudioError
from padstudio.flights.tasks.planning import Plan, PlanTask, SourceFile


def plan(*paths: Path, kind: str = "video", **changes: Any) -> Plan:
    files = tuple(SourceFile(f"u{n}", kind, path.name, str(path)) for n, path in enumerate(paths))
    options: dict[str, Any] = {
        "files": files,
        "camera": flight_orders.camera(),
        "first_frame": 0,
        "end_frame": None,
        "stride": 1,
        "chunk_frames": 20,
        "apply_rotation": True,
        "max_pixels": 1_000_000,
        "max_frames": 1000,
    }
    return PlanTask(**(options | changes)).run(lambda: False)


def numbers(found: Plan, stride: int = 1) -> list[int]:
    return [c.first_frame + n * stride for c in found.chunks for n in range(c.frames)]


@pytest.fixture(scope="module")
def video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return videos.write(tmp_path_factory.mktemp("videos") / "a.mp4", 100)


def test_chunks_begin_at_keyframes_and_hold_every_frame_once(video: Path) -> None:
    found = plan(video)
    assert numbers(found) == list(range(100))
    assert [chunk.first_frame for chunk in found.chunks] == [0, 20, 40, 60, 80]
    pts = np.concatenate([np.frombuffer(chunk.pts, "<i8") for chunk in found.chunks])
    assert len(set(pts.tolist())) == 100


@pytest.mark.parametrize(("first", "end", "stride"), [(5, 95, 1), (0, None, 7), (99, 500, 3)])
def test_ranges_and_strides(first: int, end: int | None, stride: int, video: Path) -> None:
    found = plan(video, first_frame=first, end_frame=end, stride=stride)
    assert numbers(found, stride) == list(range(first, min(end or 100, 100), stride))


@pytest.mark.parametrize("chosen", [[3], [0, 1, 2, 50, 51, 99], list(range(0, 100, 7)), [5, 200]])
def test_chosen_frames_alone_are_worked_on(chosen: list[int], video: Path) -> None:
    found = plan(video, only=np.array(chosen, "<i8").tobytes())
    told = [np.frombuffer(chunk.numbers, "<i8").tolist() for chunk in found.chunks]
    assert [number for some in told for number in some] == [n for n in chosen if n < 100]
    whole = np.concatenate([np.frombuffer(chunk.pts, "<i8") for chunk in plan(video).chunks])
    for chunk, some in zip(found.chunks, told, strict=True):
        assert (chunk.first_frame, chunk.frames) == (some[0], len(some))
        assert np.frombuffer(chunk.pts, "<i8").tolist() == whole[some].tolist()


def test_chosen_frames_out_of_the_range_are_none(video: Path) -> None:
    with pytest.raises(SpecError, match="no frame is left"):
        plan(video, end_frame=10, only=np.array([20, 30], "<i8").tobytes())


def test_chunks_are_shorter_where_frames_between_are_decoded_too(video: Path) -> None:
    found = plan(video, stride=5)
    assert [(chunk.first_frame, chunk.frames) for chunk in found.chunks] == [(0, 10), (50, 10)]


def test_chunks_become_shorter_toward_the_end(tmp_path: Path) -> None:
    long = videos.write(tmp_path / "long.mp4", 600)
    found = plan(long, chunk_frames=120)
    sizes = [chunk.frames for chunk in found.chunks]
    assert numbers(found) == list(range(600))
    assert sizes == sorted(sizes, reverse=True)
    # A worker that takes the last chunk keeps others waiting for that one at the most.
    assert sizes[0] >= 70
    assert sizes[-1] <= 30
    behind = [sum(sizes[place:]) for place in range(len(sizes))]
    assert all(size <= max(30, left / 4) + 10 for size, left in zip(sizes, behind, strict=True))


@pytest.mark.parametrize(("stride", "parts"), [(1, 7), (3, 7), (7, 3)])
def test_a_video_of_one_keyframe_is_worked_in_parts(
    stride: int, parts: int, tmp_path: Path
) -> None:
    path = videos.write(tmp_path / "long.mp4", 210, keyframe_every=999)
    found = plan(path, chunk_frames=120, stride=stride)
    assert numbers(found, stride) == list(range(0, 210, stride))
    assert len(found.chunks) == parts
    sizes = [chunk.frames for chunk in found.chunks]
    assert max(sizes) - min(sizes) <= 1


def test_few_parts_are_made_between_keyframes_however_far_apart(tmp_path: Path) -> None:
    path = videos.write(tmp_path / "long.mp4", 700, keyframe_every=999)
    assert len(plan(path, chunk_frames=30).chunks) == 8


def test_videos_follow_each_other_in_frames_and_time(video: Path) -> None:
    found = plan(video, video)
    assert numbers(found) == list(range(200))
    assert [(s["first_frame"], s["start_s"]) for s in found.sources] == [(0, 0.0), (100, 4.0)]
    assert {chunk.source for chunk in found.chunks if chunk.first_frame >= 100} == {1}


def test_nothing_left_to_read(video: Path) -> None:
    with pytest.raises(SpecError, match="100 frames") as caught:
        plan(video, first_frame=100)
    assert caught.value.error_code == "no_frames"


def test_faults_name_the_file(video: Path, tmp_path: Path) -> None:
    with pytest.raises(StudioError, match=r"^a\.mp4: ") as caught:
        plan(video, camera=flight_orders.camera(100, 100))
    assert caught.value.error_code == "camera_size_mismatch"
    text = tmp_path / "text.mp4"
    text.write_text("no video")
    with pytest.raises(StudioError, match=r"^text\.mp4: ") as caught:
        plan(video, text)
    assert caught.value.error_code == "not_a_video"


def test_a_turned_video_fits_a_turned_camera(tmp_path: Path) -> None:
    path = videos.write(tmp_path / "a.mp4", 3, rotation_deg=90)
    upright = flight_orders.camera(videos.HEIGHT, videos.WIDTH)
    assert plan(path, camera=upright).sources[0]["rotation_deg"] == 90
    assert plan(path, apply_rotation=False).sources[0]["rotation_deg"] == 0
    # A camera that fits the picture as stored only can have seen no other.
    assert plan(path).sources[0]["rotation_deg"] == 0
    with pytest.raises(StudioError, match=f"{videos.HEIGHT} x {videos.WIDTH}"):
        plan(path, camera=flight_orders.camera(videos.WIDTH, videos.WIDTH))


def test_telemetry_inside_the_video_is_taken(tmp_path: Path) -> None:
    path = videos.write_with_subtitles(tmp_path / "a.mp4", "mov_text", ["[rel_alt: 2.5]"] * 3)
    found = plan(path).telemetry
    assert found is not None
    assert found["height_m"] == [2.5, 2.5, 2.5]
