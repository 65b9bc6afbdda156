"""Runs a shoot-out: every board is printed, photographed from every place, and read."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from padstudio.arrays import Image
from padstudio.experiments.shootout import reading
from padstudio.experiments.shootout.boards.catalogue import BOARDS, EXTRA
from padstudio.experiments.shootout.contestant import PREPARE_S, Contestant
from padstudio.experiments.shootout.drawings import thumbnail
from padstudio.experiments.shootout.entry import GROUND, PAD, Entry, title_of
from padstudio.experiments.shootout.machine import Beside
from padstudio.experiments.shootout.order import Shootout
from padstudio.experiments.shootout.reader_process import (
    ReaderFailedError,
    ReaderLostError,
    ReaderProcess,
)
from padstudio.experiments.shootout.reading import Reading
from padstudio.experiments.shootout.scores import Outcome, judge
from padstudio.experiments.shootout.views import View, is_movement
from padstudio.pad.layout import Layout
from padstudio.pad.spec import Pad
from padstudio.simulate.render import Frame, render

# Frames of bare ground that every reader is shown.
_BARE = 3


@dataclass
class Contest:
    """All that was found.

    Attributes
    ----------
    order : Shootout
    entries : list of Entry
    left_out : dict of str to str
        Boards that were asked for and did not take part, and why.
    pictures : dict of str to list of (H, W, 3) uint8
        A few frames of each board, BGR, small.
    beside : Beside
        What else the machine did.
    """

    order: Shootout
    entries: list[Entry] = field(default_factory=list)
    left_out: dict[str, str] = field(default_factory=dict)
    pictures: dict[str, list[Image]] = field(default_factory=dict)
    beside: Beside = field(default_factory=Beside)


def shown_views(count: int) -> list[int]:
    """The frames that are kept as pictures: first, middle and last."""
    return sorted({0, count // 2, count - 1})


def compete(order: Shootout, progress: Callable[[int, int], None]) -> Contest:
    """Run a shoot-out.

    Parameters
    ----------
    order : Shootout
    progress : callable
        Called with the steps that are over and those there are in all, before each; it may raise.
    """
    contest = Contest(order)
    prints = {PAD: order.pad} | _printed(order, contest.left_out)
    views, done = order.views, 0
    total = len(prints) * (len(views) + 1) + _BARE

    def step() -> None:
        nonlocal done
        progress(done, total)
        done += 1

    strangers = _strangers(order, prints, views, step)
    for board, print_ in prints.items():
        others = [stranger for stranger in strangers if stranger[0] != board]
        _read_board(contest, board, print_, others, step)
    contest.beside.end()
    progress(total, total)
    return contest


def _printed(order: Shootout, left_out: dict[str, str]) -> dict[str, Any]:
    """The sheets of the boards whose readers are there, each made in a process of its own."""
    sheets: dict[str, Layout] = {}
    for name in order.boards:
        package = BOARDS[name].missing
        if package is not None:
            left_out[name] = (
                f"{package} is not installed, which reads it; install it with "
                f'pip install "{EXTRA}", or alone with pip install {package}'
            )
            continue
        with ReaderProcess() as process:
            try:
                sheets[name] = process.call(PREPARE_S, reading.print_board, name, order.page)
            except (ReaderLostError, ReaderFailedError) as error:
                left_out[name] = f"it could not be printed: {error}"
    return sheets


def _strangers(
    order: Shootout, prints: dict[str, Any], views: list[View], step: Callable[[], None]
) -> list[tuple[str, bytes]]:
    """A frame of each board, by its name, and bare ground."""
    frames = [(name, print_, len(views) // 2) for name, print_ in prints.items()]
    places = np.linspace(0, len(views) - 1, _BARE + 2)[1:-1].astype(int)
    frames += [(GROUND, None, int(place)) for place in places]
    out = []
    for name, print_, number in frames:
        step()
        out.append((name, _encoded(_taken(order, print_, views[number], number))))
    return out


def _read_board(
    contest: Contest,
    board: str,
    print_: Pad | Layout,
    others: list[tuple[str, bytes]],
    step: Callable[[], None],
) -> None:
    """Photograph one board from every place, and have its readers read it."""
    order = contest.order
    what = order.pad if board == PAD else board
    with ExitStack() as stack:
        readers = [
            stack.enter_context(Contestant(what, setting, order.page, order.camera))
            for setting in _settings(order, board)
        ]
        entries = [Entry(board, reader.setting, troubles=reader.troubles) for reader in readers]
        kept = shown_views(order.frames)
        for number, view in enumerate(order.views):
            step()
            frame = _taken(order, print_, view, number)
            found = [reader.read(_encoded(frame), f"Frame {number + 1}") for reader in readers]
            for entry, one in zip(entries, found, strict=True):
                entry.outcomes.append(_outcome(view, frame, one))
            if number in kept:
                pose = found[0].pose if found[0] else None
                contest.pictures.setdefault(board, []).append(thumbnail(frame, pose, order.page))
        for entry, reader in zip(entries, readers, strict=True):
            for name, jpeg in others:
                one = reader.read(jpeg, f"A frame of {title_of(name)}")
                entry.strangers += one is not None
                if one is not None and one.pose is not None:
                    entry.mistaken.append(title_of(name))
    contest.entries += entries


def _settings(order: Shootout, board: str) -> tuple[str, ...]:
    if board != PAD:
        return reading.FAST, reading.THOROUGH
    if is_movement(order.flight):
        return reading.SINGLE, reading.FOLLOWED
    return (reading.SINGLE,)


def _taken(order: Shootout, print_: Pad | Layout | None, view: View, number: int) -> Frame:
    setup = order.setup(print_, number)
    return render(
        setup.scene, setup.camera, view.pose, setup.imaging, setup.seed, motion=view.motion
    )


def _encoded(frame: Frame) -> bytes:
    assert frame.encoded is not None, "every look stores JPEG files"
    return frame.encoded


def _outcome(view: View, frame: Frame, found: Reading | None) -> Outcome:
    height_mm, tilt_deg = view.height_mm, view.pose.tilt_deg
    if found is None:
        return Outcome(height_mm, tilt_deg, "missed")
    truths = (view.pose, *frame.truth.also_true)
    verdict, percent, angle = judge(found.pose, truths, view.distance_mm)
    return Outcome(height_mm, tilt_deg, verdict, percent, angle, found.cpu_ms, found.wall_ms)
