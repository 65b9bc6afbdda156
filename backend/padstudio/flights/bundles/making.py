"""Makes a bundle: of a still, or of a frame of a flight with what the run knew before it."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import cv2

from padstudio.arrays import Image, YuvFrame
from padstudio.errors import ImageError, TaskStoppedError
from padstudio.flights.bundles.around import Around
from padstudio.flights.bundles.contents import Alone, Bundle, Neighbour, Record, pack
from padstudio.flights.bundles.replay import plain, read_alone, read_frame
from padstudio.flights.tasks.detectors import Recipe
from padstudio.flights.tasks.frames import StillPart, VideoPart, still_bytes
from padstudio.flights.tuning.bench import Subject, detector_of
from padstudio.media import images
from padstudio.media.video_frames import VideoPicture
from padstudio.vision.dense.tracker import Expectation
from padstudio.vision.stage.detection import Method
from padstudio.workers.inside import checkpoint


@dataclass(frozen=True)
class Beside:
    """A frame beside another one.

    Attributes
    ----------
    offset : int
        Before (−1) or behind (1).
    part : VideoPart or StillPart
        That frame alone.
    recorded : dict or None
        What the run recorded.
    """

    offset: int
    part: VideoPart | StillPart
    recorded: Record | None = None


@dataclass(frozen=True)
class RunFrame:
    """A frame as a flight's run read it.

    Attributes
    ----------
    recipe : Recipe
    part : VideoPart or StillPart
        The video's last timestamp is the frame's; through those before it the run followed the pad.
    recorded : dict or None
        What the run recorded.
    version : str
        Of the program that recorded it.
    beside : tuple of Beside
    around : Around or None
        What the run's fused pose follows from, where it fuses.
    """

    recipe: Recipe
    part: VideoPart | StillPart
    recorded: Record | None = None
    version: str = ""
    beside: tuple[Beside, ...] = ()
    around: Around | None = None

    @property
    def frames(self) -> int:
        """How many are decoded for it."""
        part = self.part
        return 1 if isinstance(part, StillPart) else len(part.timestamps) + len(self.beside)


@dataclass(frozen=True)
class Wish:
    """How a page shows the frame.

    Attributes
    ----------
    method : {"dense", "paper"}
    params : str
        As of a `Recipe`.
    view : mapping of str to str
        Of its address.
    """

    method: Method
    params: str
    view: Mapping[str, str] = field(default_factory=dict)


def bundle_still(
    recipe: Recipe, data: bytes, source: str, max_pixels: int = images.MAX_PIXELS
) -> Bundle:
    """Read a still and bundle it.

    Parameters
    ----------
    recipe : Recipe
    data : bytes
        Its file.
    source : str
        Its name.
    max_pixels : int

    Raises
    ------
    ImageError, LimitError
        If it cannot be read.
    """
    frame = images.decode(data, max_pixels)
    found, stages = read_frame(recipe, frame, "still", None)
    return Bundle(recipe, frame, data, "still", None, plain(found.to_record(source)), trace=stages)


def bundle_run(run: RunFrame, wish: Wish, max_pixels: int = images.MAX_PIXELS) -> Bundle:
    """Read a flight's frame as its run did, and by itself, and bundle it.

    Raises
    ------
    ImageError
        If the decoder gives no picture for the frame.
    StudioError
        If its file cannot be read.
    TaskStoppedError
    """
    frame: Image | YuvFrame
    original: bytes | None = None
    expected: Expectation | None = None
    pictures: dict[int, Image | None] = {}
    if isinstance(run.part, StillPart):
        original = still_bytes(run.part)
        frame = images.decode(original, max_pixels)
    else:
        frame, expected, pictures = _followed(run, run.part, max_pixels)
    found, stages = read_frame(run.recipe, frame, "run", expected)
    source = run.part.name
    made = Bundle(
        run.recipe,
        frame,
        original,
        "run",
        expected,
        plain(found.to_record(source)),
        recorded=None if run.recorded is None else plain(run.recorded),
        recorded_version=run.version,
        trace=stages,
        view=wish.view,
        around=run.around,
        neighbours=tuple(_neighbour(each, pictures, max_pixels) for each in run.beside),
    )
    alone = Alone(wish.method, wish.params, {})
    return replace(made, alone=replace(alone, result=read_alone(made, alone, source)))


def _followed(
    run: RunFrame, part: VideoPart, max_pixels: int
) -> tuple[Image | YuvFrame, Expectation | None, dict[int, Image | None]]:
    """The frame, what following knew before it, and pictures of neighbours that came on the way."""
    behind = [
        each.part.pts
        for each in run.beside
        if isinstance(each.part, VideoPart) and _goes_on(part, each.part)
    ]
    on_the_way = replace(part, pts=b"".join([part.pts, *behind]))
    with contextlib.closing(on_the_way.read(max_pixels)) as pictures:
        lead = _Lead(pictures, part.timestamps[-1])
        expected = detector_of(run.recipe).expect_after(lead.frames())
        if lead.found is None or lead.found.frame is None:
            raise ImageError(
                "the decoder gives no picture for this frame: its data are missing or damaged",
                code="frame_lost",
            )
        near = {} if lead.last is None else {lead.last.pts: lead.last.bgr}
        near |= {picture.pts: picture.bgr for picture in pictures}
        return lead.found.frame, expected, near


class _Lead:
    """A video's frames until the one that is wanted."""

    def __init__(self, pictures: Iterator[VideoPicture], wanted: int) -> None:
        self._pictures, self._wanted = pictures, wanted
        self.last: VideoPicture | None = None
        self.found: VideoPicture | None = None

    def frames(self) -> Iterator[Image | YuvFrame]:
        for picture in self._pictures:
            if checkpoint():
                raise TaskStoppedError
            if picture.pts == self._wanted:
                self.found = picture
                return
            self.last = picture
            if picture.frame is not None:
                yield picture.frame


def _goes_on(part: VideoPart, other: VideoPart) -> bool:
    """True where another frame is decoded on the way."""
    return other.url == part.url and other.timestamps[0] > part.timestamps[-1]


def _neighbour(each: Beside, pictures: Mapping[int, Image | None], max_pixels: int) -> Neighbour:
    part = each.part
    recorded = None if each.recorded is None else plain(each.recorded)
    if isinstance(part, VideoPart) and part.timestamps[-1] in pictures:
        return Neighbour(each.offset, pictures[part.timestamps[-1]], recorded)
    try:
        picture = Subject("", part, max_pixels).read()
    except ImageError:
        picture = None
    return Neighbour(each.offset, picture, recorded)


@dataclass(frozen=True)
class Job:
    """A bundle to be made.

    Attributes
    ----------
    subject : Path or RunFrame
        A still's file, or a frame of a flight.
    recipe : Recipe
        As the page reads the frame.
    source : str
        The still's name.
    view : mapping of str to str
    max_pixels : int
    target : Path
        Where the zip goes.
    """

    subject: Path | RunFrame
    recipe: Recipe
    source: str
    view: Mapping[str, str]
    max_pixels: int
    target: Path


def make(job: Job) -> None:
    """Make a bundle and write it; runs in a worker, and raises as `bundle_run`."""
    threads = cv2.getNumThreads()
    # A worker is one process for one core.
    cv2.setNumThreads(1)
    try:
        job.target.write_bytes(pack(_made(job)))
    finally:
        cv2.setNumThreads(threads)


def _made(job: Job) -> Bundle:
    if isinstance(job.subject, Path):
        made = bundle_still(job.recipe, job.subject.read_bytes(), job.source, job.max_pixels)
        return replace(made, view=job.view)
    wish = Wish(job.recipe.method, job.recipe.params, job.view)
    return bundle_run(job.subject, wish, job.max_pixels)
