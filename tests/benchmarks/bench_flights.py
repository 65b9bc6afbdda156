#!/usr/bin/env python3
"""Flights against bare decoding: frames a second of the same file by as many processes.

    bench_flights.py [VIDEO CAMERA PAD] [--workers N] [--repeat N] [--json FILE]

The flight is the video again and again in one file. All run the same chunks in the same worker
processes, in turns, warm. Bare decoding decodes every frame and drops it, once as a picture (BGR),
once as the decoder leaves it, in planes; the flight finds the pad in each. CPU time a frame is told
too, as it does not suffer from other work on the machine, and the workers' memory first and last.
"""

from __future__ import annotations

import argparse
import json
import os
import queue
import resource
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
from looped import looped

from padstudio.flights.cluster.local import LocalEngine
from padstudio.flights.cluster.task import Engine, Outcome, Task
from padstudio.flights.tasks.detectors import Recipe
from padstudio.flights.tasks.frames import FramesTask, VideoPart
from padstudio.flights.tasks.from_rows import video_part
from padstudio.flights.tasks.planning import PlanTask, SourceFile
from padstudio.workers.inside import Limits
from padstudio.workers.pool import WorkerPool

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
MAX_PIXELS = 50_000_000


@dataclass(frozen=True)
class Cost:
    """What a chunk took: frames, CPU seconds, the process's peak memory in MB."""

    frames: int
    ok: int
    cpu_s: float
    peak_mb: float


@dataclass(frozen=True)
class Decode:
    """Decodes a chunk's frames, to BGR or as they lie in the decoder's memory."""

    part: VideoPart
    to_bgr: bool

    def run(self, stopped: Callable[[], bool]) -> Cost:
        cv2.setNumThreads(1)
        start = time.process_time()
        frames = sum(
            (picture.bgr if self.to_bgr else picture.frame) is not None
            for picture in self.part.read(MAX_PIXELS)
        )
        return Cost(frames, 0, time.process_time() - start, _peak_mb())


@dataclass(frozen=True)
class Detect:
    """Does a chunk of a flight."""

    task: FramesTask

    def run(self, stopped: Callable[[], bool]) -> Cost:
        start = time.process_time()
        records = self.task.run(stopped)
        ok = sum(record["status"] == "ok" for record in records)
        return Cost(len(records), ok, time.process_time() - start, _peak_mb())


def _peak_mb() -> float:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3)


def chunks_of(video: Path, camera: Path, pad: Path) -> list[FramesTask]:
    """The tasks of a flight of one video."""
    recipe = Recipe(pad.read_text(encoding="utf-8"), camera.read_text(encoding="utf-8"))
    plan = PlanTask(
        files=(SourceFile("", "video", video.name, str(video.resolve())),),
        camera=recipe.camera,
        first_frame=0,
        end_frame=None,
        stride=1,
        chunk_frames=120,
        apply_rotation=True,
        max_pixels=MAX_PIXELS,
        max_frames=2_000_000,
    ).run(lambda: False)
    return [
        FramesTask(
            recipe,
            range(chunk.first_frame, chunk.first_frame + chunk.frames),
            video_part(plan.sources[0], chunk.pts),
            MAX_PIXELS,
        )
        for chunk in plan.chunks
    ]


def run(engine: Engine, tasks: list[Task], name: str) -> tuple[float, list[Cost]]:
    """Seconds, and what each task took; as many tasks at a time as there are workers."""
    ended: queue.SimpleQueue[Outcome] = queue.SimpleQueue()
    start, costs, waiting = time.perf_counter(), [], list(enumerate(tasks))
    under_way = 0
    while waiting or under_way:
        while waiting and engine.room(under_way):
            number, task = waiting.pop(0)
            engine.submit(f"{name}-{number}", task, ended.put)
            under_way += 1
        outcome = ended.get()
        under_way -= 1
        assert outcome.kind == "value", outcome
        costs.append(outcome.value)
    return time.perf_counter() - start, costs


def measure(engine: Engine, chunks: list[FramesTask], rounds: int) -> dict[str, Any]:
    """Medians over rounds of all kinds of work in turns."""
    parts = [chunk.part for chunk in chunks if isinstance(chunk.part, VideoPart)]
    kinds: dict[str, list[Task]] = {
        "decoding": [Decode(part, to_bgr=True) for part in parts],
        "planes": [Decode(part, to_bgr=False) for part in parts],
        "flight": [Detect(chunk) for chunk in chunks],
    }
    figures: dict[str, list[tuple[float, float]]] = {kind: [] for kind in kinds}
    costs: list[Cost] = []
    for number in range(rounds + 1):
        for kind, tasks in kinds.items():
            seconds, costs = run(engine, tasks, f"{kind}-{number}")
            frames = sum(cost.frames for cost in costs)
            cpu_ms = 1e3 * sum(cost.cpu_s for cost in costs) / frames
            # The first round warms up imports, tables and the file's pages.
            if number:
                figures[kind].append((frames / seconds, cpu_ms))
    report: dict[str, Any] = {"chunks": len(chunks), "frames": sum(cost.frames for cost in costs)}
    report["poses"] = sum(cost.ok for cost in costs)
    for kind, found in figures.items():
        report[f"{kind}_fps"] = statistics.median(fps for fps, _ in found)
        report[f"{kind}_cpu_ms"] = statistics.median(cpu for _, cpu in found)
    report["share_of_decoding"] = report["flight_fps"] / report["decoding_fps"]
    report["share_of_planes"] = report["flight_fps"] / report["planes_fps"]
    report["share_of_decoding_cpu"] = report["decoding_cpu_ms"] / report["flight_cpu_ms"]
    report["worker_peak_mb"] = [costs[0].peak_mb, costs[-1].peak_mb]
    return report


def main() -> int:
    parser = argparse.ArgumentParser(description="Flights against bare decoding.")
    parser.add_argument("video", nargs="?", type=Path, default=FOOTAGE / "flights" / "landing.mp4")
    parser.add_argument("camera", nargs="?", type=Path, default=FOOTAGE / "camera_drone_2k7.yaml")
    parser.add_argument("pad", nargs="?", type=Path, default=FOOTAGE / "pad_a.json")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--repeat", type=int, default=10, help="how often the video is flown")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    given = parser.parse_args()
    pool = WorkerPool(given.workers, Limits(3_000_000_000, niceness=10), max_waiting=0)
    engine = LocalEngine(pool)
    try:
        with tempfile.TemporaryDirectory() as folder:
            video = looped(given.video, Path(folder) / "flight.mp4", times=given.repeat)
            chunks = chunks_of(video, given.camera, given.pad)
            report = {"workers": given.workers, **measure(engine, chunks, given.rounds)}
    finally:
        pool.close()
    for name, value in report.items():
        print(f"{name:24}{value if not isinstance(value, float) else round(value, 2)}")
    if given.json:
        given.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    # Workers import the tasks by the module's name, which they know from their path.
    os.environ["PYTHONPATH"] = str(Path(__file__).resolve().parent)
    import bench_flights

    sys.exit(bench_flights.main())
