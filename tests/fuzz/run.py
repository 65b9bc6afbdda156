#!/usr/bin/env python3
"""Fuzzes the readers of files from outside, for so many minutes in all.

    run.py [--minutes N] [--seed N] [--keep] [TARGET …]

Files that reach new lines of the program are changed further (as American Fuzzy Lop does). A
process of its own reads them, so that a crash of a decoder is a finding like an exception. Findings
are written to ``build/fuzz/TARGET/`` and end the script with 1. ``--keep`` writes the smallest
files that together reach all lines to the corpus, which `make test` reads.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import os
import random
import sys
import time
from multiprocessing import Process, get_context
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "support")]

from fuzz_session import Limits, Session  # noqa: E402
from fuzz_targets import CORPUS, TARGETS, kept  # noqa: E402

FINDINGS = ROOT / "build" / "fuzz"
_KEPT_FILES, _KEPT_BYTES = 40, 1500


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("targets", nargs="*", choices=[[], *TARGETS], metavar="TARGET")
    parser.add_argument("--minutes", type=float, default=5, help="for all targets together")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", action="store_true", help="renew the corpus in tests/fuzz/corpus")
    given = parser.parse_args()
    names = given.targets or list(TARGETS)
    found = 0
    print("| reader | files | files a second of CPU | lines reached | findings |")
    print("|---|---|---|---|---|")
    for name in names:
        found += _fuzz(name, given.minutes * 60 / len(names), given.seed, keep=given.keep)
    return bool(found)


def _fuzz(name: str, seconds: float, seed: int, *, keep: bool) -> int:
    """Fuzz one reader, in processes one after another where a file costs one its life."""
    folder = FINDINGS / name
    folder.mkdir(parents=True, exist_ok=True)
    end = time.monotonic() + seconds
    files, lines, cpu_s, crashes = 0, 0, 0.0, 0
    while time.monotonic() < end:
        reports: Any = get_context("spawn").SimpleQueue()
        arguments = (name, end - time.monotonic(), seed + crashes, folder, keep, reports)
        process = get_context("spawn").Process(target=_child, args=arguments)
        process.start()
        report = _last(process, reports)
        files, cpu_s, lines = files + report[0], cpu_s + report[1], max(lines, report[2])
        if process.exitcode == 0:
            break
        crashes += 1
        current = folder / "current"
        if current.exists():
            data = current.read_bytes()
            _write(folder, data, f"the process ended with {process.exitcode}")
    findings = len(list(folder.glob("*.txt")))
    print(
        f"| {name} | {files} | {files / max(cpu_s, 1e-9):.0f} | {lines} | {findings} |", flush=True
    )
    return findings


def _last(process: Process, reports: Any) -> tuple[int, float, int]:
    """The last report of a process, once it has ended."""
    last = (0, 0.0, 0)
    while process.is_alive() or not reports.empty():
        if reports.empty():
            time.sleep(0.2)
        else:
            last = reports.get()
    process.join()
    return last


def _child(name: str, seconds: float, seed: int, folder: Path, keep: bool, reports: Any) -> None:
    target = TARGETS[name]
    seeds = [*target.seeds(), *(data for _, data in kept(name))]
    session = Session(target, random.Random(seed), Limits(), folder / "current")
    end, told = time.monotonic() + seconds, 0.0
    for data in seeds:
        _look(session, data, folder)
    parent = os.getppid()
    while time.monotonic() < end and os.getppid() == parent:
        _look(session, session.next(), folder)
        if time.monotonic() > told + 1:
            told = time.monotonic()
            reports.put((session.files, time.process_time(), session.lines))
    reports.put((session.files, time.process_time(), session.lines))
    (folder / "current").unlink(missing_ok=True)
    if keep:
        _keep(name, session)


def _look(session: Session, data: bytes, folder: Path) -> None:
    fault = session.look(data)
    if fault is not None:
        _write(folder, session.smaller(data, fault), fault)


def _write(folder: Path, data: bytes, fault: str) -> None:
    """Keep a finding, one of each kind."""
    kind = hashlib.sha256(fault.splitlines()[-1].encode()).hexdigest()[:12]
    text = folder / f"{kind}.txt"
    if not text.exists():
        text.write_text(fault, encoding="utf-8")
        (folder / kind).write_bytes(data)
        print(f"a finding: {folder / kind}\n{fault}", file=sys.stderr, flush=True)


def _keep(name: str, session: Session) -> None:
    folder = CORPUS / name
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.glob("reach-*"):
        path.unlink()
    for data in session.smallest(_KEPT_FILES, _KEPT_BYTES):
        (folder / f"reach-{hashlib.sha256(data).hexdigest()[:8]}.bin").write_bytes(data)


if __name__ == "__main__":
    with contextlib.suppress(KeyboardInterrupt):
        sys.exit(main())
