"""Stands in for the detector: its outcome is in the picture's name."""

from __future__ import annotations

import os
import time
from typing import Any

import cv2
import numpy as np

from padstudio.geometry.camera import Camera
from padstudio.media import images
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Pad
from padstudio.workers.detection import RESULT_PICTURE, Job, thumbnail_of


def analyze(job: Job) -> dict[str, Any]:
    image = images.decode(job.image, job.max_pixels)
    height, width = image.shape[:2]
    pads = [Pad.loads(pad) for pad in job.pads]
    camera = Camera.loads(job.camera).for_frame(width, height)
    if job.source == "crash.png":
        os._exit(9)
    if job.source == "slow.png":
        time.sleep(60)
    if job.source == "huge.png":
        np.ones(40_000_000_000, np.uint8)
    if job.source == "defect.png":
        raise ZeroDivisionError
    stages = None
    if job.pictures is not None:
        stages = [_stage("edges", "red", "red-edges.png"), _stage("choose", None, None)]
        for name in ("red-edges.png", RESULT_PICTURE):
            cv2.imwrite(str(job.pictures / name), image)
            cv2.imwrite(str(job.pictures / thumbnail_of(name)), image[::4, ::4])
    result = {
        "source": job.source,
        "frame": 0,
        "time_s": None,
        "status": "failed",
        "stage": "choose",
        "reason": "too_few_cells",
        "detail": "read 0 cells",
        "advice": "",
        "elapsed_ms": {"total": 1.0},
    }
    return {
        "results": [result],
        "pad_ids": [pad_id(pad) for pad in pads],
        "image": {"width": width, "height": height},
        "camera_scale": camera.scale,
        "stages": stages,
    }


def _stage(name: str, channel: str | None, picture: str | None) -> dict[str, Any]:
    return {
        "name": name,
        "channel": channel,
        "elapsed_ms": 0.5,
        "failure": None,
        "picture": picture,
    }
