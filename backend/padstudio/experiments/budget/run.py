"""Works a budget off: in this process, or with several that take a frame each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from padstudio.experiments.budget.budget import Budget, first_cases, make_budget
from padstudio.experiments.budget.frames import Reading, read_frame
from padstudio.experiments.budget.order import BudgetOrder, Case
from padstudio.experiments.budget.sections import report_of
from padstudio.experiments.report import Progress, Report
from padstudio.experiments.running import run_parts


def budget_report(order: Mapping[str, Any], folder: Path, progress: Progress) -> Report:
    """The experiment of an order in plain values, as `BudgetOrder.from_plain` takes it.

    Parameters
    ----------
    order : mapping
    folder : Path
        Not used: nothing is kept but the report.
    progress : Progress

    Raises
    ------
    SpecError, LimitError, PadFormatError, CameraFormatError
    """
    return report_of(budget(BudgetOrder.from_plain(order), progress))


def budget(order: BudgetOrder, progress: Progress, workers: int = 1) -> Budget:
    """The budget; the same order gives the same one whatever the number of processes.

    Parameters
    ----------
    order : BudgetOrder
    progress : Progress
        Called with pictures.
    workers : int
        Processes; with 1 all is done here, and ``progress`` is called after each picture.

    Raises
    ------
    SpecError, LimitError
        As `padstudio.simulate.render.render`.
    """
    cases = len(first_cases(order)) + order.is_checked
    work = _Work(order, progress, cases * order.frames, workers)
    found = make_budget(order, work.measure)
    progress(work.total, work.total)
    return found


class _Work:
    def __init__(self, order: BudgetOrder, progress: Progress, total: int, workers: int) -> None:
        self.total = total
        self._order, self._progress, self._workers = order, progress, workers
        self._done = 0

    def measure(self, cases: Sequence[Case]) -> list[list[Reading]]:
        """As of `make_budget`."""
        order, frames = self._order, range(self._order.frames)
        if self._workers <= 1:
            by_frame = [read_frame(order, each, cases, self._step) for each in frames]
        else:
            begun = self._done
            by_frame = run_parts(
                _alone,
                [(order, each, cases) for each in frames],
                lambda done, _: self._progress(begun + done * len(cases), self.total),
                self._workers,
            )
            self._done += len(cases) * order.frames
        return [list(readings) for readings in zip(*by_frame, strict=True)]

    def _step(self) -> None:
        self._done += 1
        self._progress(self._done, self.total)


def _alone(part: tuple[BudgetOrder, int, Sequence[Case]]) -> list[Reading]:
    order, number, cases = part
    return read_frame(order, number, cases, lambda: None)
