"""How sure a pose is that a pattern was matched with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.planar_pnp import mirrored
from padstudio.geometry.rolling_shutter import MovingPose, picture_change
from padstudio.geometry.small_matrices import inverse_trace
from padstudio.vision.pose.drift_kernel import Rows
from padstudio.vision.pose.edge_points import Sway
from padstudio.vision.pose.least_squares import MotionModel, MotionPrior, bounds_of
from padstudio.vision.pose.noise_kernel import TILES, pattern_noise
from padstudio.vision.pose.pattern.alignment_kernel import Equations as MatchEquations
from padstudio.vision.pose.pattern.block_kernel import Pixels
from padstudio.vision.pose.pattern.rows_kernel import RowEquations, blur_variance, match_rows
from padstudio.vision.pose.pattern.solver import Equations, PatternSolver
from padstudio.vision.pose.pattern.solver_kernel import Limits, scales_of
from padstudio.vision.pose.pattern.template import OVERSAMPLING
from padstudio.vision.pose.pose_posterior import Explained, RowsSeen, explain_pattern
from padstudio.vision.pose.row_motion_kernel import STATIC, RowSums

# The other pose of a plane is looked for in such steps, and then this one as far.
_THERE, _HERE = Limits(5, 0.5), Limits(2, 0.5)
# By so many pixels the pattern's shape is off at its rim.
_SHAPE_PX = 0.02
# A plane whose halves perspective draws so unlike has one pose alone.
_CLEAR_PX = 1.5


class PatternPosterior:
    """The covariance of a pose, from the rows of the picture that show the pattern.

    Parameters
    ----------
    solver : PatternSolver
        With the brightness that goes with the pose.
    pixels, few : Pixels
        All of them, and those that tell one pose from another.
    focal_px : float
        Of the camera.
    """

    def __init__(self, solver: PatternSolver, pixels: Pixels, few: Pixels, focal_px: float) -> None:
        self._solver, self._texture = solver, solver.texture
        self._all, self._few, self._focal_px = pixels, few, focal_px

    def explain(self, pose: MovingPose, model: MotionModel) -> Explained:
        """The pose at the middle row, and its covariance (6, 6)."""
        bounds = bounds_of(pose, model, 1.0)
        seen = self._match_rows(pose, None)
        parts = _parts(seen.whole)
        self._solver.scale = scales_of(seen.whole.residuals)
        blur = 0.0 if bounds.at_rest else self._blur_variance(pose, seen.whole.residuals)

        def rows_seen(about: MovingPose, sway: Sway | None) -> RowsSeen:
            if sway is None:
                return RowsSeen(_rows(seen, parts), blur)
            return RowsSeen(self._shaken(about, sway), blur)

        settled, covariance, shaking = explain_pattern(pose, rows_seen, self._focal_px, bounds)
        covariance = covariance + self._shape_doubt(pose)
        other = self._mirrored(pose, MotionPrior.of(pose, model), _noise(parts))
        if other is not None:
            step, share = other
            covariance = covariance + share * np.outer(step, step)
        return Explained(settled, covariance, shaking)

    def _mirrored(
        self, pose: MovingPose, prior: MotionPrior, noise: float
    ) -> tuple[Array, float] | None:
        """The step to the other pose of a small plane, and its share of what may be; few pixels
        tell as well as all that are as unlike each other.

        None where perspective sets the two apart beyond doubt, or the other one is no minimum.
        """
        start = mirrored(pose.pose)
        if self._perspective_px(pose) > _CLEAR_PX or start.position_mm[2] <= 0:
            return None
        solver = self._solver
        saved = solver.brightness, solver.scale, solver.rms_px
        few = self._few
        noise = max(noise * len(few.row_time) / len(self._all.row_time), 1.0)
        solver.brightness = saved[0].copy()
        other = solver.settle(MovingPose(start), prior, few, _THERE)
        found = None
        if other is not None and other.pose.position_mm[2] > 0:
            theirs = solver.variances(other, few)
            solver.brightness, solver.scale = saved[0].copy(), saved[1]
            here = solver.settle(pose, prior, few, _HERE) or pose
            ratio = float(np.log(theirs / solver.variances(here, few)).sum())
            worse = len(few.row_time) * ratio / noise / 2
            # The two differ by their perspective alone, which the picture's shape may feign.
            most = (self._perspective_px(pose) / _SHAPE_PX) ** 2 / 2
            worse *= most / (abs(worse) + most + 1e-9)
            share = np.exp(-np.logaddexp(0.0, worse))
            found = pose.step_to(other), float(share)
        solver.brightness, solver.scale, solver.rms_px = saved
        return found

    def _shape_doubt(self, pose: MovingPose) -> Array:
        """What a picture whose shape is off by a share of a pixel at the pad's rim does to a pose.

        From afar tilt is told by the pad's shape alone, which pattern, lens and mosaic leave so
        uncertain.
        """
        place, (_, height, width) = self._texture.place, self._texture.layers.shape
        sides = np.abs([width / place[1], height / place[3]]) / 2
        grid = np.array([[x, y, 0.0] for x in (-1, 0, 1) for y in (-1, 0, 1)])
        points = pose.pose.to_camera(grid * [*sides, 0.0])
        change = self._focal_px * picture_change(points, pose.pose.rotation)
        shape = points[:, :2] - points.mean(axis=0)[:2]
        shape /= np.abs(shape).max()
        bent = np.zeros((9, 2, 4))
        bent[:, 0, :2], bent[:, 1, 2:] = shape, shape
        moved = _SHAPE_PX * np.linalg.lstsq(change.reshape(18, 6), bent.reshape(18, 4))[0]
        return np.asarray(moved @ moved.T)

    def _perspective_px(self, pose: MovingPose) -> float:
        """By how much the pad's far half is drawn smaller than its near half, frame pixels."""
        position = pose.pose.position_mm
        distance = float(np.linalg.norm(position))
        sine = float(np.hypot(*position[:2])) / distance
        half = (self._texture.layers.shape[2] / abs(self._texture.place[1])) / 2
        return float(self._focal_px * (half / distance) ** 2 * sine)

    def _match_rows(self, pose: MovingPose, sway: Sway | None) -> RowEquations:
        turns = np.zeros((0, 3)) if sway is None else sway.rotvec
        return match_rows(self._all, self._texture, pose.state, self._solver.shown, turns)

    def _shaken(self, pose: MovingPose, sway: Sway) -> Rows:
        """Equations by rows where a pose and a shaking put them, after brightness has followed.

        Brightness that was found while rows were off their places shows the pattern too faintly.
        """
        found = self._match_rows(pose, sway).whole
        parts = _parts(found)
        self._solver.scale = scales_of(found.residuals)
        self._solver.brightness = self._solver.brightness + np.stack(
            [part.change for part in parts]
        )
        rows = _rows(self._match_rows(pose, sway), parts)
        return rows._replace(sums=rows.sums.about_rest(sway.rotvec))

    def _blur_variance(self, pose: MovingPose, residuals: NDArray[np.float32]) -> float:
        """By how much the picture is blurrier than the pattern, frame pixels squared."""
        stride, terms = (
            -(-len(self._all.row_time) // len(self._few.row_time)),
            self._solver.brightness,
        )
        variance = blur_variance(self._all, self._texture, pose.state, terms, stride, residuals)
        return variance / OVERSAMPLING**2


def _parts(found: MatchEquations) -> list[Equations]:
    """Each channel's equations of the pose."""
    sides = zip(found.normal, found.right, found.sums, strict=True)
    return [Equations.of(*part, 6) for part in sides]


def _rows(found: RowEquations, parts: list[Equations]) -> Rows:
    """Normal equations by intervals of rows, scaled so that their inverse is a covariance."""
    noise = _noise(parts)
    shares = np.array([part.share for part in parts])
    trust = shares / (np.array([part.variance for part in parts]) * noise)
    normal = np.tensordot(trust * shares, found.normal, 1)
    # What brightness takes over of a step of the pose, all directions alike.
    left = sum((part.normal * part.share**2 / noise for part in parts), np.zeros((6, 6)))
    kept = inverse_trace(normal[0].sum(axis=0), left) / 6
    whole = np.zeros((*normal.shape[:2], STATIC, STATIC))
    pull = np.zeros((2, normal.shape[1], STATIC))
    whole[..., :6, :6], pull[..., :6] = kept * normal, kept * np.tensordot(trust, found.pull, 1)
    return Rows(RowSums(whole, pull), found.first, found.width)


def _noise(parts: list[Equations]) -> float:
    """Scatter of scores over that of pixels as independent as they are many."""
    normal = sum((part.normal for part in parts), np.zeros((6, 6)))
    scores = sum((part.scores for part in parts), np.zeros((TILES * TILES, 6)))
    return pattern_noise(normal, scores)
