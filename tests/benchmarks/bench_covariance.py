#!/usr/bin/env python3
"""Is the covariance true? Normalized estimation errors squared over simulated flights.

    bench_covariance.py [--frames N] [--seeds N]

For each kind of flight the squared error of every pose, normalized by its covariance, is divided
by its six degrees of freedom: 1 is a covariance that is true, more is one that promises too much.
The mean of that, the median over the median of the chi-squared law, and the same by height.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio import Camera, Detector, Pad
from padstudio.geometry.pose import Pose
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.trajectories import FlightKind, FlightSpec, Setup, plan
from padstudio.vision.stage.detection import Detection

FOOTAGE = Path(__file__).resolve().parents[1] / "footage"
#: Median of the chi-squared law of six degrees of freedom.
_MEDIAN = 5.348
_STILL = Imaging(exposure_ms=0.0)
_ROLLING = Imaging(exposure_ms=3.0, readout_ms=20.0)


#: A video of each kind is the middle of three seconds from each of these to two fifths of it.
_FRAMES = 90
_HEIGHTS_MM = (4500.0, 2200.0, 1100.0, 550.0, 250.0, 120.0)


@dataclass(frozen=True)
class Trial:
    """One kind of flight; stills where `stills_mm` tells from where to where."""

    name: str
    kind: FlightKind
    imaging: Imaging
    tracked: bool = False
    stills_mm: tuple[float, float] | None = None


TRIALS = (
    Trial("stills, no motion", "descent", _STILL, stills_mm=(12_000, 70)),
    Trial("tilts, no motion", "tilts", _STILL, stills_mm=(900, 900)),
    Trial("landing, global shutter", "landing", Imaging(exposure_ms=3.0)),
    Trial("hover, rolling, single frames", "hover", _ROLLING),
    Trial("landing, rolling, single frames", "landing", _ROLLING),
    Trial("gusty, rolling, single frames", "gusty", _ROLLING),
    Trial("hover, rolling, tracked", "hover", _ROLLING, tracked=True),
    Trial("landing, rolling, tracked", "landing", _ROLLING, tracked=True),
    Trial("gusty, rolling, tracked", "gusty", _ROLLING, tracked=True),
)


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


def frames_of(
    trial: Trial, pad: Pad, camera: Camera, frames: int, seed: int
) -> Iterator[tuple[NDArray[np.uint8], Pose]]:
    """The pictures of a flight and their true poses."""
    start = _HEIGHTS_MM[seed % len(_HEIGHTS_MM)]
    from_mm, to_mm = trial.stills_mm or (start, 0.4 * start)
    if trial.stills_mm:
        flight = plan(
            FlightSpec(kind=trial.kind, frames=frames, from_mm=from_mm, to_mm=to_mm, seed=seed)
        )
    else:
        whole = plan(
            FlightSpec(
                kind=trial.kind, frames=_FRAMES, from_mm=from_mm, to_mm=to_mm, seed=seed, fps=30.0
            )
        )
        some = slice((_FRAMES - frames) // 2, (_FRAMES + frames) // 2)
        flight = replace(
            whole, poses=whole.poses[some], motions=whole.motions[some], groups=whole.groups[some]
        )
    scene = Scene(pad=pad, ground="gravel")
    setup = Setup(scene=scene, camera=camera, imaging=trial.imaging, seed=seed)
    for frame in flight.frames(setup):
        yield frame.image, frame.truth.pose


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
        return {"ok": False, "height_mm": height}
    nees, parts = normalized_error(detection, truth)
    error = float(np.linalg.norm(detection.pose.position_mm - truth.position_mm))
    return {
        "ok": True,
        "height_mm": height,
        "nees": nees,
        "parts": parts.tolist(),
        "layer": detection.layer,
        "error_percent": 100 * error / height,
        "moving": bool(detection.shift_mm is not None and np.any(detection.shift_mm)),
    }


def summary(records: list[dict[str, Any]]) -> str:
    """A line of figures."""
    found = [r for r in records if r["ok"]]
    nees = np.array([r["nees"] for r in found], float)
    parts = np.sqrt(np.mean(np.square([r["parts"] for r in found]), axis=0))
    error = np.median([r["error_percent"] for r in found])
    return (
        f"{len(found):4d}/{len(records):4d}  mean {nees.mean():7.2f}  "
        f"median {np.median(nees) * 6 / _MEDIAN:6.2f}  95 % {np.percentile(nees, 95):7.2f}  "
        f"xyz {parts[0]:.2f} {parts[1]:.2f} {parts[2]:.2f}  "
        f"turn {parts[3]:.2f} {parts[4]:.2f} {parts[5]:.2f}  position {error:.4f} %"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=10)
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--only", default="", help="part of a trial's name")
    parser.add_argument("--json", type=Path, help="write one record a frame")
    args = parser.parse_args()
    cv2.setNumThreads(1)
    pad = Pad.load(FOOTAGE / "pad_a.json")
    camera = Camera.load(FOOTAGE / "camera_drone_half.yaml")
    everything = {}
    for trial in TRIALS:
        if args.only in trial.name:
            records = run(trial, pad, camera, args.frames, args.seeds)
            everything[trial.name] = records
            print(f"{trial.name:32s} {summary(records)}", flush=True)
    if args.json:
        args.json.write_text(json.dumps(everything), encoding="utf-8")


if __name__ == "__main__":
    main()
