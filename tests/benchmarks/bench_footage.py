#!/usr/bin/env python3
"""Detects and scores footage with truth: what is read, how exactly, how fast on one thread.

    bench_footage.py [--footage FOLDER] [--method dense|paper] [--json FILE] [-v]

Times are of pictures already decoded, after one warm-up frame per camera. Exits with 1 if any pose
is false.
"""

from __future__ import annotations

import argparse
import json
import platform
import statistics
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import score

import padstudio
from padstudio import Camera, Detector, Pad
from padstudio.media import images

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
Frame = tuple[str, int, Any]


def stills(footage: Path, truth: list[dict[str, Any]]) -> dict[str, list[Frame]]:
    """Decoded pictures by their camera's file name."""
    frames: dict[str, list[Frame]] = {}
    for item in truth:
        picture = images.read(footage / item["file"])
        frames.setdefault(item["camera"], []).append((item["file"], 0, picture))
    return frames


def flight(path: Path) -> Iterator[Frame]:
    """The frames of a video, in order."""
    video = cv2.VideoCapture(str(path))
    number = 0
    while True:
        found, picture = video.read()
        if not found:
            return
        yield path.name, number, picture
        number += 1


def detect(detector: Detector, frames: Iterator[Frame] | list[Frame]) -> list[dict[str, Any]]:
    """Records of single frames; the first is detected once more to warm up."""
    records = []
    for place, (source, number, picture) in enumerate(frames):
        if place == 0:
            detector.detect(picture)
        records.append(detector.detect(picture).to_record(source, frame=number))
    return records


def measure(footage: Path, truth_path: Path, pad: Pad, method: Any) -> list[dict[str, Any]]:
    """Records of all frames of a truth file."""
    truth = json.loads(truth_path.read_text(encoding="utf-8"))
    if isinstance(truth, dict):
        video = truth_path.with_name(truth_path.name.replace(".truth.json", ".mp4"))
        camera = Camera.load(footage / truth["camera"])
        return detect(Detector(pad, camera, method=method), flight(video))
    records = []
    for camera_name, frames in stills(footage, truth).items():
        camera = Camera.load(footage / camera_name)
        records += detect(Detector(pad, camera, method=method), frames)
    return records


def times(records: list[dict[str, Any]]) -> dict[str, float]:
    """Milliseconds a frame: median, 95th percentile, worst."""
    total = sorted(record["elapsed_ms"]["total"] for record in records)
    return {
        "median_ms": statistics.median(total),
        "p95_ms": total[int(0.95 * (len(total) - 1))],
        "worst_ms": total[-1],
    }


def main() -> int:
    parser = argparse.ArgumentParser(description="Detect and score footage with truth.")
    parser.add_argument("--footage", type=Path, default=FOOTAGE)
    parser.add_argument("--method", choices=("dense", "paper"), default="dense")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    parser.add_argument("-v", "--verbose", action="store_true", help="name what is not good")
    given = parser.parse_args()
    cv2.setNumThreads(1)
    pad = Pad.load(given.footage / "pad_a.json")
    report: dict[str, Any] = {
        "program": padstudio.__version__,
        "method": given.method,
        "opencv": cv2.__version__,
        "python": platform.python_version(),
        "machine": platform.machine(),
    }
    for truth_path in sorted(given.footage.glob("*/*truth.json")):
        name = truth_path.relative_to(given.footage).as_posix()
        records = measure(given.footage, truth_path, pad, given.method)
        poses = {(Path(r["source"]).stem, r["frame"]): r for r in records}
        outcomes = score.score(score.read_truth(truth_path), poses)
        report[name] = score.summary(outcomes) | times(records)
        print(f"\n{name}")
        score.show(report[name])
        print("time: " + ", ".join(f"{key} {value:.1f}" for key, value in times(records).items()))
        for outcome in outcomes if given.verbose else []:
            if outcome.verdict != "good":
                print(f"{outcome.verdict:6}{outcome.key[0]}:{outcome.key[1]}  {outcome.reason}")
    if given.json:
        given.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    figures = [value["total"] for value in report.values() if isinstance(value, dict)]
    return int(any(total.get("false") for total in figures))


if __name__ == "__main__":
    sys.exit(main())
