"""Simulates frames in a worker process."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any

import cv2
import numpy as np

from padstudio.errors import LimitError, SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.spec import Pad
from padstudio.simulate import looks
from padstudio.simulate.disturbances import vibrations_of
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import Frame, render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.success_map import MapGrid, success_map
from padstudio.vision.stage.detection import pose_fields

# A rotation that came through JSON is rounded.
_ORTHOGONAL_WITHIN = 1e-3


def simulate_frame(
    spec: Mapping[str, Any], pad: str | None, camera: str, max_pixels: int
) -> dict[str, Any]:
    """Take one picture.

    Parameters
    ----------
    spec : mapping
        Fields of `padstudio.web.schemas.planning.FrameSpec`.
    pad, camera : str
        The content of a pad file, None for bare ground, and of a camera file.
    max_pixels : int
        Limit on the picture.

    Returns
    -------
    dict
        Fields of `padstudio.web.schemas.planning.SimulatedFrame`.

    Raises
    ------
    SpecError, LimitError
        As `padstudio.simulate.render.render`; or if the camera has more pixels.
    """
    the_camera = Camera.loads(camera)
    check_pixels(the_camera, max_pixels)
    scene, imaging = dressed_scene(spec, pad)
    motion = Motion(
        velocity_mm_s=spec["velocity_mm_s"],
        angular_deg_s=spec["angular_deg_s"],
        vibrations=vibrations_of(spec["disturbances"], seed=spec["seed"]),
    )
    frame = render(scene, the_camera, _pose(spec), imaging, spec["seed"], motion=motion)
    return {
        "picture": _picture(frame),
        "width": the_camera.width,
        "height": the_camera.height,
        "truth": pose_fields(frame.truth.pose),
    }


def simulate_map(spec: Mapping[str, Any], pad: str, camera: str, max_pixels: int) -> dict[str, Any]:
    """Share of frames that are read over a grid of conditions.

    Parameters
    ----------
    spec : mapping
        Fields of `padstudio.web.schemas.planning.MapRequest`.
    pad, camera : str
        The content of a pad file and of a camera file.
    max_pixels : int
        Limit on a picture.

    Returns
    -------
    dict
        Fields of `padstudio.web.schemas.planning.SuccessMapInfo`.

    Raises
    ------
    SpecError, LimitError
        As `padstudio.simulate.success_map.success_map`; or if the camera has more pixels.
    """
    from padstudio.vision.detector import Detector

    the_pad, the_camera = Pad.loads(pad), Camera.loads(camera)
    check_pixels(the_camera, max_pixels)
    detector = Detector(the_pad, the_camera, method=spec["method"])
    return success_map(
        Scene(pad=the_pad),
        the_camera,
        lambda bgr: detector.detect(bgr).pose,
        MapGrid(spec["heights_mm"], spec["axis"], spec["values"], spec["trials"], spec["seed"]),
    ).as_dict()


def dressed_scene(spec: Mapping[str, Any], pad: str | None) -> tuple[Scene, Imaging]:
    """The ground, the pad on it and the conditions that a request asks for.

    Parameters
    ----------
    spec : mapping
        Has ``quiet_mm``, ``ground``, ``look``, ``disturbances`` and ``seed``.
    pad : str or None
        The content of a pad file, None for bare ground.
    """
    scene = Scene(
        pad=Pad.loads(pad) if pad is not None else None,
        quiet_mm=spec["quiet_mm"],
        ground=spec["ground"],
        ground_seed=spec["seed"],
    )
    words = spec["disturbances"]
    return looks.dress(scene, spec["look"], seed=spec["seed"], words=words)


def check_pixels(camera: Camera, max_pixels: int) -> None:
    """Raise `LimitError` where a camera's picture is too large to simulate here."""
    if camera.width * camera.height > max_pixels:
        raise LimitError(
            f"the camera's picture is {camera.width} x {camera.height}; this server simulates at "
            f"most {max_pixels / 1e6:g} megapixels: take a smaller mode of the camera",
            code="too_many_pixels",
        )


def _pose(spec: Mapping[str, Any]) -> Pose:
    given = spec["pose"]
    if given is None:
        return look_at_pad(
            spec["height_mm"],
            tilt_deg=spec["tilt_deg"],
            heading_deg=spec["heading_deg"],
            tilt_towards_deg=spec["tilt_towards_deg"],
            target_mm=spec["target_mm"],
        )
    rotation = np.array(given["rotation"], float)
    off = np.abs(rotation @ rotation.T - np.eye(3)).max()
    if not (off <= _ORTHOGONAL_WITHIN and np.linalg.det(rotation) > 0):
        raise SpecError(
            "pose.rotation is no rotation: its rows must be at right angles, of length 1, and "
            "right-handed"
        )
    left, _, right = np.linalg.svd(rotation)
    return Pose(np.array(given["position_mm"], float), left @ right)


def _picture(frame: Frame) -> dict[str, str]:
    encoded, media_type = frame.encoded, "image/jpeg"
    if encoded is None:
        encoded, media_type = cv2.imencode(".png", frame.image)[1].tobytes(), "image/png"
    return {"media_type": media_type, "base64": base64.b64encode(encoded).decode()}
