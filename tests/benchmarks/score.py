#!/usr/bin/env python3
"""Scores a poses file against the truth of some footage; needs only the standard library.

    score.py TRUTH.json POSES.jsonl [-v] [--json FILE]

A truth file is a list of stills, or an object with ``frames`` for a flight; a picture whose truth
has no position holds no pad. Lines and truths are matched by the file's stem and the frame number.

- good: position within 2 % of the camera's height plus 1 mm, and attitude within 2 degrees
- false: beyond 10 % plus 5 mm, or 10 degrees; also any pose where there is no pad
- poor: in between
- miss: no pose, or no line at all

Poses under ``also_true`` are as true as the one beside them; the nearest counts.

Exits with 1 if any pose is false.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import sys
from collections import Counter, defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import Any

VERDICTS = ("good", "poor", "false", "miss")
Key = tuple[str, int]


@dataclass(frozen=True)
class Outcome:
    """One frame's verdict; errors are None where there is no pose to compare."""

    key: Key
    group: str
    verdict: str
    reason: str
    position_percent: float | None = None
    attitude_deg: float | None = None


def rotation_angle_deg(a: list[list[float]], b: list[list[float]]) -> float:
    """Angle of the turn between two rotation matrices, degrees."""
    trace = sum(
        x * y for row, other in zip(a, b, strict=True) for x, y in zip(row, other, strict=True)
    )
    return math.degrees(math.acos(max(-1.0, min(1.0, (trace - 1.0) / 2.0))))


def judge(truth: dict[str, Any], pose: dict[str, Any] | None, key: Key) -> Outcome:
    """Compare one line of a poses file (None where there is none) with the truth."""
    found = pose is not None and pose["status"] == "ok"
    reason = "" if pose is None or found else f"{pose['stage']}: {pose['reason']}"
    if "position_mm" not in truth:
        return Outcome(key, "no pad", "false" if found else "good", reason)
    group = truth.get("group", "flight")
    if pose is None or not found:
        return Outcome(key, group, "miss", reason or "no line")
    trues = [truth, *truth.get("also_true", [])]
    nearest = min(trues, key=lambda true: math.dist(pose["position_mm"], true["position_mm"]))
    height_mm = nearest["position_mm"][2]
    error_mm = math.dist(pose["position_mm"], nearest["position_mm"])
    angle_deg = rotation_angle_deg(pose["rotation"], nearest["rotation"])
    if error_mm <= 0.02 * height_mm + 1 and angle_deg <= 2:
        verdict = "good"
    elif error_mm > 0.10 * height_mm + 5 or angle_deg > 10:
        verdict = "false"
    else:
        verdict = "poor"
    percent = 100 * error_mm / height_mm
    return Outcome(key, group, verdict, f"{percent:.2f} %, {angle_deg:.2f} deg", percent, angle_deg)


def read_truth(path: Path) -> dict[Key, dict[str, Any]]:
    """Truths by file stem and frame."""
    data = json.loads(path.read_text(encoding="utf-8"))
    if isinstance(data, dict):
        stem = path.name.removesuffix(".truth.json")
        return {(stem, frame["frame"]): frame for frame in data["frames"]}
    return {(Path(item["file"]).stem, 0): item for item in data}


def read_poses(path: Path) -> dict[Key, dict[str, Any]]:
    """Lines of a poses file by file stem and frame."""
    lines = path.read_text(encoding="utf-8").splitlines()
    poses = [json.loads(line) for line in lines if line.strip()]
    return {(Path(pose["source"]).stem, pose["frame"]): pose for pose in poses}


def score(truth: dict[Key, dict[str, Any]], poses: dict[Key, dict[str, Any]]) -> list[Outcome]:
    """Judge every frame of the truth."""
    return [judge(item, poses.get(key), key) for key, item in truth.items()]


def summary(outcomes: list[Outcome]) -> dict[str, Any]:
    """Counts, by group too, and medians over the good frames with a pose."""
    groups: dict[str, Counter[str]] = defaultdict(Counter)
    for outcome in outcomes:
        groups[outcome.group][outcome.verdict] += 1
    good = [o for o in outcomes if o.verdict == "good"]
    position = [o.position_percent for o in good if o.position_percent is not None]
    attitude = [o.attitude_deg for o in good if o.attitude_deg is not None]
    return {
        "frames": len(outcomes),
        "groups": {name: dict(counts) for name, counts in sorted(groups.items())},
        "total": dict(sum(groups.values(), Counter())),
        "median_position_percent": statistics.median(position) if position else None,
        "median_attitude_deg": statistics.median(attitude) if attitude else None,
    }


def show(figures: dict[str, Any]) -> None:
    """Print a summary as a table."""
    print(f"{'group':16}" + "".join(f"{verdict:>7}" for verdict in VERDICTS))
    for name, counts in [*figures["groups"].items(), ("all", figures["total"])]:
        print(f"{name:16}" + "".join(f"{counts.get(verdict, 0):7}" for verdict in VERDICTS))
    if figures["median_position_percent"] is not None:
        print(
            f"median of the good ones: position {figures['median_position_percent']:.4f} % of "
            f"height, attitude {figures['median_attitude_deg']:.4f} deg"
        )


def main() -> int:
    parser = argparse.ArgumentParser(description="Score a poses file against the truth.")
    parser.add_argument("truth", type=Path)
    parser.add_argument("poses", type=Path)
    parser.add_argument("-v", "--verbose", action="store_true", help="name what is not good")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    given = parser.parse_args()
    outcomes = score(read_truth(given.truth), read_poses(given.poses))
    figures = summary(outcomes)
    show(figures)
    if given.verbose:
        for outcome in outcomes:
            if outcome.verdict != "good":
                print(f"{outcome.verdict:6}{outcome.key[0]}:{outcome.key[1]}  {outcome.reason}")
    if given.json:
        given.json.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    return int(figures["total"].get("false", 0) > 0)


if __name__ == "__main__":
    sys.exit(main())
