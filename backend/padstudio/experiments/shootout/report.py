"""The report of a shoot-out: under which conditions, what was found, and with which boards."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from padstudio.experiments.report import Column, Progress, Report, Section, Table
from padstudio.experiments.shootout.boards.catalogue import BOARDS, EXTRA
from padstudio.experiments.shootout.contest import Contest, compete
from padstudio.experiments.shootout.entry import PAD
from padstudio.experiments.shootout.order import Shootout
from padstudio.experiments.shootout.results import better_boards, frames, pictures, times, verdicts
from padstudio.experiments.shootout.scores import READ_DEG, READ_PERCENT

_FRACTAL = (
    "Fractal ArUco markers do not take part: the implementation of their authors is under the GPL. "
    "What others measured, not here: on like frames (a descent from 16 m to 6 cm with a marker of "
    "the same printed size) 23 of 60 frames over the whole pad, 2 of 40 at its edge, 28 of 32 "
    "tilts, about 110 ms a frame.",
    "Their authors report a marker of 36.5 cm, held in view, to be read from 20 m down to 5 cm "
    "(400 : 1): F. J. Romero-Ramirez, R. Muñoz-Salinas, R. Medina-Carnicer, “Fractal Markers: A "
    "New Approach for Long-Range Marker Pose Estimation Under Occlusion”, IEEE Access 7 (2019), "
    "169908–169919, doi 10.1109/ACCESS.2019.2951204.",
)


def run(order: Mapping[str, Any], folder: Path, progress: Progress) -> Report:
    """Hold a shoot-out.

    Parameters
    ----------
    order : mapping
        As of `padstudio.experiments.shootout.order.Shootout.of`.
    folder : Path
        Nothing is put there.
    progress : Progress

    Raises
    ------
    StudioError
        As `Shootout.of`.
    """
    return report_of(compete(Shootout.of(order), progress))


def report_of(contest: Contest) -> Report:
    """What was found, for people."""
    order = contest.order
    name = order.pad.name or "pad"
    found = [part(contest) for part in (verdicts, better_boards, times, frames, pictures)]
    sections = [*found, _boards(contest)]
    return Report(f"Shoot-out of {name}", _conditions(contest), tuple(sections))


def _conditions(contest: Contest) -> tuple[str, ...]:
    order = contest.order
    page, camera = order.page, order.camera
    heights = f"{order.from_mm / 1000:g} m"
    if order.flight not in ("tilts", "hover"):
        heights += f" to {order.to_mm / 1000:g} m"
    words = [
        f"All boards are printed {page.width_mm:g} × {page.height_mm:g} mm large and photographed "
        f"in simulation from the same places by {camera.name} ({camera.width} × {camera.height}, "
        f"f = {camera.focal_px:.0f} px): {order.flight}, {order.frames} frames, {heights}, over "
        f"{order.ground}; look {order.look}"
        + (f", with {', '.join(order.disturbances)}" if order.disturbances else "")
        + f"; seed {order.seed}.",
        f"A frame is read where the position is within {READ_PERCENT:g} % of the distance to the "
        f"ground along the optical axis and the attitude within {READ_DEG:g}° of the truth; any "
        "other pose is false; without a pose the frame is missed.",
    ]
    words += [
        f"{BOARDS[name].title} is left out: {reason}." for name, reason in contest.left_out.items()
    ]
    missing = [
        board.title
        for name, board in BOARDS.items()
        if board.missing and name not in contest.left_out
    ]
    if missing:
        words.append(
            f"Nor were {', '.join(missing)} asked for, whose readers are not installed: "
            f'pip install "{EXTRA}".'
        )
    return tuple(words)


def _boards(contest: Contest) -> Section:
    taken_part = dict.fromkeys(entry.board for entry in contest.entries)
    rows = tuple((BOARDS[name].title, BOARDS[name].note) for name in taken_part if name != PAD)
    caption = "What is printed, and what reads it."
    table = Table("readers", caption, (Column("board"), Column("what")), rows)
    words = (
        "Fast settings are each reader's own: markers thresholded at one width (OpenCV), squares "
        "looked for at half the resolution (pupil-apriltags), a board of known place "
        "(calib-targets). Thorough ones look for smaller markers, at the whole resolution, or with "
        "every setting that the reader itself tries in turn. The corners of all but the pad become "
        "poses in the same way (RANSAC, IPPE, Levenberg–Marquardt); of nested markers the largest "
        "one seen counts.",
        *_FRACTAL,
    )
    return Section("Boards and readers", words, tables=(table,) if rows else ())
