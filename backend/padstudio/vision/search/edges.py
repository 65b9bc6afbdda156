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
from padstudio.vision.search import edges_kernel
from padstudio.vision.stage.params import SearchParams

# A step counts where it is this much above the mean step of its neighbourhood, a square of so many
# pixels that holds some cells. 0.9 and 1.6, 15 and 61 find the same stills of the score.
_OVER_LOCAL = 1.2
_NEIGHBOURHOOD = 31
# Of noise a twentieth is so much above its mean (Rayleigh's law).
_OVER_NOISE = 2.0


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


@dataclass(frozen=True, eq=False)
class Steps:
    """Points on brightness steps as the picture alone shows them.

    Attributes
    ----------
    xy : (N, 2) float64
        Frame pixels.
    tangent : (N, 2) float64
        Along the steps, one pixel of the plane long, frame pixels.
    strength : (N,) float64
    plane : Plane
    """

    xy: Array
    tangent: Array
    strength: Array
    plane: Plane

    def take(self, which: NDArray[np.bool_] | slice) -> Steps:
        """Some of the steps."""
        return Steps(self.xy[which], self.tangent[which], self.strength[which], self.plane)

    def thinned(self, most: int) -> Steps:
        """At most so many, evenly spread."""
        return self.take(slice(None, None, max(1, -(-len(self.xy) // most))))

    def lifted(self, camera: Camera) -> EdgeSet:
        """The steps as the camera's rays see them; those without a ray are left out."""
        rays, lines, seen = _tangent_planes(camera, self.xy, self.tangent)
        edges = EdgeSet(self.xy, rays, lines, self.strength, self.plane)
        return edges if seen.all() else edges.take(seen)


def find_edges(plane: Plane, camera: Camera, params: SearchParams) -> EdgeSet:
    """`find_steps` as the camera's rays see them."""
    return find_steps(plane, params).lifted(camera)


def find_steps(plane: Plane, params: SearchParams, *, noisy: bool = False) -> Steps:
    """Thin, sub-pixel edge points of a plane.

    Gradients by Scharr, kept where they are the largest along the gradient's main axis
    (non-maximum suppression) and stand out of their neighbourhood, so that dim parts keep their
    edges; position by the parabola through three gradient values.

    Parameters
    ----------
    plane : Plane
    params : SearchParams
    noisy : bool
        Only steps that stand out of noise.

    References
    ----------
    Canny, J. (1986). A computational approach to edge detection. doi:10.1109/TPAMI.1986.4767851.
    Devernay, F. (1995). A non-maxima suppression method for edge detection with sub-pixel accuracy.
    INRIA research report 2724.
    """
    smooth = cv2.GaussianBlur(plane.values, (3, 3), 0)
    gx = np.asarray(cv2.Scharr(smooth, cv2.CV_32F, 1, 0, scale=1 / 32), np.float32)
    gy = np.asarray(cv2.Scharr(smooth, cv2.CV_32F, 0, 1, scale=1 / 32), np.float32)
    size = edges_kernel.steepness(gx, gy)
    local_mean = cv2.blur(size, (_NEIGHBOURHOOD, _NEIGHBOURHOOD))
    over = np.float32(_OVER_NOISE if noisy else _OVER_LOCAL)
    floor = np.maximum(over * local_mean, np.float32(params.least_step))
    found = edges_kernel.find_peaks(gx, gy, size, floor, params.most_edges)
    local, tangent, strength = found
    return Steps(plane.to_frame(local), tangent * plane.pixel, strength, plane)


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
