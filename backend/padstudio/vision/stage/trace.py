"""Stages, why one finds nothing, and the trace that keeps what each of them put out.

Finding nothing is a value (`StageFailure`), misuse is an exception (`padstudio.errors`).
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, ParamSpec, TypeVar

from padstudio.arrays import Image
from padstudio.pad.spec import Channel
from padstudio.vision.stage.memo import Memo, key_of

P = ParamSpec("P")
T = TypeVar("T")

#: The stages in their order. Those up to ``decode`` run once a channel.
STAGES = (
    "stretch",
    "denoise",
    "unmix",
    "channel",
    "block_mean",
    "clean",
    "edges",
    "lines",
    "grid",
    "decode",
    "choose",
    "pose",
    "outline",
)


class Reason(StrEnum):
    """Why a stage found nothing: the fixed list, the one place where it stands."""

    NO_CONTRAST = "no_contrast"
    UNDEREXPOSED = "underexposed"
    OVEREXPOSED = "overexposed"
    NO_EDGES = "no_edges"
    TOO_FEW_LINES = "too_few_lines"
    NO_LATTICE = "no_lattice"
    CELLS_TOO_SMALL = "cells_too_small"
    CELLS_TOO_LARGE = "cells_too_large"
    TOO_FEW_CELLS = "too_few_cells"
    UNKNOWN_CODE = "unknown_code"
    MOTION_BLUR = "motion_blur"
    CROSSTALK = "crosstalk"
    NO_OUTLINE = "no_outline"
    POSE_REJECTED = "pose_rejected"
    NO_LAYER = "no_layer"
    CHANNELS_SWAPPED = "channels_swapped"
    MIRRORED = "mirrored"
    INVERTED = "inverted"
    # These are told by a second look alone (`padstudio.vision.reasons`).
    BLACK_FRAME = "black_frame"
    DEFOCUS = "defocus"
    ANOTHER_PAD = "another_pad"
    COVERED = "covered"
    CUT_OFF = "cut_off"
    NO_PAD = "no_pad"
    MONOCHROME = "monochrome"
    WRONG_CAMERA = "wrong_camera"
    PRINT_SCALE = "print_scale"
    WARPED = "warped"


@dataclass(frozen=True)
class Finding:
    """What a second look found wrong with a frame.

    Attributes
    ----------
    reason : Reason
    detail : str
        A sentence with the measured figures.
    advice : str
        What to try, in plain words.
    """

    reason: Reason
    detail: str
    advice: str


@dataclass(frozen=True)
class StageFailure:
    """A stage found nothing.

    Attributes
    ----------
    stage : str
        One of `STAGES`.
    reason : Reason
    detail : str
        A sentence with the measured figures.
    advice : str
        What to try, in plain words.
    also : tuple of Finding
        What a second look found besides, the likeliest first.
    """

    stage: str
    reason: Reason
    detail: str
    advice: str = ""
    also: tuple[Finding, ...] = ()

    @property
    def progress(self) -> int:
        """How near to an answer it came: the stage's number, that of `outline`, tried first, −1."""
        return -1 if self.stage == "outline" else STAGES.index(self.stage)


@dataclass(frozen=True)
class StageRecord:
    """One stage's run in a trace.

    Attributes
    ----------
    name : str
        One of `STAGES`.
    channel : {"red", "green", "blue"} or None
        None for stages that serve all channels.
    elapsed_ms : float
    output : object
        The stage's own frozen dataclass, or a `StageFailure`.
    """

    name: str
    channel: Channel | None
    elapsed_ms: float
    output: object

    @property
    def failure(self) -> StageFailure | None:
        """The failure, where the stage found nothing."""
        return self.output if isinstance(self.output, StageFailure) else None


@dataclass(frozen=True)
class Trace:
    """Every stage's output for one frame, in the order they ran.

    Attributes
    ----------
    image : (H, W, 3) uint8
        The frame, BGR.
    records : tuple of StageRecord
    """

    image: Image
    records: tuple[StageRecord, ...]

    def get(self, name: str, channel: Channel | None = None) -> StageRecord | None:
        """The last run of a stage in a channel, or of a stage that serves all channels."""
        for record in reversed(self.records):
            if record.name == name and record.channel in (channel, None):
                return record
        return None


class Recorder:
    """The clock and, for a trace, the memory of one frame's run.

    Parameters
    ----------
    keep : bool
        Keep every stage's output.
    memo : Memo or None
        Of earlier runs over the same frame: stages whose inputs are the same are not run again,
        and count with the time that they took then.
    in_full : bool
        A failure's reasons are wanted in full, by a second look that takes its time.
    """

    def __init__(self, *, keep: bool, memo: Memo | None = None, in_full: bool = False) -> None:
        self.keep, self.memo, self.in_full = keep, memo, in_full
        self._started = time.perf_counter()
        self._elapsed: dict[str, float] = defaultdict(float)
        self._records: list[StageRecord] = []
        self._failed: dict[Channel, StageFailure] = {}

    def run(
        self,
        name: str,
        channel: Channel | None,
        stage: Callable[P, T],
        *args: P.args,
        **kwargs: P.kwargs,
    ) -> T:
        """Run a stage, time it, keep its output."""
        output, elapsed = self._called(name, stage, args, kwargs)
        self._elapsed[name] += elapsed
        self.note(name, channel, output, elapsed)
        return output

    def make(self, name: str, make: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Make what stages work on: with a memo the same object of the same inputs.

        Parameters
        ----------
        name : str
            The stage whose parameters it may depend on.
        make : callable
        """
        return self._called(name, make, args, kwargs)[0]

    def _called(
        self, name: str, function: Callable[..., T], args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> tuple[T, float]:
        """What a function gives, and what it took, ms."""
        key = None
        if self.memo is not None:
            key = key_of(name, function, (args, kwargs))
            found = self.memo.find(key)
            if found is not None:
                return found
        begin = time.perf_counter()
        output = function(*args, **kwargs)
        elapsed = 1e3 * (time.perf_counter() - begin)
        if self.memo is not None:
            self.memo.keep(key, output, elapsed, (function, args, kwargs))
        return output, elapsed

    def note(self, name: str, channel: Channel | None, output: object, elapsed: float = 0) -> None:
        """Keep an output that was made elsewhere; of failures that of each channel that came
        nearest to an answer, also without a trace."""
        if channel is not None and isinstance(output, StageFailure):
            before = self._failed.get(channel, output)
            self._failed[channel] = max(before, output, key=lambda failure: failure.progress)
        if self.keep:
            self._records.append(StageRecord(name, channel, elapsed, output))

    def append(self, other: Recorder) -> None:
        """Keep another run's outputs behind one's own; its time does not count."""
        self._records.extend(other._records)

    @property
    def failed_at(self) -> dict[Channel, str]:
        """The stage at which each channel failed that was looked at, where it came farthest."""
        return {channel: failure.stage for channel, failure in self._failed.items()}

    def elapsed_ms(self) -> dict[str, float]:
        """Milliseconds per stage, and ``total`` since the recorder was made."""
        return {**self._elapsed, "total": 1e3 * (time.perf_counter() - self._started)}

    def trace(self, image: Image) -> Trace | None:
        """The trace, where one was asked for."""
        return Trace(image, tuple(self._records)) if self.keep else None
