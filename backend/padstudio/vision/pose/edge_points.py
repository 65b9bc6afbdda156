"""The borders between cells of unlike level: what the pose is measured on.

Model-based edge tracking: steps are looked for along the normals of the borders that a pose
predicts.

References
----------
Harris, C. and Stennett, C. (1990). RAPID, a video rate object tracker. British Machine Vision
Conference. Drummond, T. and Cipolla, R. (2002). Real-time visual tracking of complex structures.
doi:10.1109/TPAMI.2002.1017620.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose, row_times
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells.visible import visible_range
from padstudio.vision.frame.pyramid import Window
from padstudio.vision.pose import edge_points_kernel
from padstudio.vision.pose.edge_points_kernel import Borders, Patch
from padstudio.vision.pose.least_squares_kernel import Sightings

#: Fewer borders leave a pose undetermined: each tells one of six unknowns, and some are wrong.
LEAST_BORDERS = 12
# So many borders tell how wide cells are; their median needs no more.
_TELLING = 200


@dataclass(frozen=True, eq=False)
class Sway:
    """A shaking while the shutter rolled.

    Attributes
    ----------
    row_time : (K,) float64
        −0.5 … 0.5 of the frame, between which it goes straight.
    rotvec : (K, 3) float64
        Rotations about the camera's axes, radians, after those of the pose.
    """

    row_time: Array
    rotvec: Array

    def at(self, row_time: Array) -> Array:
        """Rotation vectors (N, 3) at some rows."""
        turns = [np.interp(row_time, self.row_time, axis) for axis in self.rotvec.T]
        return np.stack(turns, axis=1)

    def within(self, pose: MovingPose, first: float, last: float) -> MovingPose:
        """A pose with the shaking between two row times, from which to which it goes straight."""
        begin, end = self.at(np.array([first, last]))
        slope = (end - begin) / (last - first)
        turn = np.concatenate([np.zeros(3), begin - first * slope, np.zeros(3), slope])
        return pose.moved(turn)

    def seen_at(self, points_mm: Array, camera: Camera, pose: MovingPose) -> Array:
        """Points (N, 3) as high that without the shaking would be seen where some are with it."""
        turn = self.at(row_times(camera, pose.project(camera, points_mm)[:, 1]))
        away = points_mm - pose.pose.position_mm
        turned = away - np.cross(turn @ pose.pose.rotation.T, away)
        return np.asarray(pose.pose.position_mm + turned * (away[:, 2:] / turned[:, 2:]))


@dataclass(frozen=True, eq=False)
class EdgePoints:
    """Borders found in a picture.

    Attributes
    ----------
    borders : Borders
    xy : (N, 2) float64
        Where the steps lie, frame pixels.
    weight : (N,) float64
        Relative trust, 0 … 1.
    blur_px2 : (N,) float64
        By how much the variances of the steps' widths exceed those of a sharp picture, frame pixels
        squared.
    pixel : float
        Side of a pixel of the picture that they were found in, frame pixels.
    finder : EdgeFinder or None
        Finds all of the borders anew.
    """

    borders: Borders
    xy: Array
    weight: Array
    blur_px2: Array
    pixel: float = 1.0
    finder: EdgeFinder | None = None

    def seen_by(self, camera: Camera) -> Sightings:
        """As least squares take them."""
        borders, rays, weight = self.borders, camera.normalize(self.xy), self.weight
        if camera.distorted:
            # A pixel at a wide lens's rim is a long way on the plane z = 1, and errs by as much.
            weight = weight * camera.sharpness(self.xy, rays) ** 2
        row_time = row_times(camera, self.xy[:, 1])
        return Sightings(borders.points_mm, borders.along_mm, rays, row_time, weight)

    def thinned(self, most: int) -> EdgePoints:
        """At most ``most`` of them, evenly spread."""
        stride = -(-len(self.xy) // most)
        if stride <= 1:
            return self
        which = np.arange(0, len(self.xy), stride)
        borders, weight = self.borders.take(which), self.weight[which]
        xy, blur = self.xy[which], self.blur_px2[which]
        return replace(self, borders=borders, xy=xy, weight=weight, blur_px2=blur)


@dataclass(frozen=True, eq=False)
class EdgeFinder:
    """Finds borders in a picture, as of `find_edge_points`, about any pose.

    It holds the picture: what is found must not be held by it in turn, as frames would then stay in
    memory until the collector of cycles runs.
    """

    borders: Borders
    window: Window
    camera: Camera
    reach_px: float

    def find(self, pose: MovingPose, sway: Sway | None = None) -> EdgePoints:
        """Where a pose, and a shaking besides, put them."""
        points = self.borders.points_mm
        points = points if sway is None else sway.seen_at(points, self.camera, pose)
        at, projector = self.borders._replace(points_mm=points), pose.projector(self.camera)
        found = edge_points_kernel.find_borders(at, projector, self.window, self.reach_px)
        which, xy, weight, blur = found
        return EdgePoints(self.borders.take(which), xy, weight, blur, self.window.pixel, self)


def visible_borders(pad: Pad, layer: Layer, camera: Camera, pose: MovingPose, most: int) -> Borders:
    """Borders of unlike cells of a layer that lie in the frame, at most ``most``, evenly spread."""
    rows, cols = visible_range(pad, layer, camera, pose.pose)
    sides = (layer.cell_mm * pad.scale[0], layer.cell_mm * pad.scale[1])
    patch = Patch(layer.field, pad.levels, rows, cols, sides, pad.size_mm)
    still = MovingPose(pose.pose).projector(camera)
    return edge_points_kernel.borders_in_view(patch, still, most)


def measurable_borders(
    pad: Pad, layer: Layer, camera: Camera, pose: MovingPose, most: int, least_px: float
) -> tuple[Borders, float]:
    """Of `visible_borders` those of cells wide enough, and the median width of their cells.

    Under tilt the many cells far away must not pass for those that can be measured. Where hardly
    any are wide enough, all are given. Widths are frame pixels.
    """
    borders = visible_borders(pad, layer, camera, pose, most)
    if not len(borders.step):
        return borders, 0.0
    projector = pose.projector(camera)
    width_px, narrowest_px = edge_points_kernel.telling_width(borders, projector, _TELLING)
    if narrowest_px < least_px:
        every = edge_points_kernel.widths_px(borders, projector, 1)
        wide = np.flatnonzero(every >= least_px)
        if len(wide) >= LEAST_BORDERS:
            borders, width_px = borders.take(wide), float(np.median(every[wide]))
    return borders, width_px


def find_edge_points(
    borders: Borders, window: Window, camera: Camera, pose: MovingPose, reach_px: float
) -> EdgePoints:
    """Find each border's step near where a pose predicts it.

    Along the normal of each predicted border a short profile is taken, averaged over three lines
    side by side; the step lies at the centroid of the squared slope of the right sign. The profile
    is smoothed first, else a sharp step is drawn to the pixels' grid: by 0.1 px, and in cells of
    whole pixels all alike.

    A tone curve steepens the dark half of a blurred step, so that its middle seems to lie there:
    by a third of a pixel in a sharp picture, more where it is blurred, and then not alike for
    upright and level borders. Borders that rise and those that fall are off by opposite amounts,
    while a pose that is not yet right moves both alike; half the difference of their medians is
    taken off.

    Parameters
    ----------
    borders : Borders
    window : Window
    camera : Camera
    pose : MovingPose
    reach_px : float
        Half length of a profile, pixels of the window; never more than 0.42 of a cell.
    """

    return EdgeFinder(borders, window, camera, reach_px).find(pose)
