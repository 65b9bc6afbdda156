"""All boards that take part in a shoot-out: how each is printed, and how it is read."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass

from padstudio.experiments.shootout.boards import apriltags, aruco, charuco, puzzle
from padstudio.experiments.shootout.boards.aruco import Read
from padstudio.experiments.shootout.boards.sheets import Page
from padstudio.geometry.camera import Camera
from padstudio.pad.layout import Layout

#: The extra with which all readers are installed.
EXTRA = "padstudio[shootout]"


@dataclass(frozen=True)
class Board:
    """Another board that the pad is compared with.

    Attributes
    ----------
    title : str
    note : str
        One line for people: what is printed, and what reads it.
    sheet : callable
        From the page to what is printed on it.
    reader : callable
        From the page, the camera, and whether to be thorough, to a reader.
    package : (distribution, module) or None
        What must be installed to read it; None for what Pad Studio itself needs.
    usual : bool
        Whether it takes part where boards are not chosen.
    """

    title: str
    note: str
    sheet: Callable[[Page], Layout]
    reader: Callable[[Page, Camera, bool], Read]
    package: tuple[str, str] | None = None
    usual: bool = True

    @property
    def missing(self) -> str | None:
        """The distribution that is not installed, if it is so."""
        if self.package is None or importlib.util.find_spec(self.package[1]) is not None:
            return None
        return self.package[0]


_APRILTAGS = ("pupil-apriltags", "pupil_apriltags")
_PUZZLES = ("calib-targets", "calib_targets")


def _tag(family: str, note: str) -> Board:
    return Board(
        f"AprilTag {family.removeprefix('tag')}",
        note,
        apriltags.tag_sheet(family),
        apriltags.tag_reader(family),
        _APRILTAGS,
    )


#: By the names that users give, in the order of the report.
BOARDS = {
    "aruco-board": Board(
        "ArUco board",
        "25 markers (4X4_1000) along the longer side; OpenCV",
        aruco.board_sheet,
        aruco.board_reader,
    ),
    "aruco-single": Board(
        "ArUco single",
        "one marker (ARUCO_MIP_36h12) over the page; OpenCV",
        aruco.single_sheet,
        aruco.single_reader,
    ),
    "aruco-nested": Board(
        "ArUco nested",
        "markers (5X5_1000) in each other's middle module, an eleventh of the size each; OpenCV",
        aruco.nested_sheet,
        aruco.nested_reader,
    ),
    "charuco": Board(
        "ChArUco",
        "25 squares along the longer side with markers (5X5_1000); OpenCV",
        charuco.charuco_sheet,
        charuco.charuco_reader,
    ),
    "apriltag-16h5": _tag("tag16h5", "one tag over the page; pupil-apriltags"),
    "apriltag-25h9": _tag("tag25h9", "one tag over the page; pupil-apriltags"),
    "apriltag-36h11": _tag("tag36h11", "one tag over the page; pupil-apriltags"),
    "apriltag-nested": Board(
        "AprilTag nested",
        "tags (Custom48h12) in each other's middle, a fifth of the size each; pupil-apriltags",
        apriltags.nested_sheet,
        apriltags.nested_reader,
        _APRILTAGS,
    ),
    "puzzleboard": Board(
        "PuzzleBoard",
        "50 squares along the longer side; calib-targets",
        puzzle.puzzle_sheet(50),
        puzzle.puzzle_reader(50),
        _PUZZLES,
    ),
    "puzzleboard-fine": Board(
        "PuzzleBoard fine",
        "125 squares along the longer side; calib-targets",
        puzzle.puzzle_sheet(125),
        puzzle.puzzle_reader(125),
        _PUZZLES,
        usual=False,
    ),
}
USUAL = tuple(name for name, board in BOARDS.items() if board.usual)
