"""Parts of a series that a claim is about, and where a method reads in them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from padstudio.experiments.report import Verdict
from padstudio.experiments.reproduction.plan import (
    PLACES,
    WINDOW,
    ExperimentName,
    Place,
    paper_camera,
)
from padstudio.experiments.reproduction.reading import FrameRead
from padstudio.experiments.reproduction.tables import at, share_read

#: A place counts as read where at least so many of its frames gave a pose, percent.
READ_SHARE = 90.0


@dataclass(frozen=True)
class Span:
    """Places of a series that a claim is about.

    Attributes
    ----------
    series : ExperimentName
    low, high : float
        Of what tells its places apart.
    value : callable
        Of a place.
    unit : str
        As it follows a number.
    """

    series: ExperimentName
    low: float
    high: float
    value: Callable[[Place], float]
    unit: str

    @property
    def places(self) -> list[tuple[int, float]]:
        """Numbers and values of the places, in the order of the values."""
        found = [(k, self.value(place)) for k, place in enumerate(PLACES[self.series])]
        return sorted((f for f in found if self.low <= f[1] <= self.high), key=lambda f: f[1])

    def good(self, frames: Sequence[FrameRead], method: str) -> list[bool]:
        """Which of them count as read."""
        return [
            share_read(at(frames, self.series, k), method) >= READ_SHARE for k, _ in self.places
        ]

    def longest(self, good: Sequence[bool]) -> tuple[float, float] | None:
        """The ends of the longest run of places that are good; None where none is."""
        best: list[float] = []
        run: list[float] = []
        for is_good, (_, value) in zip(good, self.places, strict=True):
            run = [*run, value] if is_good else []
            best = max(best, run, key=len)
        return (best[0], best[-1]) if best else None

    def within(self, good: Sequence[bool]) -> str:
        """The longest run of places that are good, in words; nothing where all or none are."""
        run = self.longest(good)
        return "" if run is None or all(good) else self._run(run)

    def in_words(self, frames: Sequence[FrameRead], method: str, layer: str = "") -> str:
        """Where a method reads, or one layer by it, as part of a sentence."""
        good = self.good(frames, f"{method} {layer}".strip())
        run = self.longest(good)
        if run is None:
            return f"{method} reads at none of {len(good)} places"
        if all(good):
            return f"{method} reads at all of {len(good)} places"
        return f"{method} reads at {self._run(run)} ({sum(good)} of {len(good)} places)"

    def _run(self, run: tuple[float, float]) -> str:
        ends = dict.fromkeys(f"{end:g}" for end in run)
        return " to ".join(ends) + self.unit


def verdict_of(good: Sequence[bool]) -> Verdict:
    """Of the places that bear a claim out."""
    if not good:
        return "not measured"
    return "held" if all(good) else "held within" if any(good) else "does not hold"


def height_cm(place: Place) -> float:
    """A place's height, cm."""
    return place.height_mm / 10


def least_height_cm(cell_mm: float) -> float:
    """From where a window of cells fits the picture's shorter side, looking straight down."""
    camera = paper_camera()
    return WINDOW * cell_mm * camera.focal_px / min(camera.width, camera.height) / 10


def cells_across(height_mm: float, cell_mm: float) -> float:
    """Cells along the picture's shorter side, looking straight down."""
    camera = paper_camera()
    return height_mm * min(camera.width, camera.height) / camera.focal_px / cell_mm
