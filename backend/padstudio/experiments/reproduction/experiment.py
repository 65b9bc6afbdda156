"""The paper's experiments as one experiment with a report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from padstudio.errors import SpecError, shown
from padstudio.experiments.report import Progress, Report
from padstudio.experiments.reproduction.plan import EXPERIMENTS, SEEDS, ExperimentName, shots_of
from padstudio.experiments.reproduction.reading import FrameRead, read_shot
from padstudio.experiments.reproduction.sections import TITLE, conditions, section_of
from padstudio.experiments.running import run_parts


def reproduce(order: Mapping[str, Any], folder: Path, progress: Progress) -> Report:
    """Make the experiments again.

    Parameters
    ----------
    order : mapping
        ``seeds``: frames of each place. ``only``: which experiments; none names all. ``workers``:
        processes, 1 unless given; the report is the same.
    folder : Path
        Not used: nothing of this experiment is too large to keep in mind.
    progress : Progress
        Counts frames.

    Raises
    ------
    SpecError
        As `wanted` and `padstudio.experiments.reproduction.plan.shots_of`.
    """
    seeds = int(order.get("seeds", SEEDS))
    names = wanted(order.get("only") or ())
    frames = run_parts(read_shot, shots_of(names, seeds), progress, order.get("workers", 1))
    return report_of(names, seeds, frames)


def wanted(only: Sequence[str]) -> list[ExperimentName]:
    """Experiments in the order of the report; all of them where none is named.

    Raises
    ------
    SpecError
        If a name is unknown.
    """
    for name in only:
        if name not in EXPERIMENTS:
            raise SpecError(f"no experiment {shown(name)}; choose from {', '.join(EXPERIMENTS)}")
    return [name for name in EXPERIMENTS if name in only] if only else list(EXPERIMENTS)


def report_of(names: Sequence[ExperimentName], seeds: int, frames: Sequence[FrameRead]) -> Report:
    """The report of frames that were read."""
    sections = tuple(section_of(name, frames) for name in names)
    return Report(TITLE, conditions(seeds, len(frames)), sections)
