#!/usr/bin/env python3
"""What really happens to prints and cameras: the detector beside what could be read.

    bench_reality.py [--classes NAME,…] [--frames N] [--pads NAME,…] [--footage FOLDER]
                     [--json FILE] [--markdown FILE] [--save FOLDER] [--list]

For each class (reality_classes.py) it takes N frames of each pad, gives them to the detector, and
asks the oracle (oracle.py) whether the cells can be read if the true pose is known. Verdicts are
those of score.py; a class whose pictures hold no valid pad counts any pose as false. Of a print
that is bent or in sheets the poses relative to its nominal plane and to those that fit it best are
all true, and of copies those relative to each. With --footage the frames of a truth file of the
same form are judged too.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import score
from bench_covariance import normalized_error, plain
from numpy.typing import NDArray
from oracle import Reading, best_reading, reading_at
from reality_classes import CLASSES
from reality_shots import CAMERAS, USUAL, pads, plain_shot

from padstudio import Camera, Detector, Pad
from padstudio.geometry.pose import Pose
from padstudio.simulate.render import render

#: Median of the chi-squared law of six degrees of freedom.
_MEDIAN = 5.348
COLUMNS = (
    "class",
    "frames",
    "oracle",
    "good",
    "poor",
    "false",
    "of them full",
    "missed",
    "of oracle's",
    "error %",
    "worst %",
    "NEES mean",
    "median",
    "ms",
    "why missed",
)


@dataclass(frozen=True)
class Sample:
    """A frame with its true poses, none where any pose is false, and what the oracle reads."""

    name: str
    group: str
    image: NDArray[np.uint8]
    poses: tuple[Pose, ...]
    reading: Reading | None
    detector: Detector


def simulated(name: str, chosen: dict[str, Pad], frames: int, seed: int) -> Iterator[Sample]:
    """The frames of a class; each has a seed of its own."""
    kind = CLASSES[name]
    for pad_name, pad in chosen.items():
        detectors: dict[str, Detector] = {}
        for number in range(frames):
            rng = np.random.default_rng([seed, number, *name.encode(), *pad_name.encode()])
            camera = kind.camera or USUAL[number % len(USUAL)]
            shot = kind.change(rng, plain_shot(rng, pad, kind, camera), min(pad.size_mm))
            frame = render(
                shot.scene,
                CAMERAS[camera],
                shot.pose,
                shot.imaging,
                int(rng.integers(2**31)),
                motion=shot.motion,
            )
            truth, image = frame.truth, frame.image
            reading = None if kind.after else best_reading(image, pad, truth)
            poses = () if kind.after else (truth.pose, *truth.also_true)
            detector = detectors.setdefault(camera, Detector(pad, CAMERAS[camera]))
            label = f"{name}_{pad_name}_{camera}_{number}"
            picture = kind.after(image) if kind.after else image
            yield Sample(label, name, picture, poses, reading, detector)


def footage(folder: Path) -> Iterator[Sample]:
    """The frames of a truth file of stills, with the pad beside its folder or in it."""
    truths = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    home = folder if (folder / "pad_a.json").exists() else folder.parent
    pad = Pad.load(home / "pad_a.json")
    detectors: dict[str, Detector] = {}
    for item in truths:
        detector = detectors.setdefault(
            item["camera"], Detector(pad, Camera.load(home / item["camera"]))
        )
        image = np.asarray(cv2.imread(str(home / item["file"])), np.uint8)
        given = [item, *item.get("also_true", [])] if "position_mm" in item else []
        poses = tuple(Pose(np.array(p["position_mm"]), np.array(p["rotation"])) for p in given)
        reading = reading_at(image, pad, detector.camera, list(poses)) if poses else None
        group = f"footage: {item.get('group', 'stills')}"
        yield Sample(Path(item["file"]).stem, group, image, poses, reading, detector)


def judged(sample: Sample) -> dict[str, Any]:
    """What the detector makes of a frame."""
    began = time.thread_time()
    found = sample.detector.detect(sample.image)
    elapsed_ms = 1000 * (time.thread_time() - began)
    record: dict[str, Any] = {
        "frame": sample.name,
        "class": sample.group,
        "oracle": bool(sample.reading and sample.reading.readable),
        "oracle_log10": sample.reading.log10_chance if sample.reading else None,
        "ms": elapsed_ms,
        "reason": found.failure.reason.value if found.failure else "",
        "detail": found.failure.detail if found.failure else "",
    }
    if found.pose is None:
        return record | {"verdict": "miss" if sample.poses else "good"}
    record |= {"quality": getattr(found, "quality", "full"), "layer": found.layer}
    if not sample.poses:
        return record | {"verdict": "false"}
    truth, *also = (plain(pose) for pose in sample.poses)
    line = {"status": "ok", **plain(found.pose)}
    outcome = score.judge(truth | {"also_true": also}, line, (sample.name, 0))
    record |= {"verdict": outcome.verdict, "error_percent": outcome.position_percent}
    # What was read could be read.
    record["oracle"] = record["oracle"] or outcome.verdict == "good"
    if found.uncertainty is not None:
        record["nees"] = min(normalized_error(found, pose)[0] for pose in sample.poses)
    return record


def row(name: str, records: list[dict[str, Any]]) -> list[str]:
    """A line of the table, as of `COLUMNS`."""
    count = Counter(record["verdict"] for record in records)
    readable = [record for record in records if record["oracle"]]
    found = [record for record in records if "error_percent" in record]
    errors = [r["error_percent"] for r in found if r["verdict"] in ("good", "poor")]
    nees = [record["nees"] for record in found if "nees" in record]
    why = Counter(record["reason"] for record in records if record["verdict"] == "miss")
    read = sum(record["verdict"] == "good" for record in readable)
    full = sum(r["verdict"] == "false" and r["quality"] == "full" for r in records)
    return [
        name,
        str(len(records)),
        str(len(readable)) if any(r["oracle_log10"] is not None for r in records) else "–",
        *(str(count[verdict]) for verdict in ("good", "poor", "false")),
        str(full),
        str(count["miss"]),
        f"{read}/{len(readable)}",
        f"{np.median(errors):.4f}" if errors else "–",
        f"{max(errors):.3f}" if errors else "–",
        f"{np.mean(nees):.2f}" if nees else "–",
        f"{np.median(nees) * 6 / _MEDIAN:.2f}" if nees else "–",
        f"{np.median([record['ms'] for record in records]):.0f}",
        ", ".join(f"{reason} {times}" for reason, times in why.most_common(2)),
    ]


def save(folder: Path, sample: Sample, record: dict[str, Any]) -> None:
    """Keep a frame that failed, with what is known of it and the pad and camera to try it with."""
    folder.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(folder / f"{sample.name}.png"), sample.image)
    camera, pad = sample.detector.camera, sample.detector.pad
    known = record | {"poses": [plain(pose) for pose in sample.poses]}
    (folder / f"{sample.name}.json").write_text(json.dumps(known, indent=1), encoding="utf-8")
    camera.save(folder / f"{sample.name}.camera.yaml")
    pad.save(folder / f"{sample.name}.pad.json")


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--classes", default="", help="names or their beginnings, by commas")
    parser.add_argument("--frames", type=int, default=6, help="of each class and pad")
    parser.add_argument("--pads", default="", help="of: paper, other")
    parser.add_argument("--footage", type=Path, action="append", default=[], help="truth.json's")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=Path, help="write one record a frame")
    parser.add_argument("--markdown", type=Path, help="write the table")
    parser.add_argument("--save", type=Path, help="keep readable frames that are not good")
    parser.add_argument("--list", action="store_true", help="name the classes")
    return parser.parse_args()


def samples(args: argparse.Namespace) -> Iterator[Sample]:
    """All frames that were asked for, class by class."""
    wanted = [word for word in args.classes.split(",") if word]
    chosen = {k: v for k, v in pads().items() if not args.pads or k in args.pads.split(",")}
    if not args.footage or wanted:
        for name in CLASSES:
            if not wanted or any(name.startswith(word) for word in wanted):
                yield from simulated(name, chosen, args.frames, args.seed)
    for folder in args.footage:
        yield from sorted(footage(folder), key=lambda sample: sample.group)


def main() -> int:
    args = options()
    if args.list:
        print("\n".join(CLASSES))
        return 0
    cv2.setNumThreads(1)
    # The loops load before anything is timed.
    for name in ("plain", "fog"):
        first = next(simulated(name, pads(), 1, 0))
        first.detector.detect(first.image)
    everything: dict[str, list[dict[str, Any]]] = {}
    lines = [" | ".join(COLUMNS), " | ".join("---" for _ in COLUMNS)]
    print("\n".join(f"| {line} |" for line in lines), flush=True)
    for sample in samples(args):
        if sample.group not in everything and everything:
            lines.append(_show(everything))
        record = judged(sample)
        everything.setdefault(sample.group, []).append(record)
        if args.save and record["verdict"] != "good":
            save(args.save, sample, record)
    lines.append(_show(everything))
    every = [record for records in everything.values() for record in records]
    lines.append(" | ".join(row("all", every)))
    print(f"| {lines[-1]} |")
    if args.json:
        args.json.write_text(json.dumps(everything, indent=1), encoding="utf-8")
    if args.markdown:
        table = "\n".join(f"| {line} |" for line in lines)
        args.markdown.write_text(table + "\n", encoding="utf-8")
    return int(any(record["verdict"] == "false" for record in every))


def _show(everything: dict[str, list[dict[str, Any]]]) -> str:
    """Print the line of the class that is complete."""
    name = list(everything)[-1]
    line = " | ".join(row(name, everything[name]))
    print(f"| {line} |", flush=True)
    return line


if __name__ == "__main__":
    raise SystemExit(main())
