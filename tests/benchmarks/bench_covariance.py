#!/usr/bin/env python3
"""Is the covariance true? Normalized estimation errors squared over simulated flights.

    bench_covariance.py [--frames N] [--seeds N] [--only NAME] [--pad FILE] [--camera FILE]

For each set of frames (covariance_sets.py) the squared error of every pose, normalized by its
covariance, is divided by its six degrees of freedom: 1 is a covariance that is true, more is one
that promises too much. Its mean, and its median over that of the chi-squared law; the root mean
square of each part over its sigma; and how many of the poses are full, poor or false by score.py.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import score
from covariance_sets import TRIALS, Trial, frames_of
from numpy.typing import NDArray

from padstudio import Camera, Detector, Pad
from padstudio.geometry.pose import Pose
from padstudio.vision.stage.detection import Detection

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
#: Median of the chi-squared law of six degrees of freedom.
_MEDIAN = 5.348


def normalized_error(found: Detection, truth: Pose) -> tuple[float, NDArray[np.float64]]:
    """Error squared over the covariance, per degree of freedom; each part over its sigma."""
    assert found.pose is not None
    assert found.uncertainty is not None
    turn = cv2.Rodrigues(found.pose.rotation.T @ truth.rotation)[0].ravel()
    error = np.concatenate([truth.position_mm - found.pose.position_mm, turn])
    covariance = found.uncertainty.covariance
    return (
        float(error @ np.linalg.solve(covariance, error)) / 6,
        error / np.sqrt(np.diag(covariance)),
    )


def run(trial: Trial, pad: Pad, camera: Camera, frames: int, seeds: int) -> list[dict[str, Any]]:
    """One record a frame."""
    records = []
    for seed in range(seeds):
        detector = Detector(pad, camera)
        truths: list[Pose] = []

        def images(truths: list[Pose] = truths, seed: int = seed) -> Iterator[NDArray[np.uint8]]:
            for image, truth in frames_of(trial, pad, camera, frames, seed):
                truths.append(truth)
                yield image

        found = detector.track(images()) if trial.tracked else map(detector.detect, images())
        for number, detection in enumerate(found):
            records.append({"seed": seed, "frame": number, **_record(detection, truths[-1])})
    return records


def _record(detection: Detection, truth: Pose) -> dict[str, Any]:
    height = float(truth.position_mm[2])
    if detection.pose is None:
        return {"ok": False, "height_mm": height, "reason": detection.failure.reason.value}
    nees, parts = normalized_error(detection, truth)
    error = float(np.linalg.norm(detection.pose.position_mm - truth.position_mm))
    return {
        "ok": True,
        "height_mm": height,
        "nees": nees,
        "parts": parts.tolist(),
        "layer": detection.layer,
        "error_percent": 100 * error / height,
        "verdict": score.judge(
            plain(truth), {"status": "ok", **plain(detection.pose)}, ("", 0)
        ).verdict,
        "full": getattr(detection, "quality", "full") == "full",
        "moving": bool(detection.shift_mm is not None and np.any(detection.shift_mm)),
    }


def plain(pose: Pose) -> dict[str, Any]:
    """A pose as truth and poses files have it."""
    return {"position_mm": pose.position_mm.tolist(), "rotation": pose.rotation.tolist()}


HEAD = (
    f"{'set':36s}{'found':>9s}{'full':>6s}{'poor':>6s}{'false':>6s}{'(full)':>7s}"
    f"{'mean':>9s}{'median':>8s}{'95 %':>9s}"
    f"  {'x y z, turn: RMS over sigma':36s}{'position %':>10s}"
)


def summary(records: list[dict[str, Any]]) -> str:
    """A line of figures, under `HEAD`."""
    found = [r for r in records if r["ok"]]
    if not found:
        return f"{0:4d}/{len(records):4d}"
    nees = np.array([r["nees"] for r in found], float)
    parts = np.sqrt(np.mean(np.square([r["parts"] for r in found]), axis=0))
    error = np.median([r["error_percent"] for r in found])
    count = Counter(r["verdict"] for r in found)
    full = [r for r in found if r["full"]]
    false_full = sum(r["verdict"] == "false" for r in full)
    return (
        f"{len(found):4d}/{len(records):4d}{len(full):6d}{count['poor']:6d}{count['false']:6d}"
        f"{false_full:7d}{nees.mean():9.2f}{np.median(nees) * 6 / _MEDIAN:8.2f}"
        f"{np.percentile(nees, 95):9.2f}  "
        + "".join(f"{part:6.2f}" for part in parts)
        + f"{error:10.4f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=10)
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--only", default="", help="part of a set's name")
    parser.add_argument("--pad", type=Path, default=FOOTAGE / "pad_a.json")
    parser.add_argument("--camera", type=Path, default=FOOTAGE / "camera_drone_half.yaml")
    parser.add_argument("--json", type=Path, help="write one record a frame")
    args = parser.parse_args()
    cv2.setNumThreads(1)
    pad, camera = Pad.load(args.pad), Camera.load(args.camera)
    everything = {}
    print(HEAD)
    for trial in TRIALS:
        if args.only in trial.name:
            records = run(trial, pad, camera, args.frames, args.seeds)
            everything[trial.name] = records
            print(f"{trial.name:36s}{summary(records)}", flush=True)
    if args.json:
        args.json.write_text(json.dumps(everything), encoding="utf-8")


if __name__ == "__main__":
    main()
