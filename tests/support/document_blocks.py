"""What documents show, run as their readers would."""

from __future__ import annotations

import contextlib
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from places import ROOT

_PROGRAM = Path(sys.executable).with_name("padstudio")
_PATH = f"{_PROGRAM.parent}:/usr/local/bin:/usr/bin:/bin:/opt/homebrew/bin"
# As the documents write it.
_ADDRESS = "http://127.0.0.1:8000"


def block(document: str, language: str, word: str) -> str:
    """The one fenced block of a document in a language that has a word."""
    text = (ROOT / document).read_text(encoding="utf-8")
    blocks = re.findall(r"```(\w+)\n(.*?)```", text, re.DOTALL)
    (found,) = (text for name, text in blocks if name == language and word in text)
    return str(found)


def run_shell(text: str, folder: Path, address: str = _ADDRESS) -> str:
    """What a block of the shell prints, in a folder, against a server."""
    return _output(["sh", "-eu", "-c", text.replace(_ADDRESS, address)], folder, {"PATH": _PATH})


def run_python(text: str, folder: Path, address: str = _ADDRESS) -> str:
    """What a block of Python prints, in a folder, against a server."""
    return _output([sys.executable, "-c", text.replace(_ADDRESS, address)], folder)


@contextlib.contextmanager
def serving(data: Path) -> Iterator[str]:
    """The address of a server with a data folder."""
    command = [_PROGRAM, "serve", "--port", "0", "--data", data]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr is not None
        try:
            yield server.stderr.readline().split()[2]
        finally:
            server.terminate()
            server.stderr.read()


def _output(command: list[str], folder: Path, environment: dict[str, str] | None = None) -> str:
    done = subprocess.run(
        command, cwd=folder, env=environment, check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
