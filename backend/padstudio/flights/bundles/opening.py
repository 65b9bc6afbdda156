"""Opens a bundle for a page, in a worker: its frame as a file, its texts, and what is otherwise."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2

from padstudio.arrays import YuvFrame
from padstudio.errors import LimitError
from padstudio.flights.bundles.contents import Bundle, neighbour_name, png
from padstudio.flights.bundles.members import MAX_BYTES
from padstudio.flights.bundles.reading import unpack
from padstudio.flights.bundles.replay import replay
from padstudio.geometry.camera import Camera
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Pad
from padstudio.workers import pads
from padstudio.workers.detection import FRAME_FILE, save_picture


def open_bundle(path: Path, folder: Path, max_pixels: int) -> dict[str, Any]:
    """Read a bundle, read its frame again, and lay its pictures into a folder.

    Parameters
    ----------
    path : Path
        The zip.
    folder : Path
        Empty; takes the frame, as `padstudio.workers.detection` keeps it, and its neighbours.
    max_pixels : int
        Limit on each picture.

    Returns
    -------
    dict
        ``pads`` (`padstudio.workers.pads.Design`, each with its ``pad_id``), ``camera`` (a file's
        content), ``result`` (of the frame alone, as it is now), ``image``, ``camera_scale``, and
        ``bundle``: fields of `padstudio.web.schemas.bundles.BundleReport` but for ids.

    Raises
    ------
    StudioError
        As `padstudio.flights.bundles.reading.unpack`; or if the frame does not go with its camera.
    """
    if path.stat().st_size > MAX_BYTES:
        raise LimitError(f"the bundle is larger than {MAX_BYTES // 1_000_000} MB")
    bundle = unpack(path.read_bytes(), max_pixels)
    threads = cv2.getNumThreads()
    # A worker is one process for one core.
    cv2.setNumThreads(1)
    try:
        found = replay(bundle)
    finally:
        cv2.setNumThreads(threads)
    bgr = bundle.frame.bgr if isinstance(bundle.frame, YuvFrame) else bundle.frame
    (folder / FRAME_FILE).write_bytes(bundle.original or png(bgr))
    height, width = bgr.shape[:2]
    camera = Camera.loads(bundle.recipe.camera)
    texts = (bundle.recipe.pad, *bundle.recipe.others)
    return {
        "pads": [(pads.read(text.encode()), pad_id(Pad.loads(text))) for text in texts],
        "camera": camera.to_ros_yaml(),
        "result": found["alone"] or found["result"],
        "image": {"width": width, "height": height},
        "camera_scale": camera.for_frame(width, height).scale,
        "bundle": _told(bundle, found, folder),
    }


def _told(bundle: Bundle, found: dict[str, Any], folder: Path) -> dict[str, Any]:
    alone, shown = bundle.alone, bundle.alone or bundle.recipe
    return {
        "reading": bundle.reading,
        "method": shown.method,
        "params": json.loads(shown.params),
        "view": dict(bundle.view),
        "result": bundle.result,
        "recorded": bundle.recorded,
        "recorded_version": bundle.recorded_version,
        "alone": None if alone is None else alone.result,
        "neighbours": _neighbours(bundle, folder),
        "now": found,
    }


def _neighbours(bundle: Bundle, folder: Path) -> list[dict[str, Any]]:
    told = []
    for each in bundle.neighbours:
        name = None if each.picture is None else neighbour_name(each.offset)
        if name is not None and each.picture is not None:
            save_picture(folder, name, each.picture)
        told.append({"offset": each.offset, "result": each.result, "picture": name})
    return told
