#!/usr/bin/env python3
"""Prints that are no flat sheet: bent paper, sheets side by side, sheets in each other's place.

    bench_prints.py [--classes NAME,…] [--frames N] [--seed N] [--cache FOLDER] [--json FILE]

Frames are those of reality_classes.py. Verdicts are of score.py, where the nominal plane and those
that fit the print best are all true. Position errors are against the nearest of them and against
the nominal one; squared errors over the covariance, per degree of freedom, likewise (`NEES`, the
median over that of the chi-squared law).
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import score
from bench_covariance import normalized_error, plain
from numpy.typing import NDArray
from reality_classes import CLASSES
from reality_shots import CAMERAS, USUAL, pads, plain_shot

from padstudio import Detector, Pad
from padstudio.geometry.pose import Pose
from padstudio.simulate.render import render

#: Median of the chi-squared law of six degrees of freedom.
_MEDIAN = 5.348
_CLASSES = "plain,waves,fold,lifted,gaps,turned-sheets,swapped-sheets"
Shown = tuple[str, NDArray[np.uint8], list[Pose], Detector]


def shown(name: str, every: dict[str, Pad], args: argparse.Namespace) -> Iterator[Shown]:
    """Name, picture, true poses (the nominal one first) and detector of a class's frames."""
    kind = CLASSES[name]
    for pad_name, pad in every.items():
        for number in range(args.frames):
            camera = USUAL[number % len(USUAL)]
            label = f"{name}_{pad_name}_{camera}_{args.seed}_{number}"
            kept = args.cache / f"{label}.npz" if args.cache else None
            if kept is not None and kept.exists():
                with np.load(kept) as held:
                    image = cv2.imdecode(held["png"], cv2.IMREAD_COLOR)
                    poses = [Pose(p, r) for p, r in zip(held["at"], held["turn"], strict=True)]
            else:
                key = [args.seed, number, *name.encode(), *pad_name.encode(), *b"prints"]
                rng = np.random.default_rng(key)
                shot = plain_shot(rng, pad, kind, camera)
                shot = kind.change(rng, shot, min(pad.size_mm))
                seed = int(rng.integers(2**31))
                frame = render(
                    shot.scene, CAMERAS[camera], shot.pose, shot.imaging, seed, motion=shot.motion
                )
                image, poses = frame.image, [frame.truth.pose, *frame.truth.also_true]
                if kept is not None:
                    kept.parent.mkdir(parents=True, exist_ok=True)
                    png = cv2.imencode(".png", image)[1]
                    at, turn = [p.position_mm for p in poses], [p.rotation for p in poses]
                    np.savez(kept, png=png, at=at, turn=turn)
            yield label, np.asarray(image, np.uint8), poses, Detector(pad, CAMERAS[camera])


def judged(item: Shown) -> dict[str, Any]:
    """What the detector makes of a frame."""
    label, image, poses, detector = item
    began = time.process_time()
    found = detector.detect(image)
    record: dict[str, Any] = {"frame": label, "ms": 1000 * (time.process_time() - began)}
    if found.pose is None or found.uncertainty is None:
        reason = found.failure.reason.value if found.failure else ""
        return record | {"verdict": "miss", "reason": reason}
    height = float(poses[0].position_mm[2])
    also = [plain(pose) for pose in poses[1:]]
    line = {"status": "ok", **plain(found.pose)}
    outcome = score.judge(plain(poses[0]) | {"also_true": also}, line, (label, 0))
    away = [float(np.linalg.norm(found.pose.position_mm - pose.position_mm)) for pose in poses]
    nees = [normalized_error(found, pose)[0] for pose in poses]
    turn = cv2.Rodrigues(found.pose.rotation.T @ poses[0].rotation)[0]
    return record | {
        "verdict": outcome.verdict,
        "height": height,
        "nominal": 100 * away[0] / height,
        "best": 100 * min(away) / height,
        "turn": float(np.degrees(np.linalg.norm(turn))),
        "nees": nees[0],
        "nees_best": min(nees),
        "flatness": found.flatness_mm,
        "quality": found.quality,
    }


HEAD = (
    f"{'class':16s}{'good':>6s}{'poor':>5s}{'false':>6s}{'miss':>5s}{'full':>5s}"
    f"{'best %':>9s}{'worst':>8s}{'nominal %':>11s}{'worst':>8s}"
    f"{'NEES':>9s}{'median':>8s}{'to best':>9s}{'median':>8s}{'ms':>8s}"
)


def summary(name: str, records: list[dict[str, Any]]) -> str:
    """A line of figures, under `HEAD`."""
    found = [record for record in records if "nees" in record]
    count = [sum(r["verdict"] == v for r in records) for v in ("good", "poor", "false", "miss")]
    line = f"{name:16s}{count[0]:6d}{count[1]:5d}{count[2]:6d}{count[3]:5d}"
    line += f"{sum(r['quality'] == 'full' for r in found):5d}"
    if not found:
        return line
    for key, width in (("best", 9), ("nominal", 11)):
        values = [record[key] for record in found]
        line += f"{np.median(values):{width}.3f}{max(values):8.2f}"
    for key in ("nees", "nees_best"):
        values = [record[key] for record in found]
        line += f"{np.mean(values):9.2f}{np.median(values) * 6 / _MEDIAN:8.2f}"
    return line + f"{np.median([record['ms'] for record in records]):8.1f}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--classes", default=_CLASSES, help="names of reality_classes.py")
    parser.add_argument("--frames", type=int, default=8, help="of each class and pad")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cache", type=Path, help="keep frames here, and take kept ones")
    parser.add_argument("--json", type=Path, help="write one record a frame")
    args = parser.parse_args()
    cv2.setNumThreads(1)
    every, everything = pads(), {}
    print(HEAD)
    for name in args.classes.split(","):
        everything[name] = [judged(item) for item in shown(name, every, args)]
        print(summary(name, everything[name]), flush=True)
    if args.json:
        args.json.write_text(json.dumps(everything, indent=1), encoding="utf-8")
    return int(any(r["verdict"] == "false" for records in everything.values() for r in records))


if __name__ == "__main__":
    raise SystemExit(main())
