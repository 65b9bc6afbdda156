"""Calibrations as jobs: a camera that comes of one is stored when it is asked for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from padstudio.web.server.folder_jobs import FolderJob
from padstudio.workers.steps import STOP, Steps, steps_of


@dataclass(kw_only=True)
class CalibrationJob(FolderJob):
    """One calibration; fields as of `padstudio.web.schemas.calibrations.CalibrationInfo`.

    Attributes
    ----------
    pad : str
        Id of the stored pad.
    result : dict or None
        As of `padstudio.calibration.record`.
    camera_yaml : str
        The camera's file, once it is done.
    """

    pad: str
    result: dict[str, Any] | None = None
    camera_yaml: str = ""

    @property
    def steps(self) -> Steps:
        """How far it is."""
        return steps_of(self.folder)

    @property
    def steps_done(self) -> int:
        """Steps that are over."""
        return self.steps.total if self.state == "done" else self.steps.done

    @property
    def steps_total(self) -> int:
        """Steps at the most; 0 while pictures are read."""
        return self.steps.total

    def stop(self) -> None:
        """Tell the worker that nobody waits for it."""
        (self.folder / STOP).touch()
