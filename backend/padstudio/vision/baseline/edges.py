"""Stage `edges`, paper: Canny on the cleaned picture, then dilation."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array, Image
from padstudio.geometry.camera import Camera
from padstudio.vision.baseline import edges_kernel
from padstudio.vision.baseline.hough_kernel import BINS
from padstudio.vision.frame.block_mean import Binary
from padstudio.vision.frame.pyramid import Plane
from padstudio.vision.frame.regions import Region
from padstudio.vision.search.edges_kernel import steepness
from padstudio.vision.stage.params import PaperParams
from padstudio.vision.stage.trace import Reason, StageFailure

_LEAST_EDGES = 100
# The grey plane's steepest place is looked for this far from Canny's, pixels of the plane. Half and
# double read 16 of 19 stills of the footage instead of 17.
_SEARCH = 2

_Gradient = tuple[NDArray[np.float32], NDArray[np.float32]]


@dataclass(frozen=True, eq=False)
class EdgeMap:
    """Edges of a plane as a picture.

    Attributes
    ----------
    thin : (h, w) uint8
        Canny's edges, 0 or 255.
    mask : (h, w) uint8
        The same, dilated.
    points : (N, 2) float64
        Canny's edge pixels, moved to where the grey plane is steepest; plane pixels.
    xy : (P, 2) int32
        The pixels of the mask, row by row.
    normals : (P,) int32
        Which way the grey plane is steepest at each of them, over half a turn in
        `hough_kernel.BINS` steps; 0 is along a row.
    plane : Plane
        What they were found in.
    camera : Camera
        At the frame's size.
    """

    thin: Image
    mask: Image
    points: Array
    xy: NDArray[np.int32]
    normals: NDArray[np.int32]
    plane: Plane
    camera: Camera

    def straighten(self, xy: Array) -> Array:
        """Plane pixels (N, 2) as a lens without distortion would have them."""
        if not self.camera.distorted:
            return xy
        rays = self.camera.normalize(self.plane.to_frame(xy))
        return self.plane.from_frame(_ideal(self.camera).denormalize(rays))

    def bend(self, xy: Array) -> Array:
        """The plane pixels (N, 2) of straightened ones."""
        if not self.camera.distorted:
            return xy
        rays = _ideal(self.camera).normalize(self.plane.to_frame(xy))
        return self.plane.from_frame(self.camera.denormalize(rays))


def find_edge_map(
    binary: Binary, region: Region, camera: Camera, levels: int, params: PaperParams
) -> EdgeMap | StageFailure:
    """Canny edges on the pad's colour, dilated so that the Hough transform sees whole lines.

    Parameters
    ----------
    binary : Binary
    region : Region
        Edges off its mask are dropped: grass has more of them than the pad.
    camera : Camera
        At the frame's size.
    levels : int
        Y; with more than two levels black and white would lose lines, so the grey plane is taken.
    params : PaperParams

    References
    ----------
    Canny, J. (1986). A computational approach to edge detection. doi:10.1109/TPAMI.1986.4767851
    """
    picture = binary.mask if levels == 2 else _gray(binary.plane)
    thin = np.asarray(cv2.Canny(picture, params.canny_low, params.canny_high), np.uint8)
    xy = _held(thin, binary.plane, region)
    if len(xy) < _LEAST_EDGES:
        return StageFailure(
            "edges",
            Reason.NO_EDGES,
            f"only {len(xy)} edge pixels in {binary.plane.channel}, {_LEAST_EDGES} are needed",
        )
    mask = np.asarray(cv2.dilate(thin, np.ones((3, 3), np.uint8)), np.uint8)
    gx, gy = _gradient(binary.plane)
    # Thresholds and cleaning round the cells' corners and shift their sides; the grey plane knows
    # better. Along the gradient's main axis the steepest of five pixels is taken, and the parabola
    # through it and its neighbours.
    points = edges_kernel.steepest(xy, gx, gy, steepness(gx, gy), _SEARCH)
    near = edges_kernel.pixels(mask)
    normals = edges_kernel.directions(near, gx, gy, BINS)
    return EdgeMap(thin, mask, points, near, normals, binary.plane, camera)


def _held(thin: Image, plane: Plane, region: Region) -> NDArray[np.int32]:
    """The pixels (N, 2) of a plane's edges that a region holds; the others are taken off."""
    if region.mask is not None:
        scale = plane.pixel / (1 << region.level)
        edges_kernel.take_off(thin, region.mask, (plane.x0, plane.y0), scale)
    return edges_kernel.pixels(thin)


def _ideal(camera: Camera) -> Camera:
    return replace(camera, distortion=np.zeros(0), model="radtan")


def _gradient(plane: Plane) -> _Gradient:
    smooth = cv2.GaussianBlur(plane.values, (3, 3), 0)
    gx = np.asarray(cv2.Scharr(smooth, cv2.CV_32F, 1, 0), np.float32)
    return gx, np.asarray(cv2.Scharr(smooth, cv2.CV_32F, 0, 1), np.float32)


def _gray(plane: Plane) -> NDArray[np.uint8]:
    smooth = cv2.GaussianBlur(plane.values, (5, 5), 0)
    return np.clip(np.round(smooth), 0, 255).astype(np.uint8)
