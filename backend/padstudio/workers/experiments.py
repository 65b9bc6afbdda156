"""Makes an experiment in a worker process, in a folder that the server watches."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from padstudio.experiments.report import Experiment
from padstudio.experiments.writers import plain, write_report
from padstudio.workers.steps import reporter

#: In the folder: files of the report; the report as plain values.
FILES, RESULT = "files", "result.json"
_SCRATCH = "scratch"


def make_experiment(experiment: Experiment, order: Mapping[str, Any], folder: Path) -> None:
    """Make an experiment.

    Parameters
    ----------
    experiment : Experiment
        Importable by name.
    order : mapping
    folder : Path
        Takes `FILES`, `RESULT` and, meanwhile, how far it is (`padstudio.workers.steps`).

    Raises
    ------
    ConflictError
        Where it is told to stop, as of `padstudio.workers.steps.reporter`.
    StudioError
        As the experiment.
    """

    scratch = folder / _SCRATCH
    scratch.mkdir()
    found = experiment(order, scratch, reporter(folder, "experiment"))
    shutil.rmtree(scratch)
    write_report(found, folder / FILES)
    (folder / RESULT).write_text(json.dumps(plain(found), allow_nan=False), encoding="utf-8")
