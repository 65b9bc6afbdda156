"""What all commands share: one-line errors, notes and progress on stderr."""

from __future__ import annotations

import math
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from padstudio.errors import ConflictError, NotFoundError, StudioError

if TYPE_CHECKING:
    from padstudio.geometry.camera import Camera

#: Of every command that takes a camera file.
NoDistortion = Annotated[
    bool,
    typer.Option("--no-distortion", help="The lens has none, and the camera file is silent of it."),
]


def finite(value: float) -> float:
    """Refuse what is no finite number; limits of options alone would let NaN pass."""
    if not math.isfinite(value):
        raise typer.BadParameter("give a finite number")
    return value


# How the camera sits on its vehicle; bounds as in REST.
Turned = Annotated[
    float,
    typer.Option(
        min=-360,
        max=360,
        callback=finite,
        help="Of MAVLink: camera turned clockwise; at 0 its up is forward.",
    ),
]
Forward = Annotated[
    float,
    typer.Option(min=-100, max=100, callback=finite, help="Camera ahead of the vehicle's centre."),
]
Right = Annotated[
    float, typer.Option(min=-100, max=100, callback=finite, help="Camera to the right of it.")
]
Down = Annotated[float, typer.Option(min=-100, max=100, callback=finite, help="Camera below it.")]
LeanForward = Annotated[
    float,
    typer.Option(
        "--lean-forward-deg",
        min=-89,
        max=89,
        callback=finite,
        help="Its optical axis leans forward from straight down.",
    ),
]
LeanRight = Annotated[
    float,
    typer.Option(
        "--lean-right-deg",
        min=-89,
        max=89,
        callback=finite,
        help="Its optical axis leans to the right from straight down.",
    ),
]
#: Exit code of a wrong command line or input, as the shell's and click's own.
EXIT_USAGE = 2
#: Exit code of a program ended by Ctrl-C: 128 and the signal's number.
EXIT_INTERRUPTED = 130
#: Exit code of a program ended by SIGTERM, likewise.
EXIT_ENDED = 143
#: Exit code of a defect in the program (sysexits.h, EX_SOFTWARE).
EXIT_DEFECT = 70


#: The running program's command line.
_words: ContextVar[tuple[str, ...]] = ContextVar("words", default=())


def _end(_signal: int, _frame: object) -> None:
    """End in order, and say nothing: whoever sent the signal knows."""
    raise SystemExit(EXIT_ENDED)


class StudioGroup(TyperGroup):
    """Commands whose errors are one line, ``error: … (code)``, and an exit code."""

    def main(self, *args: Any, **options: Any) -> Any:
        given = args[0] if args else options.get("args")
        if threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGTERM, _end)
        _words.set(tuple(sys.argv[1:] if given is None else given))
        try:
            sys.exit(super().main(*args, **options | {"standalone_mode": False}))
        except StudioError as error:
            show_error(error.message, error.error_code)
            sys.exit(error.exit_code)
        except typer.Abort:
            show_error("interrupted", "interrupted")
            sys.exit(EXIT_INTERRUPTED)
        except OSError as error:
            _close_broken_pipe(error)
            place = f"{error.filename}: " if error.filename else ""
            show_error(f"{place}{error.strerror or error}", "os_error")
            sys.exit(EXIT_USAGE)
        except Exception as error:
            _end_usage_error(error)
            if os.environ.get("PADSTUDIO_DEBUG"):
                traceback.print_exception(error)
            show_error(
                f"a defect of the program: {type(error).__name__}: {error}; set PADSTUDIO_DEBUG=1 "
                "to see where",
                "internal_error",
            )
            sys.exit(EXIT_DEFECT)


def _end_usage_error(error: Exception) -> None:
    """End the program where the command line was wrong; typer shows help its own way."""
    if not hasattr(error, "format_message"):
        return
    context = getattr(error, "ctx", None)
    # Without arguments the help is shown by then.
    if type(error).__name__ != "NoArgsIsHelpError":
        hint = f"; see {context.command_path} --help" if context else ""
        show_error(f"{error.format_message().rstrip('.')}{hint}", "usage")
    sys.exit(EXIT_USAGE)


def _close_broken_pipe(error: OSError) -> None:
    """End quietly where the reader of stdout went away, as `head` does."""
    if isinstance(error, BrokenPipeError):
        # Python would complain once more when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)


def show_error(message: str, code: str) -> None:
    """Write ``error: message (code)`` to stderr, on one line."""
    print(f"error: {' '.join(message.split())} ({code})", file=sys.stderr)


def note(message: str) -> None:
    """Write a line for people to stderr; stdout is for data."""
    print(message, file=sys.stderr)


def open_camera(name: str, *, no_distortion: bool) -> Camera:
    """The camera of a file or a preset's id; what a user must know of it goes to stderr.

    Raises
    ------
    CameraFormatError
        As `padstudio.geometry.camera.Camera.load`.
    """
    from padstudio.geometry.lens_fold import fold_note
    from padstudio.geometry.presets import load_camera

    camera = load_camera(name, no_distortion=no_distortion)
    for each in (*camera.notes, fold_note(camera)):
        if each:
            note(f"camera {camera.name}: {each}")
    return camera


def check_said(
    paths: Iterable[Path], *, topic: str | None, camera: str | None, no_distortion: bool
) -> None:
    """Refuse options of recordings and camera files where there are none.

    Raises
    ------
    typer.BadParameter
    """
    from padstudio.media.sources import kind_of

    # A zip may hold a recording.
    if topic is not None and all(kind_of(path) in ("video", "still") for path in paths):
        raise typer.BadParameter("--topic is of recordings, and none of these files is one")
    if no_distortion and camera is None:
        raise typer.BadParameter("--no-distortion is of the file of --camera; give that too")


def _is_among(path: Path, others: Iterable[Path]) -> bool:
    """Whether a file is one of others, under whatever name or link."""
    found = path.stat()
    for other in others:
        with suppress(OSError, ValueError):
            if os.path.samestat(found, other.stat()):
                return True
    return False


def _times_named(path: Path) -> int:
    """How many words of the command line name a file, under whatever name or link."""
    count = 0
    for word in _words.get():
        names = [word, word.partition("=")[2]]
        if word.startswith("-") and not word.startswith("--"):
            names.append(word[2:])
        # A camera of a file with several is named FILE#NAME.
        names += [name.rpartition("#")[0] for name in names]
        count += _is_among(path, [Path(name) for name in names if name])
    return count


def check_output(path: Path, *, force: bool, inputs: Iterable[Path] = ()) -> None:
    """Refuse to write over a file, over what the command reads, or into a folder that is not there.

    Parameters
    ----------
    path : Path
    force : bool
        Files may be written over, but never those that are read.
    inputs : iterable of Path
        Beside those that the command line names one by one.

    Raises
    ------
    ConflictError, NotFoundError
    """
    # The option itself names it once.
    if path.is_file() and (_is_among(path, inputs) or _times_named(path) > 1):
        raise ConflictError(
            f"{path} is what this command reads; give the output another name",
            code="output_is_input",
        )
    if path.exists() and not force:
        raise ConflictError(
            f"{path} exists; give another name, or --force to write over it", code="file_exists"
        )
    if not path.parent.is_dir():
        raise NotFoundError(f"the folder {path.parent} does not exist; make it first")


@contextmanager
def progress_bar(
    label: str, total: float, *, counted: bool = True
) -> Iterator[Callable[[float], None]]:
    """A progress bar on stderr; nothing is drawn where stderr is no terminal.

    Parameters
    ----------
    label : str
    total : float
        What there is to do.
    counted : bool
        Show how many of how many, rather than a percentage.

    Yields
    ------
    callable
        To be called with what is done.
    """
    if not sys.stderr.isatty():
        yield lambda done: None
        return
    from rich import progress
    from rich.console import Console

    with progress.Progress(
        progress.TextColumn("{task.description}"),
        progress.BarColumn(),
        progress.MofNCompleteColumn() if counted else progress.TaskProgressColumn(),
        progress.TimeRemainingColumn(),
        console=Console(stderr=True),
        transient=True,
    ) as bar:
        task = bar.add_task(label, total=total)
        yield lambda done: bar.update(task, completed=done)


def show_table(
    columns: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    caption: str | None = None,
    right: Sequence[str] = (),
    whole: Sequence[str] = (),
    to_stderr: bool = False,
) -> None:
    """Draw a table.

    Parameters
    ----------
    columns : sequence of str
        Their headings.
    rows : iterable of sequence of str
    caption : str, optional
    right : sequence of str
        The columns whose cells stand at the right.
    whole : sequence of str
        The columns whose cells are never shortened.
    to_stderr : bool
    """
    from rich.console import Console
    from rich.table import Table

    rows = list(rows)
    table = Table(caption=caption)
    for place, name in enumerate(columns):
        table.add_column(
            name,
            justify="right" if name in right else "left",
            no_wrap=name in whole,
            min_width=max(len(row[place]) for row in rows) if name in whole else None,
        )
    for row in rows:
        table.add_row(*row)
    Console(stderr=to_stderr).print(table)
