"""Simulated flights as jobs: the upload and the analysis that come of one stay."""

from __future__ import annotations

from dataclasses import dataclass

from padstudio.web.server.folder_jobs import FolderJob
from padstudio.workers.simulated_flights import STOP, frames_done


@dataclass(kw_only=True)
class SimulationJob(FolderJob):
    """One simulated flight; fields as of `padstudio.web.schemas.simulations.Simulation`."""

    frames_total: int
    video: bool
    upload: str | None = None
    flight: str | None = None

    @property
    def frames_done(self) -> int:
        """Frames that are rendered."""
        return self.frames_total if self.state == "done" else frames_done(self.folder)

    def stop(self) -> None:
        """Tell the worker that nobody waits for it."""
        (self.folder / STOP).touch()
