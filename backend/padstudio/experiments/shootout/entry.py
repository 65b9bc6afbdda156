"""A board in a shoot-out, as one reader read it."""

from __future__ import annotations

from dataclasses import dataclass, field

from padstudio.experiments.shootout.boards.catalogue import BOARDS
from padstudio.experiments.shootout.scores import Outcome

#: The names of the user's pad, and of bare ground, among the boards.
PAD, GROUND = "pad", "ground"


def title_of(board: str) -> str:
    """A board's name for people."""
    return {PAD: "Pad", GROUND: "bare ground"}.get(board) or BOARDS[board].title


@dataclass
class Entry:
    """A board as one reader read it.

    Attributes
    ----------
    board : str
        `PAD`, or a name of `BOARDS`.
    setting : str
    outcomes : list of Outcome
        A frame each, in the order of the flight.
    strangers : int
        Frames without the board that were shown.
    mistaken : list of str
        What was on those in which a pose was found.
    troubles : list of str
    """

    board: str
    setting: str
    outcomes: list[Outcome] = field(default_factory=list)
    strangers: int = 0
    mistaken: list[str] = field(default_factory=list)
    troubles: list[str] = field(default_factory=list)

    @property
    def title(self) -> str:
        """Of the board, for people."""
        return title_of(self.board)
