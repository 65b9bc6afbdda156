"""An experiment of a moment: what stands in for one that takes minutes."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from padstudio.experiments.report import (
    Claim,
    Column,
    Figure,
    Progress,
    Report,
    Section,
    Table,
)

SVG = b'<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><path d="M1 1h7v7z"/></svg>'
#: So many seeds are more than any test waits for.
ENDLESS = 100


def make(order: Mapping[str, Any], folder: Path, progress: Progress) -> Report:
    """A report of one section; ``seeds`` are the steps it takes."""
    (folder / "scratch").write_text("not kept")
    steps = order["seeds"]
    for done in range(steps):
        progress(done, steps)
        time.sleep(1.0 if steps == ENDLESS else 0.0)
    progress(steps, steps)
    return report()


def report() -> Report:
    """What it says."""
    table = Table("small", "A <b>table</b> | of two", (Column("x"), Column("y, mm", 2)), _ROWS)
    figure = Figure("sketch", ".svg", SVG, "A triangle.", "a triangle")
    claim = Claim("It is small.", "held within", "It has 3 rows.", "reason")
    return Report(
        "Small", ("Words.",), (Section("One", ("More.",), (claim,), (table,), (figure,)),)
    )


_ROWS = (("a", 1.23456), ("b", -0.001), ("c", None))
