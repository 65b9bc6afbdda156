"""Least squares of a pose and a sheet's heights together.

A point that moves does to its own residual what a camera that moves the other way does to all; so
the columns of a sheet's coefficients are those of the camera's centre, times how the coefficients
move each point.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose, row_times
from padstudio.vision.bend.sheet import Sheet
from padstudio.vision.bend.smooth_field import Cosines, find_evidence, solve
from padstudio.vision.pose import least_squares_kernel
from padstudio.vision.pose.edge_points import EdgePoints
from padstudio.vision.pose.least_squares_kernel import Sightings
from padstudio.vision.pose.noise_kernel import newton_share
from padstudio.vision.pose.pose_posterior import explain_edges
from padstudio.vision.pose.row_motion import MotionBounds


class Lengths(NamedTuple):
    """Lengths of bends that are tried.

    Attributes
    ----------
    shares : tuple of float
        Of the pad's longer side, the shortest first.
    least : float
        Share of what is in view; shorter bends would need too many cosines.
    """

    shares: tuple[float, ...]
    least: float


#: Those that paper usually has, and those that are tried where these leave over what is smooth.
USUAL = Lengths((0.08, 0.13, 0.2, 0.32, 0.5), 1 / 11)
SHORT = Lengths((0.02, 0.03, 0.05), 1 / 24)
# What bends are taken for to begin with, mm.
_FIRST_AMPLITUDE_MM = 3.0
# No picture is measured better than this.
_LEAST_SIGMA_PX = 0.03


@dataclass(frozen=True, eq=False)
class BentFit:
    """A pose and a sheet.

    Attributes
    ----------
    pose : MovingPose
        Still, relative to the plane about which heights are expected.
    sheet : Sheet
    amplitude_mm : float
        Expected standard deviation of heights about that plane.
    """

    pose: MovingPose
    sheet: Sheet
    amplitude_mm: float


class Equations(NamedTuple):
    """Residuals of borders about a pose and a sheet, and how they change with both.

    Attributes
    ----------
    residual : (N,) float64
        Pixels.
    columns : (N, 6 + K) float64
        With centre and attitude of the camera, and the coefficients of the sheet.
    sigma : float
        Robust standard deviation of the residuals.
    trust : (N,) float64
        Their inverse variances.
    moves : (N, 3) float64
        Pixels a mm by which the border itself moves along the pad's x, y and z.
    """

    residual: Array
    columns: Array
    sigma: float
    trust: Array
    moves: Array

    @classmethod
    def of(cls, edge_points: EdgePoints, camera: Camera, fit: BentFit) -> Equations:
        """The equations at a fit."""
        rows, seen = linearized(edge_points, camera, fit.pose, fit.sheet)
        residual = rows[:, 0].copy()
        sigma = max(least_squares_kernel.scatter(residual, seen.weight), _LEAST_SIGMA_PX)
        trust = least_squares_kernel.trust_of(residual, seen.weight, sigma)
        # A border that moves is seen where a camera that moves the other way would see it.
        moves = -rows[:, 1:4]
        heights = sheet_columns(moves, fit.sheet, fit.sheet.cosines, edge_points)
        return cls(residual, np.hstack([rows[:, 1:7], heights]), sigma, trust, moves)

    def normal(self, columns: Array) -> tuple[Array, Array]:
        """Normal matrix of some columns, and what makes right sides of residuals."""
        weighted = columns * self.trust[:, None]
        return weighted.T @ columns, weighted.T


def sheet_columns(moves: Array, sheet: Sheet, cosines: Cosines, edge_points: EdgePoints) -> Array:
    """Change of residuals (N, K) with coefficients that are added to a sheet."""
    changes = sheet.changes(cosines, edge_points.borders.points_mm)
    return sum((moves[:, axis, None] * changes[axis] for axis in range(3)), np.zeros(1))


def linearized(
    edge_points: EdgePoints, camera: Camera, pose: MovingPose, sheet: Sheet | None
) -> tuple[Array, Sightings]:
    """Residuals (px) and their changes, (N, 7), as of `least_squares_kernel.linearize`; and of
    what."""
    borders, xy, rays = edge_points.borders, edge_points.xy, camera.normalize(edge_points.xy)
    weight = edge_points.weight * camera.sharpness(xy, rays) ** 2
    points = borders.points_mm if sheet is None else sheet.laid(borders.points_mm)
    seen = Sightings(points, borders.along_mm, rays, row_times(camera, xy[:, 1]), weight)
    return least_squares_kernel.linearize(seen, pose.state) * camera.focal_px, seen


def fit_bent(edge_points: EdgePoints, camera: Camera, start: BentFit, iterations: int) -> BentFit:
    """Gauss–Newton from a start, with the start's expectation of heights."""
    fit = start
    for _ in range(iterations):
        equations = Equations.of(edge_points, camera, fit)
        normal, weigh = equations.normal(equations.columns)
        expected = start.amplitude_mm**2 * fit.sheet.cosines.variance
        normal[np.diag_indices_from(normal)] += np.concatenate([np.zeros(6), 1 / expected])
        about_flat = equations.residual + equations.columns[:, 6:] @ fit.sheet.coefficients
        step = solve(normal, weigh @ about_flat)
        sheet = Sheet(fit.sheet.cosines, step[6:], fit.sheet.box)
        fit = BentFit(fit.pose.moved(step[:6]), sheet, start.amplitude_mm)
    return fit


def first_bent(
    edge_points: EdgePoints, camera: Camera, pose: Pose, pad_mm: float, tried: Lengths
) -> tuple[BentFit, float] | None:
    """The best fit of all lengths of bends, and the log odds of its sheet against a flat one.

    The shortest bends are fitted first, as they can take any form; all lengths are then compared
    by their evidence about that sheet. None where all are too short a share of what is in view.
    """
    points = edge_points.borders.points_mm[:, :2]
    box = np.stack([points.min(axis=0), points.max(axis=0)])
    least = tried.least * float((box[1] - box[0]).max())
    lengths = [share * pad_mm for share in tried.shares if share * pad_mm >= least]
    if not lengths:
        return None
    sheet = Sheet.flat(Cosines.over(box, lengths[0]), box)
    fit = fit_bent(edge_points, camera, BentFit(MovingPose(pose), sheet, _FIRST_AMPLITUDE_MM), 3)
    equations = Equations.of(edge_points, camera, fit)
    heights = equations.columns[:, 6:] @ fit.sheet.coefficients
    found: list[tuple[float, BentFit]] = []
    for length_mm in lengths:
        cosines = Cosines.over(box, length_mm)
        rises = sheet_columns(equations.moves, fit.sheet, cosines, edge_points)
        normal, weigh = equations.normal(np.hstack([equations.columns[:, :6], rises]))
        right = weigh @ (equations.residual + heights)
        evidence = find_evidence(normal, right, cosines.variance)
        flat = Sheet.flat(cosines, box)
        found.append((evidence.log_odds, BentFit(fit.pose, flat, evidence.amplitude_mm)))
    log_odds, best = max(found, key=lambda item: item[0])
    return fit_bent(edge_points, camera, best, 2), log_odds


def amplitude_of(edge_points: EdgePoints, camera: Camera, fit: BentFit) -> float:
    """The amplitude that residuals about a fit ask for, mm."""
    equations = Equations.of(edge_points, camera, fit)
    normal, weigh = equations.normal(equations.columns)
    heights = equations.columns[:, 6:] @ fit.sheet.coefficients
    right = weigh @ (equations.residual + heights)
    return find_evidence(normal, right, fit.sheet.cosines.variance).amplitude_mm


def bent_covariance(
    edge_points: EdgePoints, camera: Camera, fit: BentFit, bounds: MotionBounds
) -> Array:
    """Covariance (6, 6) of the pose, whatever the sheet's heights are.

    That of a pose on a sheet that is known, of which the residuals tell noise and motion, and what
    it means that the sheet is not known: heights are eliminated from the normal equations (Schur's
    complement), and what is expected of them enters as something not measured. As constant and
    sloping heights are among them, this is the pose relative to the plane about which heights are
    expected, also where only a part of the sheet is in view.
    """
    rows, seen = linearized(edge_points, camera, fit.pose, fit.sheet)
    equations = Equations.of(edge_points, camera, fit)
    known = explain_edges(fit.pose, edge_points, (rows, seen), camera, bounds)[1]
    robust = equations.trust * equations.sigma**2 / np.maximum(seen.weight, 1e-12)
    normal = equations.normal(equations.columns)[0] * newton_share(robust, seen.weight)
    expected = 1 / (fit.amplitude_mm**2 * fit.sheet.cosines.variance)
    across = solve(normal[6:, 6:] + np.diag(expected), normal[6:, :6])
    inner = normal[:6, :6] - normal[:6, 6:] @ across
    spread = solve(inner, across.T * np.sqrt(expected))
    unknown = solve(inner, np.eye(6)) - solve(normal[:6, :6], np.eye(6)) + spread @ spread.T
    return np.asarray(known + (unknown + unknown.T) / 2)
