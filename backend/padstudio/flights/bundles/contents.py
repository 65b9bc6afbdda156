"""What a bundle holds, and how it becomes a zip."""

from __future__ import annotations

import io
import json
import platform
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any, Literal

import cv2
import numpy as np

from padstudio import __version__
from padstudio.arrays import Image, YuvFrame
from padstudio.errors import ImageError
from padstudio.flights.bundles.around import Around
from padstudio.flights.tasks.detectors import Recipe
from padstudio.vision.dense.tracker import Expectation
from padstudio.vision.stage.detection import Method

Record = dict[str, Any]
Reading = Literal["still", "run"]
FORMAT, FORMAT_VERSION = "padstudio.bundle", 1
#: Names of what every bundle holds.
MANIFEST, PAD, CAMERA, TRACE = "bundle.json", "pad.json", "camera.yaml", "trace.json"
#: Of a run that fuses: the frames' own poses that its fused pose follows from.
AROUND = "around.json"
#: The picture as pixels; the bytes of the file that it was; a video's planes.
PIXELS, ORIGINAL, PLANES = (
    "frame.png",
    "frame.original",
    ("frame-y.png", "frame-u.png", "frame-v.png"),
)
MOST_OTHERS, MOST_NEIGHBOURS = 20, 2
# A bundle made twice of the same has the same bytes.
_DATE = (1980, 1, 1, 0, 0, 0)


@dataclass(frozen=True, eq=False)
class Neighbour:
    """A frame beside the bundle's, for people.

    Attributes
    ----------
    offset : int
        Before (−1) or behind (1).
    picture : (H, W, 3) uint8, BGR, or None
        None where its file has none.
    result : dict or None
        What the run recorded.
    """

    offset: int
    picture: Image | None
    result: Record | None = None


@dataclass(frozen=True)
class Alone:
    """What the frame alone gives, without what a run knew before it.

    Attributes
    ----------
    method : {"dense", "paper"}
    params : str
        As of a `Recipe`; the workbench's may differ from the run's.
    result : dict
    """

    method: Method
    params: str
    result: Record


@dataclass(frozen=True, eq=False)
class Bundle:
    """A frame with all that its result rests on.

    Attributes
    ----------
    recipe : Recipe
    frame : (H, W, 3) uint8, BGR, or YuvFrame
    original : bytes or None
        The file that the frame was, where it was one.
    reading : {"still", "run"}
        A frame by itself, with all reasons; or as a flight's run reads it.
    expected : Expectation or None
        What following knew before the frame; None where it knew nothing, or for a still.
    result : dict
        Line of a poses file: what reading it so gave when the bundle was made.
    recorded : dict or None
        What the flight's run recorded.
    recorded_version : str
        Of the program that the run was made with; empty where there was none.
    alone : Alone or None
        Of a run's frame.
    around : Around or None
        What the run's fused pose follows from, where it fused.
    trace : list of dict
        Its stages: name, channel, elapsed_ms, failure.
    view : mapping of str to str
        The page's address where it was shown.
    neighbours : tuple of Neighbour
    versions : mapping of str to str
    """

    recipe: Recipe
    frame: Image | YuvFrame
    original: bytes | None
    reading: Reading
    expected: Expectation | None
    result: Record
    recorded: Record | None = None
    recorded_version: str = ""
    alone: Alone | None = None
    around: Around | None = None
    trace: list[Record] = field(default_factory=list)
    view: Mapping[str, str] = field(default_factory=dict)
    neighbours: tuple[Neighbour, ...] = ()
    versions: Mapping[str, str] = field(default_factory=lambda: versions())


def versions() -> dict[str, str]:
    """What results depend on beside the bundle."""
    libraries = ("numpy", "numba", "opencv-python-headless")
    return {
        "padstudio": __version__,
        "python": platform.python_version(),
        "machine": platform.machine(),
        **{name: version(name) for name in libraries},
    }


def pack(bundle: Bundle) -> bytes:
    """A bundle as the bytes of a zip."""
    recipe, frame = bundle.recipe, bundle.frame
    members: dict[str, bytes] = {
        MANIFEST: _json(_manifest(bundle)),
        PAD: recipe.pad.encode(),
        CAMERA: recipe.camera.encode(),
        TRACE: _json({"stages": bundle.trace}),
    }
    members |= {other_pad(i): text.encode() for i, text in enumerate(recipe.others)}
    if bundle.original is not None:
        members[ORIGINAL] = bundle.original
    else:
        members[PIXELS] = png(frame.bgr if isinstance(frame, YuvFrame) else frame)
    if isinstance(frame, YuvFrame):
        # The picture alone: behind its rows lies whatever the decoder's memory held.
        half = -(-frame.width // 2)
        planes = (frame.y[:, : frame.width], frame.u[:, :half], frame.v[:, :half])
        members |= {name: png(plane) for name, plane in zip(PLANES, planes, strict=True)}
    members |= {
        neighbour_name(each.offset): png(each.picture)
        for each in bundle.neighbours
        if each.picture is not None
    }
    if bundle.around is not None:
        members[AROUND] = _json(bundle.around.to_dict(), indent=None)
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w") as archive:
        for name, data in members.items():
            is_text = name.endswith((".json", ".yaml"))
            entry = zipfile.ZipInfo(name, _DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED if is_text else zipfile.ZIP_STORED
            archive.writestr(entry, data)
    return written.getvalue()


def other_pad(place: int) -> str:
    """The member's name of one more pad."""
    return f"pad-{place + 1}.json"


def neighbour_name(offset: int) -> str:
    """The member's name of a neighbour's picture."""
    return f"neighbour-{'before' if offset < 0 else 'after'}.png"


def _manifest(bundle: Bundle) -> Record:
    frame, recipe = bundle.frame, bundle.recipe
    planes = None
    if isinstance(frame, YuvFrame):
        planes = {"standard": frame.standard, "full_range": frame.full_range}
    return {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "versions": dict(bundle.versions),
        "reading": bundle.reading,
        "method": recipe.method,
        "params": json.loads(recipe.params),
        "planes": planes,
        "expected": None if bundle.expected is None else bundle.expected.to_dict(),
        "result": bundle.result,
        "recorded": bundle.recorded,
        "recorded_version": bundle.recorded_version,
        "alone": None
        if (alone := bundle.alone) is None
        else {
            "method": alone.method, "params": json.loads(alone.params), "result": alone.result,
        },
        "view": dict(bundle.view),
        "neighbours": [
            {
                "offset": each.offset, "result": each.result, "picture": each.picture is not None,
            }
            for each in bundle.neighbours
        ],
    }  # fmt: skip


def _json(value: Record, indent: int | None = 1) -> bytes:
    return json.dumps(value, indent=indent, ensure_ascii=False).encode()


def png(image: Image) -> bytes:
    """A picture or a plane, without loss."""
    done, data = cv2.imencode(".png", np.ascontiguousarray(image), [cv2.IMWRITE_PNG_COMPRESSION, 3])
    if not done:
        raise ImageError("the frame could not be encoded as PNG")
    return data.tobytes()
