"""Where a pad lies in a frame by its pose: lines for who draws them over the frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any, Literal

import numpy as np

from padstudio.arrays import Array
from padstudio.flights.tasks.detectors import Recipe
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, rotation_from_quaternion
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Pad

Role = Literal["side", "x", "y", "z"]
# As lenses bend the sides.
_POINTS_A_LINE = 24
# Lines that leave the picture are followed so far, in its own widths.
_ROOM = 2.0


def strokes(
    camera: Camera, pad_size_mm: tuple[float, float], record: Mapping[str, Any]
) -> Iterator[tuple[Role, Array]]:
    """The pad's sides, and its axes from its centre, as pixels of the frame.

    Where only range and bearing are known, the axes are left out, as they would show an attitude.

    Parameters
    ----------
    camera : Camera
        Of the whole frame.
    pad_size_mm : (width, height)
    record : mapping
        Holds ``position_mm`` and ``quaternion_xyzw``.

    Yields
    ------
    role : {"side", "x", "y", "z"}
    pixels : (n, 2) float64
        NaN behind the camera.
    """
    right, top = pad_size_mm[0] / 2, pad_size_mm[1] / 2
    corners = np.array([[-right, top, 0], [right, top, 0], [right, -top, 0], [-right, -top, 0]])
    rotation = rotation_from_quaternion(record["quaternion_xyzw"])
    pose = Pose(np.asarray(record["position_mm"], float), rotation)
    steps = np.linspace(0, 1, _POINTS_A_LINE)[:, None]

    def line(start: Array, end: Array) -> Array:
        return camera.project(pose.to_camera(start + steps * (end - start)))

    for corner in range(4):
        yield "side", line(corners[corner], corners[(corner + 1) % 4])
    if record.get("quality") == "bearing":
        return
    roles: tuple[Role, ...] = ("x", "y", "z")
    for role, axis in zip(roles, np.eye(3), strict=True):
        yield role, line(np.zeros(3), min(pad_size_mm) / 5 * axis)


def pad_size_of(recipe: Recipe, record: Mapping[str, Any]) -> tuple[float, float]:
    """The size of the pad that a record names, (width, height) in mm; else of the first one."""
    pads = [_known(text) for text in (recipe.pad, *recipe.others)]
    return next((size for name, size in pads if name == record.get("pad_id")), pads[0][1])


@lru_cache(maxsize=16)
def _known(text: str) -> tuple[str, tuple[float, float]]:
    pad = Pad.loads(text)
    return pad_id(pad), pad.size_mm


@lru_cache(maxsize=8)
def _camera(text: str) -> Camera:
    return Camera.loads(text)


def outline_of(recipe: Recipe, record: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The lines of a frame, JSON-serialisable; none where it has no pose.

    Returns
    -------
    list of dict
        ``role``: ``side``, ``x``, ``y`` or ``z``; ``points``: [x, y] in shares of the frame's width
        and height, (0, 0) its upper left corner. A line seen in parts stands there in parts.
    """
    if record["status"] != "ok":
        return []
    camera = _camera(recipe.camera)
    size = np.array([camera.width, camera.height], float)
    lines = []
    for role, pixels in strokes(camera, pad_size_of(recipe, record), record):
        shares = (pixels + 0.5) / size
        near = (np.abs(np.nan_to_num(shares, nan=np.inf) - 0.5) < _ROOM + 0.5).all(axis=1)
        # Runs of neighbours that are near.
        edges = np.flatnonzero(np.diff(near.astype(int), prepend=0, append=0))
        for start, end in zip(edges[::2], edges[1::2], strict=True):
            if end - start > 1:
                lines.append({"role": role, "points": shares[start:end].round(5).tolist()})
    return lines
