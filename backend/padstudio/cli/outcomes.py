"""What commands that make a poses file write and say of its records."""

from __future__ import annotations

import json
from collections import Counter
from typing import IO, Any

import numpy as np

from padstudio.cli.support import show_error, show_table

Figures = dict[str, Any]

#: Exit code where no frame gave a pose.
EXIT_NOTHING_FOUND = 1
# What the summary says of poses that are not to be used as a whole.
_NOT_FULL = {"bearing": "range and bearing only", None: "quality unknown"}


def write_record(record: dict[str, Any], file: IO[str]) -> Figures:
    """Write a line of a poses file, and tell a frame that could not be read; its figures."""
    file.write(json.dumps(record, ensure_ascii=False) + "\n")
    file.flush()
    if record.get("stage") == "read":
        show_error(f"{record['source']}: {record['detail']}", record["reason"])
    return figures_of(record)


def figures_of(record: dict[str, Any]) -> Figures:
    """What the summary needs of a record, so that a long run does not keep them all."""
    ok = record["status"] == "ok"
    outcome = f"pose by {record.get('layer')}" if ok else f"failed at {record['stage']}"
    why = _NOT_FULL.get(record.get("quality"), "") if ok else record["reason"]
    elapsed_ms = record.get("elapsed_ms") or {}
    return {"ok": ok, "outcome": (outcome, why), "ms": elapsed_ms.get("total")}


def show_summary(records: list[Figures]) -> None:
    """Show on stderr how many frames came out how."""
    counts = Counter(figures["outcome"] for figures in records)
    rows = [
        (outcome, why, str(count), f"{100 * count / len(records):.1f} %")
        for (outcome, why), count in sorted(counts.items(), key=lambda item: (-item[1], item[0]))
    ]
    times = [figures["ms"] for figures in records if figures["ms"] is not None]
    show_table(
        ("outcome", "reason", "frames", "share"),
        rows,
        right=("frames", "share"),
        caption=f"median {np.median(times):.0f} ms a frame, picture decoded" if times else None,
        to_stderr=True,
    )
