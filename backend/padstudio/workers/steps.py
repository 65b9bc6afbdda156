"""How far a task is, in a folder that the server watches, and where it is told to stop."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from padstudio.errors import ConflictError
from padstudio.workers.inside import checkpoint

#: In the folder: steps done and in all; asked to stop.
_STEPS, _WRITTEN, STOP = "steps", "steps.new", "stop"


class Steps(NamedTuple):
    """How far a task is."""

    done: int
    total: int


def reporter(folder: Path, word: str) -> Callable[[int, int], None]:
    """What a task calls between its steps with those done and in all; requests go first.

    Parameters
    ----------
    folder : Path
    word : str
        What the task is called.

    Raises
    ------
    ConflictError
        When called, where `STOP` appears in the folder, or the folder is gone.
    """

    def report(done: int, total: int) -> None:
        # Who stops a task twice forgets it, and its folder.
        if (folder / STOP).exists() or not folder.exists():
            raise ConflictError(f"the {word} was stopped", code="cancelled")
        # In its place at once: the server may look at any moment.
        (folder / _WRITTEN).write_text(f"{done} {total}")
        (folder / _WRITTEN).replace(folder / _STEPS)
        checkpoint()

    return report


def steps_of(folder: Path) -> Steps:
    """How far a folder's task is; nothing in all before it knows."""
    try:
        done, total = (folder / _STEPS).read_text().split()
    except FileNotFoundError:
        return Steps(0, 0)
    return Steps(int(done), int(total))
