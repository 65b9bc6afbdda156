"""Experiments as jobs: what comes of one is kept, and outlives the server."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from padstudio.store.experiments import KeptExperiment
from padstudio.web.server.folder_jobs import FolderJob
from padstudio.workers.steps import STOP, steps_of


@dataclass(kw_only=True)
class ExperimentJob(FolderJob):
    """One experiment; fields as of `padstudio.web.schemas.experiments.base.ExperimentInfo`.

    Attributes
    ----------
    kind : str
    order : mapping
        As it was given.
    """

    kind: str
    order: Mapping[str, Any]

    @property
    def steps_done(self) -> int:
        """Steps that are over."""
        return steps_of(self.folder).done

    @property
    def steps_total(self) -> int:
        """Steps in all; 0 before it has begun."""
        return steps_of(self.folder).total

    @property
    def kept(self) -> KeptExperiment:
        """What is kept of it."""
        return KeptExperiment(
            self.id, self.kind, self.name, self.created_at, self.order, self.steps_total
        )

    def stop(self) -> None:
        """Tell the worker that nobody waits for it."""
        # What is kept is over.
        with suppress(FileNotFoundError):
            (self.folder / STOP).touch()
