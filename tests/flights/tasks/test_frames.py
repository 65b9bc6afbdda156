"""A part of a video: decoded in one thread, detected in another, the same as one after another."""

from __future__ import annotations

import threading
import time
from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import Any

import pytest
from browser_support import FOOTAGE

from padstudio.errors import StudioError, TaskStoppedError
from padstudio.flights.tasks.detectors import Recipe, detector_for
from padstudio.flights.tasks.frames import FramesTask, VideoPart
from padstudio.flights.tasks.from_rows import video_part
from padstudio.flights.tasks.planning import PlanTask, SourceFile
from padstudio.media.video import VideoError
from padstudio.media.video_frames import VideoPicture, read_frames

FRAMES, MAX_PIXELS = 6, 50_000_000
VIDEO = FOOTAGE / "flights" / "landing.mp4"


@pytest.fixture(scope="module")
def task() -> FramesTask:
    """The first frames of a landing."""
    pad, camera = (FOOTAGE / name for name in ("pad_a.json", "camera_drone_2k7.yaml"))
    recipe = Recipe(pad.read_text(encoding="utf-8"), camera.read_text(encoding="utf-8"))
    plan = PlanTask(
        files=(SourceFile("", "video", VIDEO.name, str(VIDEO)),),
        camera=recipe.camera,
        first_frame=0,
        end_frame=FRAMES,
        stride=1,
        chunk_frames=120,
        apply_rotation=True,
        max_pixels=MAX_PIXELS,
        max_frames=1000,
    ).run(lambda: False)
    part = video_part(plan.sources[0], plan.chunks[0].pts)
    return FramesTask(recipe, range(10, 10 + 2 * FRAMES, 2), part, MAX_PIXELS)


def reading_threads() -> int:
    return sum(thread.name == "read ahead" for thread in threading.enumerate())


def part_of(task: FramesTask) -> VideoPart:
    assert isinstance(task.part, VideoPart)
    return task.part


def untimed(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [{k: v for k, v in record.items() if k != "elapsed_ms"} for record in records]


def test_records_are_those_of_frames_one_after_another(task: FramesTask) -> None:
    records = task.run(lambda: False)
    assert [record["frame"] for record in records] == [10, 12, 14, 16, 18, 20]
    assert untimed(records) == untimed(task.run(lambda: False))
    frames = [picture.frame for picture in read_frames(str(VIDEO), part_of(task).timestamps)]
    found = detector_for(task.recipe).track((f for f in frames if f is not None), fuse=False)
    for record, detection in zip(records, found, strict=True):
        assert detection.pose is not None
        assert record["position_mm"] == detection.pose.position_mm.tolist()
        assert record["quaternion_xyzw"] == detection.pose.quaternion_xyzw.tolist()
    assert not reading_threads()


def test_a_task_that_is_stopped_leaves_no_thread(task: FramesTask) -> None:
    asked_in: set[int] = set()

    def stopped() -> bool:
        asked_in.add(threading.get_ident())
        return next(times) >= 3

    times = iter(range(1000))
    with pytest.raises(TaskStoppedError):
        task.run(stopped)
    assert asked_in == {threading.get_ident()}
    assert not reading_threads()


@dataclass(frozen=True)
class Slow(VideoPart):
    """Its first frame takes long, as where many others are decoded on the way to it."""

    def read(self, max_pixels: int) -> Generator[VideoPicture]:
        time.sleep(0.3)
        yield from super().read(max_pixels)


@dataclass(frozen=True)
class Broken(VideoPart):
    """Reading fails behind the third frame."""

    def read(self, max_pixels: int) -> Generator[VideoPicture]:
        pictures = super().read(max_pixels)
        for _ in range(3):
            yield next(pictures)
        pictures.close()
        raise VideoError("the rest is gone", code="gone")


def of_kind(kind: type[VideoPart], task: FramesTask) -> FramesTask:
    return replace(task, part=kind(**vars(part_of(task))))


def test_requests_are_served_while_the_decoder_is_on_its_way(task: FramesTask) -> None:
    looks = 0

    def stopped() -> bool:
        nonlocal looks
        looks += 1
        return looks >= 5

    begin = time.monotonic()
    with pytest.raises(TaskStoppedError):
        of_kind(Slow, task).run(stopped)
    assert looks == 5
    assert time.monotonic() - begin < 5.0
    assert not reading_threads()


def test_a_fault_of_the_decoder_ends_the_task_by_name(task: FramesTask) -> None:
    with pytest.raises(StudioError, match="the rest is gone") as caught:
        of_kind(Broken, task).run(lambda: False)
    assert caught.value.error_code == "gone"
    assert not reading_threads()
