"""What a page sees of a frame on the workbench: its pose, its stages, pictures and cells."""

from __future__ import annotations

import base64
import json
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.errors import ImageError, SpecError
from padstudio.flights.tasks.detectors import Recipe
from padstudio.flights.tuning.bench import Bench, Subject, bench_for, detector_of
from padstudio.geometry.pose import Pose, rotation_from_quaternion
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.cells.comparison import compare_cells, pose_of_corners
from padstudio.vision.frame.prepare import prepare
from padstudio.vision.overlays.rasters import Part, place_of, raster_of
from padstudio.vision.overlays.stage_marks import marks_of
from padstudio.vision.stage.detection import Detection, pose_fields
from padstudio.vision.stage.trace import Recorder, StageRecord, Trace

# Where a picture is shown smaller than it is, its grey values are means anyway.
_SMALL = (".webp", "image/webp", [cv2.IMWRITE_WEBP_QUALITY, 80])
_QUICK = (".jpg", "image/jpeg", [cv2.IMWRITE_JPEG_QUALITY, 80])
_EXACT = (".png", "image/png", [cv2.IMWRITE_PNG_COMPRESSION, 1])


_NOTHING = {"part": None, "exact": False, "media_type": None, "base64": None, "marks": None}


@dataclass(frozen=True)
class View:
    """A stage's picture as a page shows it.

    Attributes
    ----------
    stage : str
        A stage, or ``frame``.
    channel : {"red", "green", "blue"} or None
    scale : float
        Shown pixels per frame pixel.
    part : (left, top, right, bottom) or None
        The part of the frame that is shown; None is all of it.
    quick : bool
        It is looked at while a slider is dragged: sooner rather than exactly.
    marks : bool
        With the lines, cells and axes that belong on it.
    """

    stage: str
    channel: Channel | None
    scale: float
    part: Part | None = None
    quick: bool = False
    marks: bool = True


def look(subject: Subject, recipe: Recipe, views: Sequence[View], source: str) -> dict[str, Any]:
    """Read a frame and show some of its stages.

    Parameters
    ----------
    subject : Subject
    recipe : Recipe
    views : sequence of View
    source : str
        The frame's name, for the record.

    Returns
    -------
    dict
        Fields of `padstudio.web.schemas.tuning.Look`.

    Raises
    ------
    StudioError
        As `bench_for` and `Bench.detect`.
    """
    threads = cv2.getNumThreads()
    # A worker is one process for one core.
    cv2.setNumThreads(1)
    try:
        bench = bench_for(subject)
        detection = bench.detect(recipe, _channel(views))
        height, width = bench.image.shape[:2]
        return {
            "result": detection.to_record(source),
            "image": {"width": width, "height": height},
            "camera_scale": bench.camera(recipe).scale,
            "stages": _stages(detection),
            "pictures": [_picture(bench, recipe, detection, view) for view in views],
        }
    finally:
        cv2.setNumThreads(threads)


def look_json(subject: Subject, recipe: Recipe, views: Sequence[View], source: str) -> bytes:
    """As `look`, ready to be sent."""
    return json.dumps(look(subject, recipe, views, source)).encode()


def _channel(views: Sequence[View]) -> Channel | None:
    """The one channel that is looked at in haste."""
    channels = {view.channel for view in views}
    is_quick = bool(views) and all(view.quick for view in views)
    return channels.pop() if is_quick and len(channels) == 1 else None


def _stages(detection: Detection) -> list[dict[str, Any]]:
    trace = _trace(detection)
    # A stage that ran several times is shown as it ended, with the time of all its runs.
    last = {(record.name, record.channel): record for record in trace.records}
    took: dict[tuple[str, Channel | None], float] = defaultdict(float)
    for record in trace.records:
        took[record.name, record.channel] += record.elapsed_ms
    return [_stage(trace, record, took[key]) for key, record in last.items()]


def _stage(trace: Trace, record: StageRecord, elapsed_ms: float) -> dict[str, Any]:
    place = place_of(trace, record.name, record.channel)
    failure = record.failure
    return {
        "name": record.name,
        "channel": record.channel,
        "elapsed_ms": round(elapsed_ms, 3),
        "failure": None
        if failure is None
        else {
            "stage": failure.stage, "reason": str(failure.reason),
            "detail": failure.detail, "advice": failure.advice,
        },
        "part": None if place is None else place[0],
        "pixel": None if place is None else place[1],
    }  # fmt: skip


def _picture(bench: Bench, recipe: Recipe, detection: Detection, view: View) -> dict[str, Any]:
    trace = _trace(detection)
    shown = {"stage": view.stage, "channel": view.channel}
    raster = raster_of(trace, view.stage, view.channel)
    if raster is None:
        return shown | _NOTHING
    image, part = raster.cut(view.part, view.scale)
    is_exact = view.scale * raster.pixel >= 1
    kind = _QUICK if view.quick else _EXACT if is_exact else _SMALL
    marks = None
    if view.marks and view.stage != "frame":
        camera = bench.camera(recipe)
        marks = marks_of(trace, view.stage, view.channel, camera).to_dict()
    return shown | {
        "part": part,
        "exact": is_exact and not view.quick,
        "media_type": kind[1] if image.size else None,
        "base64": _encoded(image, kind) if image.size else None,
        "marks": marks,
    }


def _encoded(image: Image, kind: tuple[str, str, list[int]]) -> str:
    done, data = cv2.imencode(kind[0], image, kind[2])
    if not done:
        raise ImageError(f"a stage's picture could not be encoded as {kind[0]}")
    return base64.b64encode(data.tobytes()).decode()


def compare(
    subject: Subject,
    recipe: Recipe,
    pose: Mapping[str, Any] | None,
    corners: Sequence[tuple[float, float]] | None,
) -> dict[str, Any]:
    """What each cell should be, and what is read, where a pose puts the pad.

    Parameters
    ----------
    subject : Subject
    recipe : Recipe
    pose : mapping or None
        ``position_mm`` and ``quaternion_xyzw``; None takes the frame's own.
    corners : sequence of (x, y) or None
        The pad's four corners, frame pixels; they give the pose.

    Returns
    -------
    dict
        Fields of `padstudio.web.schemas.tuning.CellsAnswer`.

    Raises
    ------
    SpecError
        If there is no pose to read the cells with.
    """
    bench, detector = bench_for(subject), detector_of(recipe)
    camera, pad = bench.camera(recipe), _pad(bench, recipe)
    pyramid = prepare(bench.image, pad, detector.params.prepare, Recorder(keep=False))
    found: Pose | None
    if corners is not None:
        found = pose_of_corners(pyramid, camera, pad, np.array(corners, float))
    elif pose is not None:
        rotation = rotation_from_quaternion(pose["quaternion_xyzw"])
        found = Pose(np.array(pose["position_mm"], float), rotation)
    else:
        found = bench.detect(recipe).pose
    if found is None:
        raise SpecError(
            "no pose to read the cells with: the frame has none of its own"
            if corners is None
            else "no camera sees a pad's corners so; click its four corners one after the other",
            code="no_pose",
        )
    layers = [item.to_dict() for item in compare_cells(pyramid, camera, pad, found)]
    return {"pose": pose_fields(found), "levels": pad.levels, "layers": layers}


def _pad(bench: Bench, recipe: Recipe) -> Pad:
    """The pad that the frame shows; of several that may be the first one where none is found."""
    pads = detector_of(recipe).pads
    if len(pads) == 1:
        return pads[0]
    found = bench.detect(recipe).pad_id
    return next((pad for pad in pads if pad_id(pad) == found), pads[0])


def _trace(detection: Detection) -> Trace:
    assert detection.trace is not None
    return detection.trace
