"""What is fuzzed: readers of files from outside, each with files to begin with.

A reader may refuse a file by a `StudioError`. Anything else that it raises is a finding, and so is
a file that it takes and cannot write or use afterwards.
"""

from __future__ import annotations

import contextlib
import io
import json
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import camera_forms
import cv2
import export_records
import hostile
import numpy as np
import vehicle_logs
from PIL import Image as PillowImage
from places import ROOT

from padstudio import Camera, Pad
from padstudio.errors import StudioError
from padstudio.flights.exports.from_file import PosesFile, export_file
from padstudio.flights.exports.options import ExportChoices
from padstudio.flights.results import poses_file
from padstudio.media import content, images
from padstudio.media.telemetry import reading as telemetry
from padstudio.media.telemetry.columns import height_at
from padstudio.pad.layout import layout

_MOST_PIXELS = 100_000
# Sentences with some of what was given; those on cameras list what may be.
_MOST_MESSAGE = 700
CORPUS = Path(__file__).with_name("corpus")


@dataclass(frozen=True)
class Target:
    """A reader: what is done with a file's content, and files that it takes or refuses."""

    read: Callable[[bytes], object]
    seeds: Callable[[], list[bytes]]


def outcome(target: Target, data: bytes) -> str:
    """``taken``, or the code of the refusal; raises what is a finding."""
    try:
        target.read(data)
    except StudioError as error:
        message = error.message
        # What cannot be sent in an answer is as bad as a traceback.
        message.encode()
        assert len(message) <= _MOST_MESSAGE, "a message that repeats too much of the file"
        return error.error_code
    return "taken"


def kept(name: str) -> Iterator[tuple[str, bytes]]:
    """The small files that are kept for a target, with their names."""
    for path in sorted((CORPUS / name).glob("*")):
        yield path.name, path.read_bytes()


def _pad(data: bytes) -> None:
    pad = Pad.loads(data)
    again = Pad.loads(pad.dumps())
    assert again.dumps() == pad.dumps(), "a pad is another one after it was written and read"
    if sum(layer.field.size for layer in pad.layers) < 2_000:
        layout(pad)


def _camera(data: bytes) -> None:
    camera = Camera.loads(data, "camera.yaml")
    with tempfile.NamedTemporaryFile(suffix=".yaml") as file:
        camera.save(file.name)
        again = Camera.load(file.name)
    assert np.array_equal(again.matrix, camera.matrix), "a camera is another one once written"
    # Coefficients that a form must name are written as 0.
    longer = sorted((again.distortion, camera.distortion), key=len)
    same = np.pad(longer[0], (0, len(longer[1]) - len(longer[0])))
    assert np.array_equal(same, longer[1]), "a lens is another one once written"
    camera.for_frame(camera.width, camera.height)


def _telemetry(data: bytes) -> None:
    columns = telemetry.parse(data)
    if "height_m" in columns:
        height_at(columns, [0.0, 1.0, 1e9])


def _poses(data: bytes) -> None:
    with tempfile.NamedTemporaryFile(suffix=".jsonl") as file:
        path = Path(file.name)
        path.write_bytes(data)
        for _ in poses_file.read_poses(path):
            pass
        for form in ("csv", "tum", "mcap"):
            with contextlib.suppress(StudioError):
                b"".join(export_file(PosesFile(path=path), ExportChoices(form=form)).blocks)


def _image(data: bytes) -> None:
    with contextlib.suppress(StudioError):
        content.identify(data[: content.HEAD_BYTES])
    images.read_header(data, _MOST_PIXELS)
    images.decode(data, _MOST_PIXELS)


def _hostile(*kinds: str) -> list[bytes]:
    return [data for name, data in hostile.FILES.items() if name.startswith(kinds)][::7]


def _pads() -> list[bytes]:
    small = Pad.load(ROOT / "samples" / "pad.json").to_dict()
    for layer in small["layers"]:
        layer["codes"] = [row[:9] for row in layer["codes"][:9]]
    return [json.dumps(small).encode(), *_hostile("pad")]


def _cameras() -> list[bytes]:
    wide = camera_forms.TrueCamera(640, 480, 500.0, 501.0, 320, 240, (0.1, -0.05, 0.0, 0.0), False)
    fisheye = wide._replace(fisheye=True)
    found = [_hostile("camera", "bomb", "cut.xml", "entities"), []]
    for true in (wide, fisheye):
        for write, _ in camera_forms.MAPPINGS.values():
            values = write(true)
            found[1] += [camera_forms.as_yaml(values), camera_forms.as_json(values)]
        for write, _ in camera_forms.TEXTS.values():
            if not (true.fisheye and write is camera_forms.mrcal):
                found[1].append(write(true))
    texts = [text.encode() if isinstance(text, str) else text for text in found[1]]
    return texts + found[0]


def _telemetries() -> list[bytes]:
    flown = vehicle_logs.wandering(seconds=0.4, hertz=10)
    logs = [
        vehicle_logs.ulog(flown),
        vehicle_logs.dataflash(flown),
        vehicle_logs.tlog(flown),
        vehicle_logs.table(flown),
    ]
    texts = (
        "1\n00:00:00,000 --> 00:00:01,000\n[latitude: 47.1] [longitude: 8.2] "
        "[rel_alt: 1.5 abs_alt: 400]\n\n",
        "1\n00:00:00,000 --> 00:00:01,000\nGPS(8.2, 47.1, 12) BAROMETER:1.5M\nH 3.2m\n\n",
    )
    return [*logs, *(text.encode() for text in texts), *_hostile("odd", "cut", "wide", "empty")]


def _poses_files() -> list[bytes]:
    lines = [json.dumps(record).encode() for record in export_records.records(bearing_at=(1,))]
    return [b"\n".join(lines[:3]) + b"\n", lines[0], *_hostile("digits", "deep", "surrogate")]


def _images() -> list[bytes]:
    pixels = np.arange(7 * 5 * 3, dtype=np.uint8).reshape(7, 5, 3)
    found = [
        cv2.imencode(ending, pixels)[1].tobytes()
        for ending in (".png", ".jpg", ".bmp", ".webp", ".tiff")
    ]
    for form in ("GIF", "PPM", "ICO"):
        file = io.BytesIO()
        PillowImage.fromarray(pixels).save(file, form)
        found.append(file.getvalue())
    return [*found, *_hostile("cut", "noise")]


TARGETS = {
    "pad": Target(_pad, _pads),
    "camera": Target(_camera, _cameras),
    "telemetry": Target(_telemetry, _telemetries),
    "poses": Target(_poses, _poses_files),
    "image": Target(_image, _images),
}
