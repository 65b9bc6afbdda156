#!/usr/bin/env python3
"""What a fresh process costs until one picture is read, or one pad made: processor time, memory.

    bench_start.py [--runs N] [--against DIR] [--json FILE]

Beside the importing of NumPy, OpenCV and Numba alone. All run in turns; --against takes turns with
another checkout, too. Code is compiled before: each runs once more than is counted.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples"
PAD, CAMERA, PICTURE = (SAMPLES / n for n in ("pad.json", "camera.yaml", "height_1300mm.jpg"))
LIBRARIES = "import numpy, cv2, numba"
PYTHON = f"""
import cv2
from padstudio import Camera, Detector, Pad
detector = Detector(Pad.load({str(PAD)!r}), Camera.load({str(CAMERA)!r}))
assert detector.detect(cv2.imread({str(PICTURE)!r})).ok
"""
PROGRAM = """
try:
    from padstudio.cli.program import main
except ImportError:  # where an older checkout has it
    from padstudio.cli import main
main()
"""
DETECT = ["detect", "--pad", PAD, "--camera", CAMERA, PICTURE]


@dataclass
class Start:
    """One kind of start and what its runs took.

    Attributes
    ----------
    name : str
    arguments : list of str
        Of Python.
    root : Path
        The checkout.
    cpu_s, wall_s, memory_mb : list of float
    """

    name: str
    arguments: list[str]
    root: Path
    cpu_s: list[float] = field(default_factory=list)
    wall_s: list[float] = field(default_factory=list)
    memory_mb: list[float] = field(default_factory=list)

    def run(self, folder: str) -> tuple[float, float, float]:
        """Processor time, wall time and the most memory of one run."""
        environment = os.environ | {"PYTHONPATH": str(self.root / "backend")}
        # Without what Python compiles of its sources, every start would be of that.
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        start = time.perf_counter()
        process = os.fork()
        if not process:
            os.chdir(folder)
            nowhere = os.open(os.devnull, os.O_RDWR)
            os.dup2(nowhere, 1)
            os.dup2(nowhere, 2)
            os.execve(sys.executable, [sys.executable, "-c", *self.arguments], environment)
        _, status, usage = os.wait4(process, 0)
        if status:
            raise SystemExit(f"error: {self.name} failed; run it by hand")
        wall_s = time.perf_counter() - start
        return usage.ru_utime + usage.ru_stime, wall_s, usage.ru_maxrss / 1024

    def count(self, folder: str) -> None:
        """Run once more, and keep what it took."""
        for kept, value in zip(
            (self.cpu_s, self.wall_s, self.memory_mb), self.run(folder), strict=True
        ):
            kept.append(value)


def starts(root: Path) -> list[Start]:
    """The starts of a checkout."""
    tail = "" if root == ROOT else f" ({root.name})"
    generate = ["generate", "--cells", "125", "--force", "-o", f"{root.name}.json"]
    return [
        Start(f"three lines of Python{tail}", [PYTHON], root),
        Start(f"padstudio detect{tail}", [PROGRAM, *map(str, DETECT)], root),
        Start(f"padstudio generate{tail}", [PROGRAM, *generate], root),
        Start(f"padstudio --version{tail}", [PROGRAM, "--version"], root),
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--against", type=Path, help="another checkout")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    first = Start(LIBRARIES, [LIBRARIES], ROOT)
    found = [first, *starts(ROOT)]
    if options.against:
        found += starts(options.against.resolve())
    with tempfile.TemporaryDirectory() as folder:
        for start in found:
            start.run(folder)
        for _ in range(options.runs):
            for start in found:
                start.count(folder)
    print("| start | CPU s, median | least … most | ratio | wall s | MB |")
    print("|---|---|---|---|---|---|")
    unit = statistics.median(first.cpu_s)
    for start in found:
        cpu_s = statistics.median(start.cpu_s)
        print(
            f"| {start.name} | {cpu_s:.2f} | {min(start.cpu_s):.2f} … {max(start.cpu_s):.2f} | "
            f"{cpu_s / unit:.2f} | {statistics.median(start.wall_s):.2f} | "
            f"{statistics.median(start.memory_mb):.0f} |"
        )
    if options.json:
        kept = {
            s.name: {"cpu_s": s.cpu_s, "wall_s": s.wall_s, "memory_mb": s.memory_mb} for s in found
        }
        options.json.write_text(json.dumps(kept, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
