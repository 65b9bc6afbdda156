#!/usr/bin/env python3
"""Following a pad through frames that are dropped: is the covariance true, is anything false?

    bench_live_tracking.py [--seeds N] [--frames N] [--flights DIR] [--only NAME]

Simulated gusty landings (and, with ``--flights``, the videos of a folder that have their truth
beside them) are followed with every frame, every second, a random 30 % dropped, and gaps of
0.3 … 1 s. For each: frames taken, poses, those that are false by score.py; the squared error of
poses over their covariance per degree of freedom (1 where it is true), its mean and its median over
that of the chi-squared law, over all poses and over the first after each gap; and the median CPU
time of a frame. ``before`` takes the same frames for evenly spaced, as `Detector.track` does.
"""

from __future__ import annotations

import argparse
import itertools
import json
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
import score
from bench_covariance import normalized_error, plain
from numpy.typing import NDArray

from padstudio import Camera, Detector, Pad
from padstudio.geometry.pose import Pose
from padstudio.media.video_frames import to_frame
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.trajectories import FlightSpec, Setup, plan
from padstudio.vision.follower import Follower
from padstudio.vision.stage.detection import Detection

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
FPS = 30.0
_MEDIAN = 5.348
#: Where simulated landings begin, one a seed; they end at a fifth of it.
_HEIGHTS_MM = (3500.0, 2000.0, 1200.0, 700.0)
# Longer steps than this count as gaps, s.
_GAP_S = 0.25


@dataclass(frozen=True)
class Footage:
    """Frames, when each was taken, and where the camera was."""

    name: str
    pad: Pad
    camera: Camera
    images: Sequence[Any]
    times_s: NDArray[np.float64]
    truths: Sequence[Pose]


def _every(count: int, _rng: np.random.Generator) -> NDArray[np.int64]:
    return np.arange(count)


def _second(count: int, _rng: np.random.Generator) -> NDArray[np.int64]:
    return np.arange(0, count, 2)


def _random(count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    return np.flatnonzero(rng.random(count) >= 0.3)


def _gaps(count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    kept, place = [], 0
    while place < count:
        run = int(rng.integers(6, 16))
        kept += range(place, min(place + run, count))
        place += run + round(float(rng.uniform(0.3, 1.0)) * FPS)
    return np.array(kept)


DROPS: dict[str, Callable[[int, np.random.Generator], NDArray[np.int64]]] = {
    "every frame": _every,
    "every second": _second,
    "30 % dropped": _random,
    "gaps of 0.3 … 1 s": _gaps,
}


def simulated(seed: int, frames: int) -> Footage:
    """A gusty landing by a rolling shutter."""
    pad = Pad.load(FOOTAGE / "pad_a.json")
    camera = Camera.load(FOOTAGE / "camera_drone_half.yaml")
    start = _HEIGHTS_MM[seed % len(_HEIGHTS_MM)]
    spec = FlightSpec(
        kind="gusty", frames=frames, from_mm=start, to_mm=start / 5, fps=FPS, seed=seed
    )
    imaging = Imaging(exposure_ms=3.0, readout_ms=20.0)
    setup = Setup(scene=Scene(pad=pad, ground="gravel"), camera=camera, imaging=imaging, seed=seed)
    taken = list(plan(spec).frames(setup))
    return Footage(
        f"gusty {seed}", pad, camera, [frame.image for frame in taken],
        np.arange(frames) / FPS, [frame.truth.pose for frame in taken],
    )  # fmt: skip


def recorded(truth: Path, frames: int) -> Footage:
    """A video with its truth beside it."""
    told = json.loads(truth.read_text(encoding="utf-8"))
    folder = truth.parent.parent
    video = truth.with_name(truth.name.replace(".truth.json", ".mp4"))
    with av.open(str(video)) as container:
        taken = itertools.islice(container.decode(video=0), frames)
        images = [to_frame(frame, 0, 10**9) for frame in taken]
    poses = [Pose(np.array(f["position_mm"]), np.array(f["rotation"])) for f in told["frames"]]
    return Footage(
        video.stem, Pad.load(folder / "pad_a.json"), Camera.load(folder / told["camera"]),
        images, np.arange(len(images)) / told["fps"], poses,
    )  # fmt: skip


def followed(footage: Footage, kept: NDArray[np.int64]) -> Iterator[Detection]:
    """By time, as live."""
    follower = Follower(Detector(footage.pad, footage.camera))
    for place in kept:
        yield follower.take(footage.images[place], float(footage.times_s[place]))


def tracked(footage: Footage, kept: NDArray[np.int64]) -> Iterator[Detection]:
    """As if frames were evenly spaced."""
    detector = Detector(footage.pad, footage.camera)
    return detector.track(
        (footage.images[place] for place in kept), times_s=footage.times_s[kept].tolist()
    )


def look(
    footage: Footage,
    kept: NDArray[np.int64],
    way: Callable[[Footage, NDArray[np.int64]], Iterator[Detection]],
) -> list[dict[str, Any]]:
    """One record a frame."""
    records = []
    found = way(footage, kept)
    for number, place in enumerate(kept):
        begun = time.thread_time()
        detection = next(found)
        step_s = footage.times_s[place] - footage.times_s[kept[number - 1]] if number else np.inf
        record = {"ok": detection.ok, "ms": 1000 * (time.thread_time() - begun)}
        record |= {"after_gap": bool(_GAP_S < step_s < np.inf), "first": not number}
        if detection.pose is not None:
            truth = footage.truths[place]
            line = {"status": "ok", **plain(detection.pose)}
            record["nees"] = normalized_error(detection, truth)[0]
            record["false"] = score.judge(plain(truth), line, ("", 0)).verdict == "false"
            record["still"] = "lines" in detection.elapsed_ms
        records.append(record)
    return records


HEAD = (
    f"{'':34s}{'frames':>7s}{'poses':>7s}{'false':>6s}{'mean':>7s}{'median':>8s}"
    f"{'gap: mean':>11s}{'median':>8s}{'ms':>7s}{'gap: ms':>9s}{'followed':>10s}"
)


def line(name: str, records: list[dict[str, Any]]) -> str:
    """A line of figures, under `HEAD`."""
    found = [r for r in records if r["ok"]]
    after = [r for r in records if r["after_gap"]]

    def nees(some: list[dict[str, Any]]) -> tuple[float, float]:
        values = [r["nees"] for r in some if r["ok"]]
        if not values:
            return np.nan, np.nan
        return float(np.mean(values)), float(np.median(values)) * 6 / _MEDIAN

    def ms(some: list[dict[str, Any]]) -> float:
        return float(np.median([r["ms"] for r in some])) if some else np.nan

    (mean, median), (mean_after, median_after) = nees(found), nees(after)
    by_eye = 100 * np.mean([not r["still"] for r in found])
    return (
        f"{name:34s}{len(records):7d}{len(found):7d}{sum(r['false'] for r in found):6d}"
        f"{mean:7.2f}{median:8.2f}{mean_after:11.2f}{median_after:8.2f}"
        f"{ms(records):7.1f}{ms(after):9.1f}{by_eye:9.0f} %"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--frames", type=int, default=120)
    parser.add_argument("--flights", type=Path, help="folder of videos and *.truth.json")
    parser.add_argument("--only", default="", help="part of a way of dropping")
    args = parser.parse_args()
    cv2.setNumThreads(1)
    sets = [[simulated(seed, args.frames) for seed in range(args.seeds)]] if args.seeds else []
    if args.flights:
        sets += [[recorded(path, args.frames)] for path in sorted(args.flights.glob("*.json"))]
    print(HEAD)
    for footages in sets:
        name = "simulated gusty" if footages[0].name.startswith("gusty ") else footages[0].name
        for drops, keep in DROPS.items():
            if args.only not in drops:
                continue
            for title, way in (("before", tracked), ("", followed)):
                records: list[dict[str, Any]] = []
                for number, footage in enumerate(footages):
                    kept = keep(len(footage.images), np.random.default_rng(number))
                    records += look(footage, kept, way)
                print(line(f"{name[:14]}, {drops}{title and ', '}{title}", records), flush=True)


if __name__ == "__main__":
    main()
