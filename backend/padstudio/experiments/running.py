"""Runs the parts of an experiment, in this process or in several, with the same outcome."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import Any, TypeVar

import cv2

from padstudio.experiments.report import Progress

PartT = TypeVar("PartT")
ResultT = TypeVar("ResultT")


def run_parts(
    run: Callable[[PartT], ResultT], parts: Sequence[PartT], progress: Progress, workers: int = 1
) -> list[ResultT]:
    """The results of all parts, in their order.

    Parameters
    ----------
    run : callable
        Importable by name; its result depends on the part alone.
    parts : sequence
    progress : Progress
        Called before the first part and after each.
    workers : int
        Processes; with 1 all is done here.
    """
    progress(0, len(parts))
    if workers <= 1:
        results = []
        for done, part in enumerate(parts, 1):
            results.append(run(part))
            progress(done, len(parts))
        return results
    # A process for every core has one thread for linear algebra. NumPy reads this as it is
    # imported, which is before anything runs in a new process.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context, initializer=_alone) as pool:
        waiting = {pool.submit(run, part): place for place, part in enumerate(parts)}
        found: dict[int, Any] = {}
        try:
            for done, future in enumerate(as_completed(waiting), 1):
                found[waiting[future]] = future.result()
                progress(done, len(parts))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [found[place] for place in range(len(parts))]


def _alone() -> None:
    """One thread for OpenCV too."""
    # Ctrl-C reaches the whole group; the process that started these ends them itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    cv2.setNumThreads(1)
