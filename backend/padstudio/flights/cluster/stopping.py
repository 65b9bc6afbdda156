"""How a task says that it ended early; light, as the engine needs it before any task."""

from __future__ import annotations


class TaskStoppedError(Exception):
    """The task was told to stop; what it had done is dropped."""
