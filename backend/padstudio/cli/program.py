"""The command line: ``padstudio generate | print | detect | serve | …``.

A command's module is imported when the command is run, so that ``--help`` and completion are quick
and no command pays for another.
"""

from __future__ import annotations

import gc
import os
from importlib import import_module
from typing import Annotated, Any, Final

import typer
from typer.core import TyperCommand

from padstudio import __version__
from padstudio.cli.support import StudioGroup

#: Every command, each in a module of its name, and what the list of commands says of it.
COMMANDS = {
    "generate": "Generate a pad and write it as a pad file.",
    "verify": "Prove the properties of a pad: each layer's windows, and the layers' beside each "
    "other.",
    "print": "Print a pad: a PDF at true size on any paper, or another form by the file's suffix.",
    "measure": "Enter the size that a print came out at; poses then use it, without printing "
    "again.",
    "crosstalk": "Read a photo of the test strip; frames are then un-mixed by what printer and "
    "camera do.",
    "detect": "Find the pad in frames and write their poses, one JSON object a line.",
    "live": "Poses from a camera's stream as its frames come: always the newest frame.",
    "remote": "Have a server find the pad in frames, and write their poses as detect does.",
    "cameras": "List the nominal cameras that --camera takes in place of a file.",
    "camera": "Show what a camera file says, or write the camera in another form.",
    "readout": "Estimate how long a camera's shutter rolls, from a clip in which it shakes.",
    "calibrate": "Calibrate a camera: intrinsics and lens, from a dozen pictures of a pad or a "
    "short clip.",
    "compare": "Say which frames a second run won, lost and read otherwise.",
    "bundle": "Bundle a frame with all that its result rests on, in one zip.",
    "replay": "Read a bundle's frame again, and say what is otherwise.",
    "export": "Write a poses file in the form of another program.",
    "simulate": "Simulate flights over a pad: pictures as a real camera takes them, and the true "
    "poses.",
    "coverage": "Show the heights and tilts at which each layer of a pad, and the sign as a "
    "whole, reads.",
    "budget": "Say how much of a pose's error comes from what, and which change would help most.",
    "advise": "Advise cell size, ratio of the layers and pad size for a range of heights.",
    "shootout": "Compare a pad with other boards of its printed size on the same simulated flight.",
    "reproduce": "Make the paper's experiments again on the simulator, with both methods: which "
    "claims hold?",
    "serve": "Serve the studio's pages and its REST interface until Ctrl-C.",
    "worker": "Work on flights for a cluster's scheduler until it ends, or Ctrl-C.",
}
_FOLDERS = {
    command: folder
    for folder, commands in {
        "pads.": ("generate", "verify", "measure", "crosstalk"),
        "cameras.": ("cameras", "camera", "readout", "calibrate"),
        "bundles.": ("bundle", "replay"),
        "remote.": ("remote",),
        "live.": ("live",),
        "experiments.": ("budget", "shootout", "reproduce"),
    }.items()
    for command in commands
}
_MARKUP: Final = "rich"


class Commands(StudioGroup):
    """Lists all commands, and imports the one that is run."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        for name, line in COMMANDS.items():
            self.add_command(TyperCommand(name, help=line, rich_markup_mode=_MARKUP))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        name, command, rest = super().resolve_command(ctx, args)
        return name, command and load(args[0]), rest


def load(name: str) -> Any:
    """A command, ready to be run; what it imported is left out of later garbage collections."""
    alone = typer.Typer(
        rich_markup_mode=_MARKUP, add_completion=False, pretty_exceptions_enable=False
    )
    import_module(f"padstudio.cli.{_FOLDERS.get(name, '')}{name}").register(alone)
    if not gc.isenabled():
        gc.freeze()
        gc.enable()
    return typer.main.get_command(alone)


app = typer.Typer(
    name="padstudio",
    cls=Commands,
    help="Design, print and detect double-layer coded landing pads for drones.",
    epilog="Exit codes: 0 done, 1 done but nothing found, 2 wrong input, 3 search exhausted, "
    "70 a defect of the program.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=_MARKUP,
)


def main() -> None:
    """Entry point of the ``padstudio`` program."""
    # The matrices here are too small to share out: threads of linear algebra would only wait for
    # each other. NumPy reads this when it is first imported, in processes that this starts as well.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Looking for garbage among what is imported takes a sixth of a short command's time.
    gc.disable()
    try:
        app()
    finally:
        gc.freeze()


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"padstudio {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    pass
