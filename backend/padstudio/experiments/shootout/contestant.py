"""One reader in a shoot-out: its process, and what it made of each frame."""

from __future__ import annotations

from types import TracebackType

from padstudio.experiments.shootout import reading
from padstudio.experiments.shootout.boards.sheets import Page
from padstudio.experiments.shootout.reader_process import (
    ReaderFailedError,
    ReaderLostError,
    ReaderProcess,
)
from padstudio.experiments.shootout.reading import Reading
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad

#: Seconds for a frame, and for getting ready, in which loops may have to be compiled.
FRAME_S, PREPARE_S = 60.0, 600.0
#: A reader that was lost so often is not started again.
MOST_LOSSES = 3


class Contestant:
    """A reader with a process of its own; use it as a context.

    Parameters
    ----------
    board : str or Pad
        What it reads.
    setting : str
        As of `padstudio.experiments.shootout.reading`.
    page : Page
    camera : Camera
    """

    def __init__(self, board: str | Pad, setting: str, page: Page, camera: Camera) -> None:
        self.setting = setting
        #: What went wrong, a sentence each.
        self.troubles: list[str] = []
        self._board, self._page, self._camera = board, page, camera
        self._process: ReaderProcess | None = None
        self._losses = 0

    def __enter__(self) -> Contestant:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        self._end()

    def read(self, jpeg: bytes, name: str) -> Reading | None:
        """What it makes of a frame; None where it was lost at it, or is no more.

        Parameters
        ----------
        jpeg : bytes
        name : str
            Of the frame, for what is told of troubles.
        """
        if self._losses >= MOST_LOSSES:
            return None
        try:
            process = self._started(jpeg)
            twice = self.setting in (reading.SINGLE, reading.FAST)
            answer: Reading = process.call(FRAME_S, reading.read, jpeg, twice)
            return answer
        except (ReaderLostError, ReaderFailedError) as error:
            self._losses += 1
            self.troubles.append(f"{name}: the reader {_worded(error)}.")
            if self._losses == MOST_LOSSES:
                self.troubles.append(
                    f"After {MOST_LOSSES} such frames it was not started again; what follows "
                    "counts as missed."
                )
            self._end()
            return None

    def _started(self, first: bytes) -> ReaderProcess:
        if self._process is None:
            self._process = ReaderProcess()
            self._process.call(
                PREPARE_S,
                reading.prepare,
                self._board,
                self.setting,
                self._page,
                self._camera,
                first,
            )
        return self._process

    def _end(self) -> None:
        if self._process is not None:
            self._process.__exit__()
            self._process = None


def _worded(error: Exception) -> str:
    return str(error) if isinstance(error, ReaderLostError) else f"failed ({error})"
