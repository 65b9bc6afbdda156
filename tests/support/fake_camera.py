"""A browser whose camera shows simulated frames, over and over."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import cv2
import numpy as np
from places import FOOTAGE

from padstudio.arrays import Image
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.spec import Pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render

SIZE = (1280, 720)
#: Where the camera is while it sees the pad.
POSE = look_at_pad(
    1100.0, tilt_deg=14, heading_deg=25, tilt_towards_deg=70, target_mm=(40.0, -30.0)
)
_MOST_QUALITY = [cv2.IMWRITE_JPEG_QUALITY, 97]


@cache
def pad() -> Pad:
    """The footage's pad."""
    return Pad.load(FOOTAGE / "pad_a.json")


@cache
def camera() -> Camera:
    """A webcam, about 70 degrees wide."""
    width, height = SIZE
    matrix = np.array([[914.0, 0, (width - 1) / 2], [0, 914.0, (height - 1) / 2], [0, 0, 1]])
    return Camera(width, height, matrix, np.zeros(4), name="test webcam")


def view(pose: Pose = POSE, seed: int = 0) -> Image:
    """What the camera sees."""
    return render(Scene(pad=pad()), camera(), pose, seed=seed).image


def nothing() -> Image:
    """A grey table."""
    width, height = SIZE
    return np.random.default_rng(3).integers(118, 130, (height, width, 3)).astype(np.uint8)


def write_mjpeg(path: Path, frames: Sequence[Image]) -> Path:
    """A file for `--use-file-for-fake-video-capture`: JPEG files end to end."""
    encoded = (cv2.imencode(".jpg", frame, _MOST_QUALITY)[1].tobytes() for frame in frames)
    path.write_bytes(b"".join(encoded))
    return path


def flags_for(video: Path) -> list[str]:
    """Flags of a Chromium whose camera plays a video; it asks nobody whether that is allowed."""
    return [
        "--use-fake-device-for-media-stream",
        f"--use-file-for-fake-video-capture={video}",
        "--use-fake-ui-for-media-stream",
    ]
