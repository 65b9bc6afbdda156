"""Stage `edges`, dense: where a plane's brightness steps, to a part of a pixel."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import cross
from padstudio.vision.frame.pyramid import Plane
from padstudio.vision.stage.params import SearchParams

# A step counts where it is this much above the mean step of its neighbourhood, a square of so many
# pixels that holds some cells. 0.9 and 1.6, 15 and 61 find the same stills of the score.
_OVER_LOCAL = 1.2
_NEIGHBOURHOOD = 31


@dataclass(frozen=True, eq=False)
class EdgeSet:
    """Points on brightness steps.

    Attributes
    ----------
    xy : (N, 2) float64
        Frame pixels.
    rays : (N, 3) float64
        The same points on the plane z = 1 of the camera frame, undistorted.
    lines : (N, 3) float64
        Unit normal of the plane through the camera's centre and the edge's tangent.
    strength : (N,) float64
        Step in grey values a pixel of the plane.
    plane : Plane
        What they were found in.
    """

    xy: Array
    rays: Array
    lines: Array
    strength: Array
    plane: Plane

    def take(self, which: NDArray[np.bool_]) -> EdgeSet:
        """Some of the edges."""
        return EdgeSet(
            self.xy[which],
            self.rays[which],
            self.lines[which],
            self.strength[which],
            self.plane,
        )


def find_edges(plane: Plane, camera: Camera, params: SearchParams) -> EdgeSet:
    """Thin, sub-pixel edge points of a plane.

    Gradients by Scharr, kept where they are the largest along the gradient's main axis
    (non-maximum suppression) and stand out of their neighbourhood, so that dim parts keep their
    edges; position by the parabola through three gradient values.

    Parameters
    ----------
    plane : Plane
    camera : Camera
        Undistorts the points.
    params : SearchParams

    References
    ----------
    Canny, J. (1986). A computational approach to edge detection. doi:10.1109/TPAMI.1986.4767851.
    Devernay, F. (1995). A non-maxima suppression method for edge detection with sub-pixel accuracy.
    INRIA research report 2724.
    """
    smooth = cv2.GaussianBlur(plane.values, (3, 3), 0)
    gx = np.asarray(cv2.Scharr(smooth, cv2.CV_32F, 1, 0, scale=1 / 32), np.float32)
    gy = np.asarray(cv2.Scharr(smooth, cv2.CV_32F, 0, 1, scale=1 / 32), np.float32)
    size = np.asarray(cv2.magnitude(gx, gy), np.float32)
    floor = np.maximum(
        _OVER_LOCAL * cv2.blur(size, (_NEIGHBOURHOOD, _NEIGHBOURHOOD)), params.least_step
    )
    y, x, along_x = _peaks(gx, gy, size, floor)
    stride = max(1, -(-len(y) // params.most_edges))
    y, x, along_x = y[::stride], x[::stride], along_x[::stride]
    here = size[y, x]
    before = np.where(along_x, size[y, x - 1], size[y - 1, x])
    after = np.where(along_x, size[y, x + 1], size[y + 1, x])
    bend = np.minimum(before + after - 2 * here, -1e-6)
    shift = np.clip(0.5 * (before - after) / bend, -0.5, 0.5)
    local = np.stack([x + shift * along_x, y + shift * ~along_x], axis=1).astype(float)
    tangent = np.stack([-gy[y, x], gx[y, x]], axis=1).astype(float) / here[:, None]
    xy = plane.to_frame(local)
    rays, lines, seen = _tangent_planes(camera, xy, tangent * plane.pixel)
    edges = EdgeSet(xy, rays, lines, here.astype(float), plane)
    return edges if seen.all() else edges.take(seen)


def _peaks(
    gx: NDArray[np.float32],
    gy: NDArray[np.float32],
    size: NDArray[np.float32],
    floor: NDArray[np.float32],
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
    """Rows and columns of gradient maxima along the gradient's main axis, and which axis it is."""
    centre = size[1:-1, 1:-1]
    strong = centre > floor[1:-1, 1:-1]
    y, x = np.nonzero(strong)
    y, x = y + 1, x + 1
    along_x = np.abs(gx[y, x]) >= np.abs(gy[y, x])
    before = np.where(along_x, size[y, x - 1], size[y - 1, x])
    after = np.where(along_x, size[y, x + 1], size[y + 1, x])
    here = size[y, x]
    keep = (here >= before) & (here > after)
    return y[keep], x[keep], along_x[keep]


def _tangent_planes(
    camera: Camera, xy: Array, tangent: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Rays and interpretation planes of edges, and which edges the lens has a ray for."""
    ends = np.concatenate([xy - tangent, xy + tangent])
    rays = camera.normalize(ends)
    seen = camera.has_ray(ends, rays)
    both = seen[: len(xy)] & seen[len(xy) :]
    a, b = np.column_stack([rays, np.ones(len(rays))]).reshape(2, -1, 3)
    lines = cross(a, b)
    lines /= np.maximum(np.linalg.norm(lines, axis=1, keepdims=True), 1e-12)
    return (a + b) / 2, lines, both
