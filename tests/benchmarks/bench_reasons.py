#!/usr/bin/env python3
"""Is the reason that a frame fails for, or is to be doubted for, the one that was done to it?

    bench_reasons.py [--frames N] [--seed S] [--causes NAME,…] [--cache FOLDER] [--first] [-v]

For each cause (reason_causes.py) N frames are made in which exactly that is wrong, of three pads
and three cameras in turn, and the detector's reasons are asked for in full: the first one counts.
A table shows what was said of each. Seed 1 was tuned on; the default is another. With --first the
reason is that of flights, without a second look. Exits with 1 below 90 % right.
"""

from __future__ import annotations

import argparse
import pickle
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path

import cv2
from reason_causes import CAUSES, Case, cases

from padstudio import Detector
from padstudio.errors import CameraMismatchError

GOAL = 0.9
FINE = "nothing"


def said(case: Case, *, in_full: bool) -> tuple[list[str], str]:
    """The reasons that the detector names, the first one first, and its words."""
    try:
        found = Detector(case.pad, case.camera).detect(case.image, reasons=in_full)
    except CameraMismatchError as error:
        return ["turned" if error.detail.get("turned") else error.code], error.message
    if found.failure is None:
        names = [str(item.reason) for item in found.warnings]
        return names or [FINE], " / ".join(item.detail for item in found.warnings)
    failure = found.failure
    others = [str(item.reason) for item in failure.also]
    return [str(failure.reason), *others], failure.detail


def kept(name: str, args: argparse.Namespace) -> Iterator[Case]:
    """The frames of a cause, from the cache where they are."""
    if args.cache is None:
        yield from cases(name, args.frames, args.seed)
        return
    file = args.cache / f"{name.replace(' ', '_')}-{args.seed}-{args.frames}.pickle"
    if not file.exists():
        args.cache.mkdir(parents=True, exist_ok=True)
        file.write_bytes(pickle.dumps(list(cases(name, args.frames, args.seed))))
    yield from pickle.loads(file.read_bytes())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=6, help="of each cause")
    parser.add_argument("--seed", type=int, default=2)
    parser.add_argument("--causes", default="", help="names, by commas")
    parser.add_argument("--cache", type=Path, help="keep the frames here")
    parser.add_argument("--first", action="store_true", help="without a second look")
    parser.add_argument("-v", "--verbose", action="store_true", help="every frame")
    args = parser.parse_args()
    cv2.setNumThreads(1)
    right, total, times = 0, 0, []
    print(f"{'cause':18} {'frames':>6} {'first':>6} {'named':>6}  said first")
    for name in args.causes.split(",") if args.causes else CAUSES:
        rows, mean, wanted = defaultdict(int), Counter(), CAUSES[name].reason or name
        for case in kept(name, args):
            begin = time.thread_time()
            names, detail = said(case, in_full=not args.first)
            times.append(time.thread_time() - begin)
            rows["frames"] += 1
            rows["first"] += names[0] == wanted
            rows["named"] += wanted in names
            mean[names[0]] += 1
            if args.verbose:
                print(f"    {times[-1]:.2f} s {', '.join(names)}: {detail}", flush=True)
        listed = ", ".join(f"{key} {count}" for key, count in mean.most_common())
        print(
            f"{name:18} {rows['frames']:6} {rows['first']:6} {rows['named']:6}  {listed}",
            flush=True,
        )
        right, total = right + rows["first"], total + rows["frames"]
    times.sort()
    print(
        f"{right} of {total} right; CPU s median {times[len(times) // 2]:.2f}, most {times[-1]:.2f}"
    )
    return int(right < GOAL * total)


if __name__ == "__main__":
    sys.exit(main())
