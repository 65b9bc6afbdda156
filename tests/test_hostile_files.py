"""Files that nobody should make give errors of the program, in Python and on the command line."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from command_line import run
from hostile import FILES, TOKENS
from web_server import PRESET

from padstudio import Camera, Pad
from padstudio.errors import StudioError
from padstudio.flights.exports.from_file import PosesFile, export_file
from padstudio.flights.exports.options import ExportChoices
from padstudio.flights.results import poses_file
from padstudio.geometry import presets
from padstudio.media.telemetry import reading as telemetry
from padstudio.pad.coverage.spans import METHOD_LIMITS, coverage
from padstudio.simulate.success_map import view_of

_POSE: dict[str, Any] = {
    "source": "a.png",
    "frame": 0,
    "time_s": 0.0,
    "status": "ok",
    "position_mm": [1.0, 2.0, 300.0],
    "rotation": [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
    "quaternion_xyzw": [1.0, 0.0, 0.0, 0.0],
    "quality": "full",
    "elapsed_ms": {"total": 1.0},
}
READERS: dict[str, Callable[[Path], object]] = {
    "pad": Pad.load,
    "camera": Camera.load,
    "telemetry": lambda path: telemetry.read(str(path)),
    "poses": lambda path: list(poses_file.read_poses(path)),
}
_KINDS = sorted({name.split("-")[0] for name in FILES if "-" in name} | {"other"})


def _of_kind(kind: str) -> dict[str, bytes]:
    known = [each for each in _KINDS if each != "other"]
    return {
        name: content
        for name, content in FILES.items()
        if (name.split("-")[0] if name.split("-")[0] in known else "other") == kind
    }


@pytest.mark.parametrize("kind", _KINDS)
@pytest.mark.parametrize("reader", READERS)
def test_readers_give_errors_of_the_program(tmp_path: Path, reader: str, kind: str) -> None:
    for name, content in _of_kind(kind).items():
        path = tmp_path / name
        path.write_bytes(content)
        try:
            READERS[reader](path)
        except StudioError:
            pass
        except Exception as error:
            raise AssertionError(f"{name}: {error!r}") from error


@pytest.mark.parametrize("key", _POSE)
def test_poses_with_odd_values(tmp_path: Path, key: str) -> None:
    path = tmp_path / "poses.jsonl"
    for token in TOKENS:
        for value in ("TOKEN", ["TOKEN"] * len(_POSE[key]) if isinstance(_POSE[key], list) else {}):
            text = json.dumps({**_POSE, key: value}).replace('"TOKEN"', token)
            path.write_text(text + "\n")
            for form in ("csv", "tum"):
                with contextlib.suppress(StudioError):
                    b"".join(export_file(PosesFile(path=path), ExportChoices(form=form)).blocks)


def test_pads_that_are_read_have_a_coverage() -> None:
    view, limits = view_of(presets.PRESETS[PRESET].camera), METHOD_LIMITS["dense"]
    for content in FILES.values():
        with contextlib.suppress(StudioError):
            coverage(Pad.loads(content), view, limits, (0.0, 89.0))


def test_cameras_that_are_read_see_a_pad() -> None:
    pad = Pad.loads(FILES["pad-name-18.json"])
    for name, content in FILES.items():
        with contextlib.suppress(StudioError):
            camera = Camera.loads(content, name)
            coverage(pad, view_of(camera), METHOD_LIMITS["paper"], (0.0,))


@pytest.mark.parametrize("kind", ["pad", "camera"])
def test_the_command_line_says_what_is_wrong(tmp_path: Path, kind: str) -> None:
    known = {"pad": tmp_path / "good.json", "camera": PRESET}
    Pad.loads(FILES["pad-name-18.json"]).save(known["pad"])
    for name, content in list(_of_kind(kind).items())[::25]:
        path = tmp_path / name
        path.write_bytes(content)
        given = known | {kind: path}
        result = run("coverage", "--pad", given["pad"], "--camera", given["camera"])
        assert result.exit_code in (0, 2), (name, result.exception)
        assert "Traceback" not in result.stderr
