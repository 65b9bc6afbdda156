"""Stage `outline`: the pose from the four corners of the whole sign.

From afar the windows are small but the sign is whole. Its four sides are fitted to where the
pad's colour ends, to a part of a pixel and without the lens's distortion; their crossings are the
corners. Which corner is which, and whether it is this pad at all, the cells tell: each of the four
quarter turns gives a pose, and the cells are read with it.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.planar_pnp import planar_pose
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose, cross
from padstudio.pad.layout import outline_mm
from padstudio.pad.spec import Pad
from padstudio.vision.cells.layer_read import LayerRead, read_layer
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import Region, unused_channels
from padstudio.vision.outline.corner_pose import (
    corner_covariance,
    corner_residuals,
)
from padstudio.vision.outline.sides import Side, SideView, fit_side
from padstudio.vision.stage.params import OutlineParams
from padstudio.vision.stage.trace import Reason, StageFailure

# The four sides must enclose the region: this share of its area at the least and at the most.
_AREA_SHARE = (0.75, 1.2)
# Corners this far beyond the frame may be where sides still meet; sides must lie within it.
_BORDER_PX = 2.0
# The mask's rough sides are known to so many pixels of its level, finer levels need fewer. A
# first reach of 12 loses one of 76 stills of the footage.
_FIRST_REACH, _NEXT_REACH = 6.0, 4.0


@dataclass(frozen=True, eq=False)
class Outline:
    """The four sides of a quadrilateral of pad colour.

    Attributes
    ----------
    corners_xy : (4, 2) float64
        Frame pixels, clockwise in the picture.
    corners_rays : (4, 2) float64
        The same on the plane z = 1, undistorted.
    sides : tuple of Side
        From each corner to the next.
    region : Region
        Where it was looked for.
    """

    corners_xy: Array
    corners_rays: Array
    sides: tuple[Side, ...]
    region: Region

    @property
    def sigma_px(self) -> float:
        """Standard deviation of a corner, from the scatter of the sides, frame pixels."""
        return float(np.sqrt(np.mean([side.sigma_px**2 for side in self.sides])))


@dataclass(frozen=True, eq=False)
class OutlinePose:
    """A pose from the four corners of the sign.

    Attributes
    ----------
    pose : Pose
    outline : Outline
    read : LayerRead
        The layer whose cells tell the quarter turn best.
    camera : Camera
        At the frame's size.
    points_mm : (4, 3) float64
        The pad's corners in the outline's order.
    rms_px : float
        Of the four corners, frame pixels.
    covariance : (6, 6) float64
        As of `padstudio.vision.stage.detection.Uncertainty`.
    """

    pose: Pose
    outline: Outline
    read: LayerRead
    camera: Camera
    points_mm: Array
    rms_px: float
    covariance: Array


def find_outline(
    pyramid: Pyramid,
    camera: Camera,
    pad: Pad,
    region: Region,
    params: OutlineParams,
    finest: int = 0,
) -> Outline | StageFailure:
    """Fit four straight sides to a region of pad colour.

    Parameters
    ----------
    pyramid : Pyramid
    camera : Camera
        At the frame's size.
    pad : Pad
    region : Region
        As of `padstudio.vision.frame.regions.find_regions`.
    params : OutlineParams
    finest : int
        The pyramid's level that suffices.

    Returns
    -------
    Outline or StageFailure
        A failure where the region is no quadrilateral that lies within the frame.
    """
    if region.mask is None:
        return _failure("no part of the frame stands out by the pad's colour")
    rough = _rough_corners(region)
    if rough is None:
        return _failure("the pad's colour does not end in four straight sides")
    h, w = pyramid.height, pyramid.width
    limit = 1.5 * (1 << region.level)
    if (rough < limit).any() or (rough > np.array([w, h]) - 1 - limit).any():
        return _failure("the pad reaches beyond the frame")
    corners = rough
    sides: list[Side] = []
    for level in range(region.level, min(finest, region.level) - 1, -1):
        reach = (_FIRST_REACH if level == region.level else _NEXT_REACH) * (1 << level)
        is_last = level == min(finest, region.level)
        view = SideView(pyramid, camera, level, unused_channels(pad), params.most_profiles, is_last)
        fitted = [fit_side(view, corners[[k, (k + 1) % 4]], reach) for k in range(4)]
        sides = [side for side in fitted if side is not None]
        if len(sides) < 4:
            return _failure("a side of the pad shows no clear step to what is round it")
        rays = np.array([_cross(sides[k - 1].line, sides[k].line) for k in range(4)])
        corners = camera.denormalize(rays)
        if not np.isfinite(corners).all():
            return _failure("two sides of the pad do not meet")
    return _checked(Outline(corners, rays, tuple(sides), region), pyramid, params.least_side_px)


def outline_pose(
    outline: Outline, pyramid: Pyramid, camera: Camera, pad: Pad, log10_false_alarm: float
) -> OutlinePose | StageFailure:
    """The pose of an outline: of its four quarter turns the one that the cells bear out.

    Parameters
    ----------
    outline : Outline
    pyramid : Pyramid
    camera : Camera
        At the frame's size.
    pad : Pad
    log10_false_alarm : float
        The bound that the cells' evidence must keep.
    """
    best = _best_turn(outline, pyramid, camera, pad, log10_false_alarm)
    if best is None:
        return _failure("no pose has four such corners")
    read, pose, points_mm = best
    if not read.evidence.suffices(log10_false_alarm):
        return another_sign(read)
    residuals = corner_residuals(pose, camera, points_mm, outline.corners_xy)
    rms = float(np.sqrt(np.mean(np.sum(residuals**2, axis=1))))
    scatter = outline.sigma_px**2 * np.eye(8)
    covariance = corner_covariance(pose, camera, points_mm, outline.corners_xy, scatter)
    return OutlinePose(pose, outline, read, camera, points_mm, rms, covariance)


def _best_turn(
    outline: Outline, pyramid: Pyramid, camera: Camera, pad: Pad, log10_false_alarm: float
) -> tuple[LayerRead, Pose, Array] | None:
    """The quarter turn that cells bear out best, with its pose and the pad's corners (4, 3)."""
    turned = [np.roll(outline_mm(pad), quarter_turns, axis=0) for quarter_turns in range(4)]
    posed = [(planar_pose(corners, outline.corners_rays), corners) for corners in turned]
    turns = [(planar.pose, corners) for planar, corners in posed if planar is not None]
    best: tuple[LayerRead, Pose, Array] | None = None
    # Where few cells tell the turn, the many of a finer layer need not be read in the others.
    for layer in sorted(pad.layers, key=lambda item: item.field.size):
        for pose, corners in turns:
            read = read_layer(pyramid, camera, pad, layer, MovingPose(pose), 4 * len(pad.layers))
            if read is not None and (best is None or _rank(read) < _rank(best[0])):
                best = (read, pose, corners)
        if best is not None and best[0].evidence.suffices(log10_false_alarm):
            turns = [best[1:]]
    return best


def another_sign(read: LayerRead) -> StageFailure:
    """Why an outline whose cells were read in their best turn gives no pose."""
    return StageFailure(
        "outline",
        Reason.UNKNOWN_CODE,
        f"four sides are there, but {read.wrong_cells} within them differ from the pad in its "
        "best turn",
    )


def _failure(detail: str) -> StageFailure:
    return StageFailure("outline", Reason.NO_OUTLINE, detail)


def _rough_corners(region: Region) -> Array | None:
    """Four corners (4, 2) of the region's mask, frame pixels, clockwise; None where it has none."""
    assert region.mask is not None
    contours, _ = cv2.findContours(
        region.mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
    )
    hull = cv2.convexHull(max(contours, key=cv2.contourArea))
    around = cv2.arcLength(hull, True)
    for share in (0.02, 0.03, 0.045, 0.06, 0.08):
        corners = cv2.approxPolyDP(hull, share * around, True).reshape(-1, 2).astype(float)
        if len(corners) == 4:
            break
    else:
        return None
    if cv2.contourArea(corners.astype(np.float32)) < _AREA_SHARE[0] * region.mask.sum():
        return None
    if cv2.contourArea(corners.astype(np.float32), True) < 0:
        corners = corners[::-1]
    return np.ascontiguousarray((corners + 0.5) * float(1 << region.level) - 0.5)


def _cross(a: Array, b: Array) -> Array:
    point = cross(a, b)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(point[:2] / point[2], float)


def _checked(outline: Outline, pyramid: Pyramid, least_px: float) -> Outline | StageFailure:
    corners = outline.corners_xy
    size = np.array([pyramid.width, pyramid.height])
    if (corners < -_BORDER_PX).any() or (corners > size - 1 + _BORDER_PX).any():
        return _failure("the pad reaches beyond the frame")
    quad = corners.astype(np.float32)
    if not cv2.isContourConvex(quad.reshape(-1, 1, 2)):
        return _failure("the four sides cross one another")
    shortest = float(np.linalg.norm(corners - np.roll(corners, -1, axis=0), axis=1).min())
    if shortest < least_px:
        return StageFailure(
            "outline",
            Reason.CELLS_TOO_SMALL,
            f"a side of the pad is {shortest:.0f} px long, {least_px:.0f} are needed",
            "fly lower",
        )
    return outline


def _rank(read: LayerRead) -> tuple[bool, float]:
    """The less the better: cells too fine to be read still agree a little, and are many."""
    evidence = read.evidence
    return not evidence.suffices(0.0), evidence.log10_false_alarm
