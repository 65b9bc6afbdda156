"""Stages `choose` and `pose`, paper: the larger window's four corners by plane P4P."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.planar_pnp import PlanarPose, planar_pose
from padstudio.geometry.pose import Pose
from padstudio.pad.layout import lattice_mm
from padstudio.pad.spec import Pad
from padstudio.vision.baseline.decode import WindowRead
from padstudio.vision.baseline.grid_covariance import corners_covariance
from padstudio.vision.outline.corner_pose import (
    corner_covariance,
    corner_residuals,
    unsure,
)
from padstudio.vision.stage.params import PaperParams
from padstudio.vision.stage.trace import Reason, StageFailure


@dataclass(frozen=True, eq=False)
class WindowChoice:
    """The window that the pose rests on.

    Attributes
    ----------
    read : WindowRead
        The one with the larger area.
    reads : tuple of WindowRead
        Of all channels that were read.
    """

    read: WindowRead
    reads: tuple[WindowRead, ...]


@dataclass(frozen=True, eq=False)
class WindowPose:
    """A pose from the four corners of a window.

    Attributes
    ----------
    pose : Pose
    read : WindowRead
    planar : PlanarPose
        Both answers of the solver.
    camera : Camera
        At the frame's size.
    points_mm : (4, 3) float64
        The window's corners, pad frame.
    rms_px : float
        Of the four corners, frame pixels.
    covariance : (6, 6) float64
        As of `padstudio.vision.stage.detection.Uncertainty`.
    """

    pose: Pose
    read: WindowRead
    planar: PlanarPose
    camera: Camera
    points_mm: Array
    rms_px: float
    covariance: Array


def choose_larger(reads: Sequence[WindowRead]) -> WindowChoice:
    """Of the channels that were read, the one whose window covers more of the picture."""
    return WindowChoice(max(reads, key=lambda read: read.window.area_px), tuple(reads))


def window_pose(
    pad: Pad, camera: Camera, read: WindowRead, params: PaperParams
) -> WindowPose | StageFailure:
    """Plane P4P of the window's corners; of its two answers the one that carries the lattice.

    Both answers are polished by least squares over the same four corners.

    Parameters
    ----------
    pad : Pad
    camera : Camera
        At the frame's size; corners are undistorted with it.
    read : WindowRead
    params : PaperParams
    """
    points_mm = lattice_mm(pad, read.layer, read.corners_lattice)
    rays = camera.normalize(read.window.corners_xy)
    planar = planar_pose(points_mm, rays)
    if planar is None:
        detail = "the four corners leave the pose undetermined"
        return StageFailure("pose", Reason.POSE_REJECTED, detail)
    answers = [pose for pose in (planar.pose, planar.other) if pose is not None]
    offsets = [_off_lattice(pad, camera, read, pose) for pose in answers]
    best = int(np.argmin(offsets))
    if not offsets[best] < params.most_off_cells:
        return StageFailure(
            "pose",
            Reason.POSE_REJECTED,
            f"the pose from the window's corners puts the other lines {offsets[best]:.2f} cells "
            f"off, {params.most_off_cells:g} at the most is sound",
        )
    pose, corners = answers[best], read.window.corners_xy
    residuals = corner_residuals(pose, camera, points_mm, corners)
    scatter = read.window.plane.pixel**2 * corners_covariance(read.window.grid, read.window.corners)
    covariance = corner_covariance(pose, camera, points_mm, corners, scatter)
    failure = unsure(
        pose,
        covariance,
        float(np.sqrt(read.window.area_px)),
        params.most_position_share,
        params.most_attitude_deg,
    )
    if failure is not None:
        return failure
    rms = float(np.sqrt(np.mean(np.sum(residuals**2, axis=1))))
    return WindowPose(pose, read, planar, camera, points_mm, rms, covariance)


def _off_lattice(pad: Pad, camera: Camera, read: WindowRead, pose: Pose) -> float:
    """How far the read cells lie from where a pose puts them, in cells, root mean square."""
    window, cells = read.window, read.cells
    rows, cols = np.nonzero(cells.seen & (read.expected >= 0))
    here = np.stack([cols + cells.column0, rows + cells.row0], axis=1).astype(float) + 0.5
    origin = np.array([window.column, window.row], float)
    across = (read.corners_lattice[1] - read.corners_lattice[0]) / window.size
    down = (read.corners_lattice[3] - read.corners_lattice[0]) / window.size
    step = here - origin
    there = read.corners_lattice[0] + step[:, :1] * across + step[:, 1:] * down
    off = corner_residuals(pose, camera, lattice_mm(pad, read.layer, there), window.to_pixels(here))
    off_cells = np.linalg.norm(off, axis=1) / max(cells.cell_px, 1.0)
    return float(np.sqrt(np.mean(off_cells**2))) if np.isfinite(off_cells).all() else np.inf
