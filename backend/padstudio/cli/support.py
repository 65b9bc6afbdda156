"""What all commands share: one-line errors, notes on stderr, reading pad and camera."""

from __future__ import annotations

import os
import sys
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from typer.core import TyperGroup

from padstudio.errors import ConflictError, NotFoundError, StudioError

if TYPE_CHECKING:
    from rich.progress import Progress

    from padstudio.geometry.camera import Camera
    from padstudio.pad.spec import Pad

#: Exit code of a wrong command line or input, as the shell's and click's own.
EXIT_USAGE = 2
#: Exit code of a program ended by Ctrl-C: 128 and the signal's number.
EXIT_INTERRUPTED = 130
#: Exit code of a defect in the program (sysexits.h, EX_SOFTWARE).
EXIT_DEFECT = 70
PRESET_PREFIX = "preset-"


class StudioGroup(TyperGroup):
    """Commands whose errors are one line, ``error: … (code)``, and an exit code."""

    def main(self, *args: Any, **options: Any) -> Any:
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


def load_pad(path: Path) -> Pad:
    """The pad of a pad file."""
    from padstudio.pad.spec import Pad

    return Pad.load(path)


def load_camera(name: str) -> Camera:
    """The camera of a camera file, or of a preset's id."""
    from padstudio.geometry import presets
    from padstudio.geometry.camera import Camera

    if name.startswith(PRESET_PREFIX) and not Path(name).exists():
        return presets.get(name).camera
    return Camera.load(name)


def check_output(path: Path, *, force: bool) -> None:
    """Refuse to write over a file, or into a folder that is not there.

    Raises
    ------
    ConflictError, NotFoundError
    """
    if path.exists() and not force:
        raise ConflictError(
            f"{path} exists; give another name, or --force to write over it", code="file_exists"
        )
    if not path.parent.is_dir():
        raise NotFoundError(f"the folder {path.parent} does not exist; make it first")


def progress_bar(*, counted: bool = True) -> Progress:
    """A progress bar on stderr; nothing is drawn where stderr is no terminal.

    Parameters
    ----------
    counted : bool
        Show how many of how many, rather than a percentage.
    """
    from rich import progress
    from rich.console import Console

    console = Console(stderr=True)
    return progress.Progress(
        progress.TextColumn("{task.description}"),
        progress.BarColumn(),
        progress.MofNCompleteColumn() if counted else progress.TaskProgressColumn(),
        progress.TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
        transient=True,
    )
