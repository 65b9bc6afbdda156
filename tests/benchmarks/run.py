#!/usr/bin/env python3
"""Runs the benchmarks beside it, one after the other, each in a process of its own.

    run.py [NAME …] [--OPTION …]

A name is a part of a file's name: ``run.py footage`` runs ``bench_footage.py``. Options, from the
first one on, go to every benchmark that is run.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def main() -> int:
    given = sys.argv[1:]
    first_option = next((k for k, word in enumerate(given) if word.startswith("-")), len(given))
    wanted, options = given[:first_option] or [""], given[first_option:]
    scripts = [p for p in sorted(HERE.glob("bench_*.py")) if any(w in p.stem for w in wanted)]
    if not scripts:
        print(f"error: no benchmark is called {' or '.join(wanted)}", file=sys.stderr)
        return 2
    failed = []
    for script in scripts:
        print(f"\n== {script.stem.removeprefix('bench_')}", flush=True)
        if subprocess.run([sys.executable, script, *options], check=False).returncode:
            failed.append(script.name)
    if failed:
        print(f"error: failed: {', '.join(failed)}", file=sys.stderr)
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
